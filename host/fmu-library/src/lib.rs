//! The library in every FMU of Lashloop: the functions of FMI 2.0 and 3.0 for co-simulation, around an instance.
//!
//! All unsafe code of an export is here, because the functions of FMI take pointers of an importer. It rests on what FMI
//! promises: pointers are valid for the lengths next to them, texts end with a NUL, and a component is one that an instantiation
//! here has returned and nothing has freed. Nobody can check that; an importer that breaks the promise has undefined behaviour
//! with an FMU of any tool. No panic leaves a function: it becomes the status error, with its text for the importer's log.
//!
//! | module | has |
//! |---|---|
//! | `component` | what a component pointer points to, and the way into it |
//! | `texts` | texts and arrays of C |
//! | `fmi2` | the functions of FMI 2.0 |
//! | `fmi3` | the functions of FMI 3.0 that the FMU offers |
//! | `states` | the functions for states, for both |
//! | `absent` | those that it doesn't: each answers with an error, since importers want every name |

#![allow(unsafe_code, reason = "the functions of FMI take pointers of C")]

#[macro_use]
mod states;

mod absent;
mod component;
mod fmi2;
mod fmi3;
mod texts;

/// By this text an export tells the library of its version from other files.
#[used]
static MARKER: [u8; lashloop_fmu_export::MARKER.len()] = marker();

const fn marker() -> [u8; lashloop_fmu_export::MARKER.len()] {
    let mut bytes = [0; lashloop_fmu_export::MARKER.len()];
    bytes.copy_from_slice(lashloop_fmu_export::MARKER.as_bytes());
    bytes
}

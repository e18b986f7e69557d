//! The plant and the drive of a scenario as FMUs of FMI 2.0 and 3.0 for co-simulation.
//!
//! An FMU is an archive with a description, the resolved scenario and one library, which is the same for every scenario:
//! nothing is compiled for an export. The library is `lashloop-fmu-library`, the functions of C around an [`Instance`].
//!
//! | module | has |
//! |---|---|
//! | `source` | the scenario in an FMU, and its numbers as parameters |
//! | `variable` | variables and their values |
//! | `part` | [`Part`]: which half of the loop the FMU is |
//! | `interface` | the variables of an FMU and what it can do |
//! | `plant` | the plant with encoders and the line to the motor, advanced by a torque |
//! | `drive` | the drive with its reference, advanced by counts |
//! | `side` | plant or drive behind one set of calls |
//! | `instance` | [`Instance`]: the calls of an importer in their order |
//! | `location` | where an importer says that the resources are |
//! | `snapshot` | the state of an instance, saved and restored |
//! | `unit` | units in the terms of FMI |
//! | `description` | `modelDescription.xml` |
//! | `archive` | the FMU as a file, and where the library is |
//! | `error` | why an export or a call fails |

#![forbid(unsafe_code)]
#![warn(missing_docs)]

mod archive;
mod description;
mod drive;
mod error;
mod instance;
mod interface;
mod location;
mod part;
mod plant;
mod side;
mod snapshot;
mod source;
mod unit;
mod variable;

pub use archive::{MARKER, export, library};
pub use description::Version;
pub use error::ExportError;
pub use instance::Instance;
pub use location::folder;
pub use part::Part;
pub use snapshot::Snapshot;
pub use variable::{Kind, Value};

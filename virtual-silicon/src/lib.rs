//! Virtual silicon: the drive's unmodified image on register-level models of its chip.
//!
//! The models are those of the crate `rigless`, one part for each family of chips. They are made from reference manuals, not from
//! hardware; `docs/hardware/evidence.md` has what only a board can show.
//!
//! | module | holds |
//! |---|---|
//! | [`chip`] | [`Chip`](chip::Chip): the part with crystal and supply, as the emulator runs it |
//! | `part` | `Part`: a chip as the models of its family |
//! | `stm32f4`, `stm32h7` | the part of a family, and what its models lack |
//! | [`machine`] | [`run`](machine::run): an image from reset until its surroundings end it |
//! | [`surroundings`] | [`Surroundings`](surroundings::Surroundings): what is connected to the chip |
//! | [`access`] | [`Violations`](access::Violations): accesses of the image that the chip would not have served |
//! | [`serial_line`] | [`SerialLine`](serial_line::SerialLine): the far end of the link, in device time |
//! | [`host_link`] | [`HostLink`](host_link::HostLink): a program at the far end |
//! | `lockstep` | turns of host and chip, with device time that stands still |
//! | [`pacer`] | [`Pacer`](pacer::Pacer): keeps device time from running ahead of the wall clock |
//! | `inputs` | from the wires to the timers: pin functions, pull resistors |
//! | [`pins`] | [`Pins`](pins::Pins): encoder inputs, bridge outputs, break input |
//! | [`quadrature`] | [`Quadrature`](quadrature::Quadrature): the two channels of an incremental encoder |
//! | [`drive_train`] | [`DriveTrain`](drive_train::DriveTrain): a plant between bridge and encoders |
//! | [`blocks`] | blocks of a chip that a board chooses among |
//! | [`wiring`] | [`Wiring`](wiring::Wiring): the pin map of a board |
//! | [`boards`] | [`open`](boards::open): a pin map from its file |
//! | [`drive_train_file`] | [`read`](drive_train_file::read): a drive train from its description |
//! | [`symbols`] | [`Symbols`](symbols::Symbols): addresses of an image, and mutants of it |
//! | [`thumb`] | [`Code`](thumb::Code): instructions for a mutant |

#![warn(missing_docs)]

pub mod access;
pub mod blocks;
pub mod boards;
mod centred_pulse;
pub mod chip;
mod converter_trigger;
pub mod drive_train;
pub mod drive_train_file;
pub mod gate_driver;
pub mod host_link;
mod inputs;
mod lockstep;
pub mod lsi_capture;
pub mod machine;
pub mod motor_at_bridge;
pub mod pacer;
mod part;
pub mod pins;
pub mod quadrature;
pub mod serial_line;
mod stm32f4;
mod stm32h7;
pub mod surroundings;
pub mod symbols;
pub mod thumb;
mod tim1;
pub mod wiring;

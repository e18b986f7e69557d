//! The drive of a run: which one, how the bench reaches it, and what runs it.
//!
//! | module | holds |
//! |---|---|
//! | `handle` | [`Device`]: a session with a drive and what is behind it |
//! | `connection` | [`Connection`]: what is behind a link |
//! | `choice` | [`DeviceChoice`]: the drive that a user names |
//! | `kind` | [`DeviceKind`]: one way to reach a drive |
//! | [`kinds`] | all of them, each in a file of its own |
//! | `pin_plant` | [`PinPlant`]: the plant behind the pins of a drive in bench mode |
//! | `own_time` | the time of a program that the bench started |
//! | `slow_time` | the time of a device that is emulated in lockstep |
//! | `in_process_bench` | the drive in this process with encoders, a power stage and a plant |
//! | `image` | where the image of the firmware is |
//! | `evidence` | [`Evidence`]: the files that run as the drive, for the record |
//! | [`BuiltIn`] | the drive that is part of a program, by its laws |
//! | `drive_host` | [`DriveHost`]: what runs the drive, and can suspend it |
//! | `uart_socket` | the socket that the UART of an emulated board connects to |
//! | [`twin`] | the native twin's own side: a drive served on a pseudo-terminal |

mod built_in;
mod choice;
mod connection;
mod drive_host;
mod error;
mod evidence;
mod handle;
mod image;
mod in_process_bench;
mod kind;
pub mod kinds;
mod own_time;
mod pin_plant;
mod slow_time;
pub mod twin;
mod uart_socket;

pub use built_in::BuiltIn;
pub use choice::{DeviceChoice, forms};
pub use connection::{Connection, LineSpeed};
pub use drive_host::DriveHost;
pub use error::DeviceError;
pub use evidence::{Build, DriveFiles, Evidence, FileHash};
pub use handle::Device;
pub use image::{find as find_image, find_for_board as find_image_for_board};
pub use kind::{DeviceKind, Opened, ParsedKind, Syntax, session_number};
pub use kinds::terminal::open_terminal;
pub use pin_plant::PinPlant;

//! Rigs: benches with hardware, each described by a file, and what keeps runs on them safe.
//!
//! | module | is |
//! |---|---|
//! | [`file`](mod@file) | [`Rig`]: the rig file, its keys, its page and its JSON Schema |
//! | [`way`] | [`Way`](way::Way): how firmware gets onto the chip |
//! | [`limits`] | the limits that a scenario can't exceed |
//! | [`drive_settings`] | the parameters that a rig sets on its drive |
//! | [`lock`] | one program at a time on a rig |
//! | `taken` | [`TakenRig`]: a rig that this program uses alone |

pub mod drive_settings;
pub mod file;
pub mod limits;
pub mod lock;
mod taken;
pub mod way;

pub use file::Rig;
pub use taken::{RigError, TakenRig};

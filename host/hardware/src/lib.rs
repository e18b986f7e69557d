//! Benches with hardware: what is plugged in, whether it works, and what it is.
//!
//! | module | is |
//! |---|---|
//! | [`ports`], [`doctor`] | the serial ports of this machine, and the examination of a line |
//! | [`rig_check`] | everything that can be found out about a rig without moving it |
//! | [`flash`] | firmware onto a drive |
//! | [`parameter_set`] | the parameters of a drive as a file and as a fingerprint |
//! | [`commission`], [`identify`] | motions that show a drive train; its estimates from records, and what is written of them |

#![forbid(unsafe_code)]

pub mod commission;
pub mod doctor;
pub mod flash;
pub mod identify;
pub mod parameter_set;
pub mod ports;
pub mod rig_check;

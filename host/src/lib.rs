//! The lab around the bench loop: everything that the command line offers beyond a single run.
//!
//! | module | is |
//! |---|---|
//! | [`budget`] | the time budget of a control period on a serial line |
//! | [`campaign`] | control laws on plants outside their tuning: cases, limits, tables |
//! | [`conformance`] | checks of a drive against the protocol, rule by rule |
//! | [`decode`] | the frames of a capture or of a raw stream as text |
//! | [`parameter_set`] | the parameters of a drive as a file and as a fingerprint |
//! | [`ports`], [`doctor`] | the serial ports of this machine, and the diagnosis of one |
//! | [`soak`] | a scenario repeated under rising faults |

#![forbid(unsafe_code)]

pub mod budget;
pub mod campaign;
pub mod conformance;
pub mod decode;
pub mod doctor;
pub mod parameter_set;
pub mod ports;
pub mod soak;

//! The lab around the bench loop: what the command line offers beyond a single run.
//!
//! | module | is |
//! |---|---|
//! | [`budget`] | what a line of a given speed leaves of a control period |
//! | [`decode`] | the frames of a capture or a raw stream, readable |
//! | [`conformance`] | whether a drive keeps to the protocol, rule by rule |
//! | [`parameter_set`] | the parameters of a drive as a file and as a fingerprint |
//! | [`ports`], [`doctor`] | which serial ports there are, and whether one is fit for a bench |
//! | [`soak`] | a scenario repeated while its faults rise |
//! | [`campaign`] | a controller on plants it was not tuned for |

#![forbid(unsafe_code)]

pub mod budget;
pub mod campaign;
pub mod conformance;
pub mod decode;
pub mod doctor;
pub mod parameter_set;
pub mod ports;
pub mod soak;

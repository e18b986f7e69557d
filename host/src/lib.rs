//! The bench: a drive with gear backlash, simulated around the real firmware of its controller.
//!
//! | module | is |
//! |---|---|
//! | [`scenario`] | what is to be run and what is expected, as data, with errors that teach |
//! | [`plant`], [`encoder`], [`reference`](mod@reference) | the mechanics, what the drive gets to see of them, and where the load is wanted |
//! | [`link`] | anything that carries bytes |
//! | [`capture`], [`decode`] | what passed on the line, kept and read again |
//! | [`budget`] | what a line of a given speed leaves of a control period |
//! | [`session`] | the conversation with a drive |
//! | [`device`], [`supervisor`] | which drive, and the processes behind it |
//! | [`conformance`] | whether a drive keeps to the protocol, rule by rule |
//! | [`parameter_set`] | the parameters of a drive as a file and as a fingerprint |
//! | [`ports`], [`doctor`] | which serial ports there are, and whether one is fit for a bench |
//! | [`run`] | the loop, and what came of it |
//! | [`fault`], [`soak`] | what goes wrong on purpose, once or over and over |
//! | [`metrics`], [`verdict`], [`record`] | figures, judgement, evidence |
//! | [`battery`] | how a controller fares on plants it was not tuned for |
//! | [`picture`] | plots |

#![forbid(unsafe_code)]

pub mod battery;
pub mod budget;
pub mod capture;
pub mod conformance;
pub mod decode;
pub mod device;
pub mod doctor;
pub mod encoder;
pub mod fault;
pub mod link;
pub mod metrics;
pub mod parameter_set;
pub mod picture;
pub mod plant;
pub mod ports;
pub mod record;
pub mod reference;
pub mod run;
pub mod scenario;
pub mod session;
pub mod soak;
pub mod supervisor;
pub mod timing;
pub mod verdict;

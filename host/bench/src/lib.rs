//! The bench loop: a drive with gear backlash, simulated around the real firmware of its controller.
//!
//! In the order of their dependencies; a module uses only those above it.
//!
//! | module | is |
//! |---|---|
//! | [`atomic_file`] | files that are written whole or not at all |
//! | [`timing`] | when steps began and answers arrived |
//! | [`scenario`] | what is to be run and what is expected, as data |
//! | [`link`] | anything that carries bytes |
//! | [`capture`] | the bytes of a line, kept and read again |
//! | [`session`] | the conversation with a drive |
//! | [`supervisor`], [`device`] | the processes behind a drive, and how a drive is reached |
//! | [`fault`] | what goes wrong on purpose |
//! | [`verdict`], [`record`] | judgement and evidence |
//! | [`run`] | the loop |

#![forbid(unsafe_code)]

pub mod atomic_file;
pub mod capture;
pub mod device;
pub mod fault;
pub mod link;
pub mod record;
pub mod run;
pub mod scenario;
pub mod session;
pub mod supervisor;
pub mod timing;
pub mod verdict;

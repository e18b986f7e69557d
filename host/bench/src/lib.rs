//! The bench loop: simulates a drive with gear backlash around the real firmware of its controller.
//!
//! The modules in the order of their dependencies: each uses only those above it.
//!
//! | module | is |
//! |---|---|
//! | [`atomic_file`] | files that are written completely or not at all |
//! | [`regular_file`] | files of others, read in bounded time and memory |
//! | [`resume`] | files of results that a later command continues |
//! | [`number`], [`text_table`] | numbers with the digits that a reader needs; tables of text |
//! | [`timing`] | the timing of steps, and its report |
//! | [`supervisor`] | child processes and signals |
//! | [`process_plant`] | a plant in another process |
//! | [`scenario`] | what is run and what is expected, as data |
//! | [`device`] | the drive of a run: how the bench reaches it, and what runs it |
//! | [`fault`] | faults injected on purpose |
//! | [`verdict`] | PASS, FAIL or INVALID |
//! | [`run`] | the loop |

#![forbid(unsafe_code)]
#![warn(missing_docs)]

pub mod atomic_file;
pub mod device;
pub mod fault;
pub mod number;
pub mod process_plant;
pub mod regular_file;
pub mod resume;
pub mod run;
pub mod scenario;
pub mod supervisor;
pub mod text_table;
pub mod timing;
pub mod verdict;

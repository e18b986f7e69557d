//! `lashloop test`: folders of scenarios and their sweeps as cases, in parallel.
//!
//! | module | is |
//! |---|---|
//! | [`files`] | the scenarios of files and folders |
//! | [`plan`] | every case with its scenario, its baseline and its folder |
//! | [`case_result`] | status, reasons, checks and metrics of a case |
//! | [`check`] | a value with its bounds, and whether it is met |
//! | [`runner`] | one case on a drive, with its record |
//! | [`baseline`] | metric values with tolerances, in a file next to the scenario |
//! | [`journal`] | results line by line, and what they belong to |
//! | [`tally`] | results in the order of the plan, and their exit code |
//! | [`table`] | the results as text |

pub mod baseline;
pub mod case_result;
pub mod check;
pub mod files;
pub mod journal;
pub mod plan;
pub mod runner;
pub mod table;
pub mod tally;

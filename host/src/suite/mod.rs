//! `lashloop test`: folders of scenarios and their sweeps as cases, in parallel.
//!
//! | module | is |
//! |---|---|
//! | [`files`] | the scenarios of files and folders |
//! | [`plan`] | every case with its scenario, its baseline and its folder |
//! | [`case_result`] | status, reasons, checks and metrics of a case |
//! | [`runner`] | one case on a drive, with its record |
//! | [`baseline`] | metric values with tolerances, in a file next to the scenario |
//! | [`header`] | what the journal of a suite belongs to |
//! | [`tally`] | results in the order of the plan, and their exit code |
//! | [`table`], [`junit`], [`index`] | the results as text, as XML and as a page |

pub mod baseline;
pub mod case_result;
pub mod files;
pub mod header;
pub mod index;
pub mod junit;
pub mod plan;
pub mod runner;
pub mod table;
pub mod tally;

//! What a person looks at after a run: plots of records, and pages for a browser.
//!
//! | module | is |
//! |---|---|
//! | [`runs`] | records as a figure |
//! | [`page`] | reports of runs, suites, campaigns and comparisons as HTML |
//! | [`response_figure`] | frequency responses as a figure |
//! | [`junit`] | results for build servers |
//! | [`suite_reports`] | the page of a suite, and the report of each record |

#![forbid(unsafe_code)]

mod chosen;
mod draw_error;
pub mod junit;
pub mod page;
pub mod response_figure;
pub mod runs;
mod steps;
pub mod suite_reports;

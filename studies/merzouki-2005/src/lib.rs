//! A study on the bench: R. Merzouki and J. C. Cadiou, "Estimation of backlash phenomenon in the electromechanical actuator",
//! Control Engineering Practice 13 (2005) 973-983, reproduced.
//!
//! | module | is |
//! |---|---|
//! | [`scenarios`] | the paper's scenarios |
//! | [`plan`] | the runs of its figures |
//! | [`mod@figures`] | figures and tables, the paper's next to ours |
//! | [`demo`] | its two plants under three laws as a table and a figure; the program `demo` |

#![forbid(unsafe_code)]

pub mod demo;
pub mod figures;
pub mod plan;
pub mod scenarios;

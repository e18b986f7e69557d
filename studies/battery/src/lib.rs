//! The shipped campaigns of the control laws on plants outside their tuning, `campaigns/battery.toml` and
//! `campaigns/battery-hard.toml`, and their tables.
//!
//! | module | is |
//! |---|---|
//! | [`campaign`](mod@campaign) | the campaigns and their scenarios, in the program |
//! | [`plants`] | one of its random plants |
//! | [`criterion`] | names, units and digits of its tables |
//! | [`text`] | the tables |

#![forbid(unsafe_code)]

pub mod campaign;
pub mod criterion;
pub mod plants;
pub mod text;

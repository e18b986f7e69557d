//! Campaigns: one scenario as up to ten million cases.
//!
//! ```text
//! campaign file ──▶ plan ──▶ case i ──▶ run ──▶ row ──▶ shard K of N ──▶ merge ──▶ results.csv ──▶ report, evidence
//! ```
//!
//! Case i is a function of file, seed and i alone. A shard owns each N-th case and writes its rows in the order of cases, so
//! that the number of whole lines is the state of a resumed shard. No step holds more than a bounded number of cases or rows.
//!
//! | module | is |
//! |---|---|
//! | [`settings`], [`axis`], [`mod@file`] | a campaign as data; the values of a key; the keys of its file |
//! | `soundness` | points and expectations that no statistic or map can be made of |
//! | [`draw`], [`sobol`] | numbers of random streams, Latin hypercubes and Sobol sequences by index |
//! | [`campaign`], [`plan`] | scenarios and selection; from a number to a case and its settings |
//! | [`cell`], [`row`] | one result: metrics or the reasons for their absence, and the line in the table |
//! | `minimum_time` | the shortest settling time of a case's plant |
//! | [`workers`] | runs in parallel |
//! | [`run`] | one case on a drive |
//! | [`shard`], [`facts`], [`shard_file`] | shards, what they must have in common, and their files |
//! | `results_file` | results that grow by whole lines, of a shard or a suite |
//! | [`engine`] | the runs of a shard, and its rows in the order of cases |
//! | [`merge`] | shards to one table |
//! | [`quantile`], [`interval`] | quantiles by nearest rank; confidence intervals |
//! | [`table`], [`report`], [`expectation`] | the table read back, its statistics, and the verdict |
//! | [`limit`], [`map`] | limits on single runs; maps over two axes of a grid, iso-lines, the side of a point |
//! | [`failures`], [`view`] | failures over the axes; what a page shows, of a size that does not depend on the runs |
//! | [`evidence`] | records of the worst runs and of failures |

//!
//! Many runs in other forms, and what a line leaves of a period:
//!
//! | module | is |
//! |---|---|
//! | [`suite`] | `lashloop test`: folders of scenarios and sweeps, baselines, reports |
//! | [`soak`] | a scenario repeated under rising faults |
//! | [`cluster`] | shards of a campaign as jobs of a cluster |
//! | [`budget`] | the time budget of a control period on a serial line |

#![forbid(unsafe_code)]

pub mod axis;
pub mod budget;
pub mod campaign;
pub mod cell;
pub mod cluster;
pub mod draw;
pub mod engine;
mod error;
pub mod evidence;
pub mod expectation;
pub mod facts;
pub mod failures;
pub mod file;
mod grid_axis;
pub mod interval;
pub mod limit;
pub mod map;
pub mod merge;
mod minimum_time;
#[cfg(feature = "parquet")]
pub mod parquet;
pub mod plan;
pub mod quantile;
pub mod report;
mod results_file;
pub mod row;
pub mod run;
pub mod settings;
pub mod shard;
pub mod shard_file;
pub mod soak;
pub mod sobol;
mod soundness;
pub mod suite;
pub mod table;
pub mod view;
pub mod workers;

pub use campaign::{Campaign, Selection, Source};
pub use error::CampaignError;

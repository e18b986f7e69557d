//! Two records compared: what was set differently, and what differs in the results.
//!
//! | module | has |
//! |---|---|
//! | `comparison` | the comparison, and whether the records agree |
//! | `settings` | scenario keys, parameters, drive, bench and host |
//! | `metrics`, `timing` | the summaries side by side |
//! | `pairs` | rows of both records at the same time |
//! | `signals` | the values of these rows: first and largest difference |
//! | `scope` | what is the same in each repetition of a run |
//! | `tolerance` | how far values may be apart |
//! | `text` | the comparison as a text |
//! | `record_files` | a record with its scenario |

mod comparison;
mod error;
mod figure;
mod metrics;
mod pairs;
mod record_files;
mod scope;
mod settings;
mod signals;
mod text;
mod timing;
mod tolerance;

pub use comparison::{Agreement, Comparison, DiffOptions, FirstDifference, RecordHead};
pub use error::DiffError;
pub use figure::{exact, figure};
pub use metrics::MetricDifference;
pub use pairs::Coverage;
pub use record_files::RecordFiles;
pub use scope::Scope;
pub use settings::{Group, Setting, settings};
pub use signals::{At, SignalDifference, ValuePair};
pub use timing::TimingDifference;
pub use tolerance::{Tolerance, ToleranceOf, Tolerances};

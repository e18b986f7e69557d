//! The time budget of a control period on a serial line, computed before a run.
//!
//! | module | is |
//! |---|---|
//! | `wire_time` | time of frames and answers on the line, shortest period, highest rate |
//! | `report` | the budget as text, with advice |

mod report;
mod wire_time;

pub use wire_time::{Budget, Cycle};

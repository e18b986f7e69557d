//! The time budget of a control period on a serial line, computed before a run, and the place of a line on a map of what
//! delay, jitter and loss a law tolerates.
//!
//! | module | is |
//! |---|---|
//! | `wire_time` | time of frames and answers on the line, shortest period, highest rate |
//! | `report` | the budget as text, with advice |
//! | [`point`] | delay, jitter and loss from the round trip of a line |
//! | [`line_map`] | a map from the results of a campaign; side and borders of a point |
//! | `shipped_map` | the map that the program has |
//! | [`placement`] | a line on a map as text; a map as text |

pub mod line_map;
pub mod placement;
pub mod point;
mod report;
mod shipped_map;
mod wire_time;

pub use wire_time::{Budget, Cycle};

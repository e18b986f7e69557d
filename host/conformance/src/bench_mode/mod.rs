//! Bench mode on the drive's own encoders: its steps and reports, what restarts its watchdog, and what ends its runs.
//!
//! The power stage is on in these checks, so the host has to allow them. Unless it names the scale of the torque, the duty is as
//! near to that of no torque as the parameters allow, and the encoders may stand still.
//!
//! | module | contents |
//! |---|---|
//! | `run` | a run on the drive's own encoders, for all checks |
//! | `steps` | numbers, references, period and reports of the steps |
//! | `torques` | the torques, against those of HIL mode |
//! | `limits` | the faults that need no hand at the hardware |
//! | `ends` | the watchdog, the ends of a run and the next run |
//! | `counts` | where the counts begin, and their directions |

mod counts;
mod ends;
mod limits;
mod run;
mod steps;
mod torques;

use crate::prelude::checks::*;

pub(super) fn checks() -> Vec<Check> {
    // Mechanics at rest at first, and at rest soon after a fault.
    let groups = [limits::checks(), steps::checks(), torques::checks(), ends::checks(), counts::checks()];
    groups.into_iter().flatten().collect()
}

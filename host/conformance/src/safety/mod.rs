//! Safety: torque limit, latched faults and watchdog.

mod faults;
mod late;
mod limits;
mod timing;
mod watchdog;

use crate::prelude::checks::*;

pub(super) use timing::{in_time, nearly_in_time};
pub(super) use watchdog::FEEDS;

pub(super) fn checks() -> Vec<Check> {
    let mut checks = limits::checks();
    checks.extend(faults::checks());
    checks.extend(watchdog::checks());
    checks
}

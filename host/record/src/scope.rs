//! What the drive has captured around an event: `scope.csv`, a table like the export of the record.

use std::path::Path;

use lashloop_bench::atomic_file::{WriteError, write_whole_at};
use lashloop_bench::scenario::Scenario;
use lashloop_plant::Signal;
use lashloop_plant::metrics::DRIVE_PREFIX;
use lashloop_session::CapturedRows;

use crate::columns::Columns;
use crate::export;
use crate::trace::TIME;

/// The rows as columns: the time since the event first, then each signal as `drive.NAME`.
#[must_use]
pub fn columns(captured: &CapturedRows, scenario: &Scenario) -> Columns {
    let CapturedRows { signals, every, event, rows } = captured;
    let of_drive = signals.iter().map(|it| Signal {
        name: format!("{DRIVE_PREFIX}{}", it.signal.name).into(),
        unit: it.signal.unit.clone(),
    });
    let mut columns = Columns::new([Signal::new(TIME, "s")].into_iter().chain(of_drive).collect());
    // In whole us, so that times are as round as the period.
    let interval_us = f64::from(*every) * f64::from(scenario.run.control_period_us);
    for (number, row) in (0_u32..).zip(rows) {
        let time_s = (f64::from(number) - f64::from(*event)) * interval_us / 1e6;
        columns.push(std::iter::once(time_s).chain(row.iter().map(|value| f64::from(*value))));
    }
    columns
}

/// Writes the columns. An older file stays until the new one is whole.
pub(crate) fn write(columns: &Columns, path: &Path) -> Result<(), WriteError> {
    write_whole_at(path, ".scope-", |path| export::csv(columns, path))
}

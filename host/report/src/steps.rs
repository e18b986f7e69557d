//! Steps of a run: the row of a step, and its round trip.

use lashloop_record::reader::Record;
use lashloop_record::timing::TimingRow;
use lashloop_record::trace::TIME;

/// The row of a step. A record may begin after the start of its run, so a step is found by its time; `None` outside.
pub(crate) fn row_of_step(record: &Record, step: u32) -> Option<usize> {
    let times_s = record.trace.get(TIME)?;
    let period_s = f64::from(record.manifest.period_us) * 1e-6;
    let at_s = f64::from(step) * period_s;
    let row = times_s.partition_point(|time_s| *time_s < at_s - period_s / 2.0);
    times_s.get(row).filter(|time_s| (*time_s - at_s).abs() < period_s / 2.0).map(|_| row)
}

/// From the start of sending a sample to the end of receiving its torque; NaN for a step without an answer.
pub(crate) fn round_trip_us(row: &TimingRow) -> f64 {
    parts_us(row).into_iter().sum()
}

/// The parts of the round trip; NaN for a part that was not measured.
pub(crate) fn parts_us(row: &TimingRow) -> [f64; 4] {
    [row.send_us, row.line_and_device_us, row.compute_us, row.receive_us]
}

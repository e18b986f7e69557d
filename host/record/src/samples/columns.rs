//! The fields of each message, and the values of a step in their order.

use lashloop_bench::run::Step;
use lashloop_plant::Signal;
use lashloop_plant::metrics::SignalTable;

use super::layout::{Field, FieldType};
use crate::row::Row;
use crate::timing::TimingRow;
use crate::trace::{drive_signal, fixed_columns, sent_columns, sent_values};

pub(super) const STEP_TOPIC: &str = "/step";
pub(super) const DRIVE_TOPIC: &str = "/drive";
pub(super) const FAULT_TOPIC: &str = "/fault";
pub(super) const LOG_TOPIC: &str = "/log";
/// Value of a time that a step doesn't have.
pub(super) const NO_TIME_NS: f64 = -1.0;
/// Whether a sample was sent in the step.
pub(super) const SAMPLED: &str = "sampled";

/// Fields of `/step`: the fixed columns without the time, the sample as sent, the signals of the plant, the timing without the
/// number of the step.
pub(super) fn step_fields(signals: &SignalTable) -> Vec<Field> {
    let float64 = |column: Signal| Field { ty: FieldType::Float64, column };
    let fixed = fixed_columns().skip(1).map(|column| {
        // A torque on the wire is an f32.
        let ty = if column.name == "torque_nm" { FieldType::Float32 } else { FieldType::Float64 };
        Field { ty, column }
    });
    let sampled = Field { ty: FieldType::UInt8, column: Signal::new(SAMPLED, "") };
    let sent = sent_columns().map(|column| {
        let ty = if column.name.ends_with("_counts") { FieldType::Int32 } else { FieldType::Float32 };
        Field { ty, column }
    });
    // Whole nanoseconds take fewer bytes than a real number of microseconds, and lose nothing.
    let timing = timing_columns().map(|(name, unit)| match unit {
        "us" => {
            Field { ty: FieldType::Int64, column: Signal { name: in_ns(name).into(), unit: "ns".into() } }
        }
        _ => Field { ty: FieldType::UInt8, column: Signal::new(name, unit) },
    });
    let plant = signals.plant.iter().cloned().map(float64);
    fixed.chain([sampled]).chain(sent).chain(plant).chain(timing).collect()
}

/// Fields of `/drive`.
pub(super) fn drive_fields(signals: &SignalTable) -> Vec<Field> {
    signals.drive.iter().map(|it| Field { ty: FieldType::Float32, column: drive_signal(it) }).collect()
}

/// The values of `/step`.
pub(super) fn step_values(number: u64, step: &Step) -> impl Iterator<Item = f64> {
    let sent = sent_values(step);
    let sampled = f64::from(u8::from(step.sample.is_some()));
    let timing = TimingRow::new(number, &step.timing);
    let timing = timing.values().skip(1).zip(timing_columns()).map(|(value, (_, unit))| match unit {
        "us" if value.is_nan() => NO_TIME_NS,
        "us" => (1e3 * value).round(),
        _ => value,
    });
    let timing: Vec<_> = timing.collect();
    let fixed: Vec<_> = step.row.values().skip(1).collect();
    fixed.into_iter().chain([sampled]).chain(sent).chain(step.plant.iter().copied()).chain(timing)
}

/// Name and unit of each column of the timing but the number of the step.
pub(super) fn timing_columns() -> impl Iterator<Item = (&'static str, &'static str)> {
    TimingRow::COLUMNS.iter().copied().skip(1)
}

/// The name of a column in us, as one in ns.
pub(super) fn in_ns(name: &str) -> String {
    format!("{}_ns", name.strip_suffix("_us").unwrap_or(name))
}

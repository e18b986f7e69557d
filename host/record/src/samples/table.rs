//! A table of any columns as MCAP: a message per row, all fields real numbers.

use std::path::Path;

use lashloop_bench::atomic_file::{GrowingFile, WriteError};

use super::container::{MessageHead, Writer};
use super::encoder::full_schema_name;
use super::layout::{Field, FieldType, encode, schema};
use super::packing::PROFILE;
use super::step_times::StepTimes;
use super::writer::add_channel;
use crate::columns::Columns;
use crate::trace::TIME;

const TOPIC: &str = "/table";

/// Writes a table with one row per step. Its column `time_s` is the log time, counted from the start of the run.
///
/// # Errors
/// The file can't be written.
pub fn write_table(columns: &Columns, times: StepTimes, path: &Path) -> Result<(), WriteError> {
    let mut file = Writer::new(GrowingFile::create(path, ".samples-", b"")?, PROFILE);
    let field = |column: &lashloop_plant::Signal| Field { ty: FieldType::Float64, column: column.clone() };
    let fields: Vec<_> = columns.signals().iter().map(field).collect();
    let channel = add_channel(&mut file, TOPIC, &full_schema_name("Table"), &schema(&fields), times);
    let time_s = columns.get(TIME).unwrap_or_default();
    let mut message = Vec::new();
    for row in 0..columns.len() {
        let time_ns = times.start_ns + time_s.get(row).map_or(0, |time_s| (1e9 * time_s).round() as u64);
        encode(&fields, columns.row(row), &mut message);
        let sequence = row as u32;
        file.message(&MessageHead { channel, sequence, log_time: time_ns, publish_time: time_ns }, &message);
        if row % 1000 == 999 {
            file.flush()?;
        }
    }
    file.finish()
}

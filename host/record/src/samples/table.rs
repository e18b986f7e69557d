//! A table of any columns as MCAP: a message per row, all fields real numbers.

use std::path::Path;

use lashloop_bench::atomic_file::{GrowingFile, WriteError};

use super::container::{MessageHead, Writer};
use super::layout::{Field, FieldType, MESSAGE_ENCODING, SCHEMA_ENCODING, encode, schema};
use crate::columns::Columns;
use crate::trace::TIME;

const TOPIC: &str = "/table";

/// Writes a table with one row per step. Its column `time_s` is the log time.
///
/// # Errors
/// The file can't be written.
pub fn write_table(columns: &Columns, path: &Path) -> Result<(), WriteError> {
    let mut file = Writer::new(GrowingFile::create(path, ".samples-", b"")?, MESSAGE_ENCODING);
    let field = |column: &lashloop_plant::Signal| Field { ty: FieldType::Float64, column: column.clone() };
    let fields: Vec<_> = columns.signals().iter().map(field).collect();
    let schema = file.add_schema("lashloop/Table", SCHEMA_ENCODING, &schema(&fields));
    let channel = file.add_channel(schema, TOPIC, MESSAGE_ENCODING, &[]);
    let time_s = columns.get(TIME).unwrap_or_default();
    let mut message = Vec::new();
    for row in 0..columns.len() {
        let time_ns = time_s.get(row).map_or(0, |time_s| (1e9 * time_s).round() as u64);
        message.clear();
        encode(&fields, columns.row(row), &mut message);
        let sequence = row as u32;
        file.message(&MessageHead { channel, sequence, log_time: time_ns, publish_time: time_ns }, &message);
        if row % 1000 == 999 {
            file.flush()?;
        }
    }
    file.finish()
}

//! A table as Apache Parquet: one column of doubles each, NaN where there is no value.

use std::fs::File;
use std::io;
use std::path::Path;
use std::sync::Arc;

use lashloop_bench::atomic_file::WriteError;
use parquet::basic::{Compression, Repetition, Type as PhysicalType};
use parquet::data_type::DoubleType;
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;

use crate::columns::Columns;

/// Writes a table.
///
/// # Errors
/// The file can't be written.
pub(crate) fn write(columns: &Columns, path: &Path) -> Result<(), WriteError> {
    let error = |action| move |source| WriteError { path: path.to_owned(), action, source };
    let file = File::create(path).map_err(error("created"))?;
    encode(columns, file).map_err(io::Error::other).map_err(error("written"))
}

fn encode(columns: &Columns, file: File) -> Result<(), ParquetError> {
    let field = |name: &str| {
        let required =
            Type::primitive_type_builder(name, PhysicalType::DOUBLE).with_repetition(Repetition::REQUIRED);
        Ok(Arc::new(required.build()?))
    };
    let fields =
        columns.signals().iter().map(|signal| field(&signal.name)).collect::<Result<_, ParquetError>>()?;
    let schema = Arc::new(Type::group_type_builder("lashloop").with_fields(fields).build()?);
    let properties = WriterProperties::builder().set_compression(Compression::SNAPPY).build();
    let mut writer = SerializedFileWriter::new(file, schema, Arc::new(properties))?;
    let mut rows = writer.next_row_group()?;
    for signal in columns.signals() {
        if let Some(mut column) = rows.next_column()? {
            let values = columns.get(&signal.name).unwrap_or_default();
            column.typed::<DoubleType>().write_batch(values, None, None)?;
            column.close()?;
        }
    }
    rows.close()?;
    writer.close()?;
    Ok(())
}

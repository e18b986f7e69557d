//! A table as Apache Parquet: one column of doubles each, NaN where there is no value. The metadata have the units, as
//! `unit of NAME`.

use std::fs::File;
use std::io;
use std::path::Path;
use std::sync::Arc;

use lashloop_bench::atomic_file::WriteError;
use lashloop_plant::Signal;
use parquet::basic::{Compression, Repetition, Type as PhysicalType};
use parquet::data_type::DoubleType;
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
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
    let unit = |signal: &Signal| KeyValue::new(format!("unit of {}", signal.name), signal.unit.to_string());
    let properties = WriterProperties::builder()
        .set_compression(Compression::SNAPPY)
        .set_key_value_metadata(Some(columns.signals().iter().map(unit).collect()))
        .build();
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

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use parquet::file::reader::{FileReader, SerializedFileReader};
    use parquet::record::RowAccessor;

    use super::*;

    #[test]
    fn a_file_reads_back_to_the_same_bits() {
        let columns = Columns::from_parts([
            (Signal::new("time_s", "s"), vec![0.0, 0.001, 0.002]),
            (Signal::new("drive.load_error_rad", "rad"), vec![f64::NAN, -1.0 / 3.0, 5e-324]),
        ]);
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("export.parquet");
        write(&columns, &path).expect("a file");
        let file = SerializedFileReader::new(File::open(&path).expect("a file")).expect("Parquet");
        let metadata = file.metadata().file_metadata();
        let pairs = metadata.key_value_metadata().expect("units");
        let units: BTreeMap<_, _> = pairs.iter().map(|it| (&*it.key, it.value.as_deref())).collect();
        assert_eq!(units.get("unit of drive.load_error_rad"), Some(&Some("rad")));
        let rows = file.get_row_iter(None).expect("rows");
        let read: Vec<_> = rows
            .map(|row| row.expect("a row"))
            .map(|row| [0, 1].map(|column| row.get_double(column).expect("a double").to_bits()).to_vec())
            .collect();
        let bits = |row: usize| columns.row(row).map(f64::to_bits).collect::<Vec<_>>();
        let want: Vec<_> = (0..3).map(bits).collect();
        assert_eq!(read, want);
        let names: Vec<_> = metadata.schema_descr().columns().iter().map(|it| it.name().to_owned()).collect();
        assert_eq!(names, ["time_s", "drive.load_error_rad"]);
    }
}

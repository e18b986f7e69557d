//! Tables as Apache Parquet, written group of rows by group of rows. A record has one column of doubles for each signal, NaN
//! where there is no value, and the units in the metadata, as `unit of NAME`.

use std::fs::File;
use std::io::{self, Write};
use std::path::Path;
use std::sync::Arc;

use lashloop_bench::atomic_file::WriteError;
use parquet::basic::{Compression, ConvertedType, Repetition, Type as PhysicalType};
use parquet::data_type::{ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;

use crate::columns::Columns;

/// A column of a group of rows.
#[derive(Debug, Clone)]
pub enum Column {
    /// Whole numbers.
    Whole(Vec<i64>),
    /// Real numbers.
    Real(Vec<f64>),
    /// Real numbers; `None` is null.
    Optional(Vec<Option<f64>>),
    /// Texts.
    Text(Vec<String>),
}

/// Writes a table.
pub struct ParquetWriter<W: Write + Send>(SerializedFileWriter<W>);

impl<W: Write + Send> ParquetWriter<W> {
    /// Begins a file. `columns` have names and types, `metadata` names and values.
    ///
    /// # Errors
    /// The file can't be written.
    pub fn new<'a>(
        file: W,
        columns: impl IntoIterator<Item = (&'a str, &'a Column)>,
        metadata: impl IntoIterator<Item = (String, String)>,
    ) -> io::Result<Self> {
        let fields = columns.into_iter().map(|(name, column)| Ok(Arc::new(column.field(name)?)));
        let fields = fields.collect::<Result<_, ParquetError>>()?;
        let schema = Arc::new(Type::group_type_builder("lashloop").with_fields(fields).build()?);
        let metadata = metadata.into_iter().map(|(name, value)| KeyValue::new(name, value));
        let properties = WriterProperties::builder()
            .set_compression(Compression::SNAPPY)
            .set_key_value_metadata(Some(metadata.collect()))
            .build();
        Ok(Self(SerializedFileWriter::new(file, schema, Arc::new(properties))?))
    }

    /// Writes a group of rows.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn write(&mut self, columns: impl IntoIterator<Item = Column>) -> io::Result<()> {
        let mut group = self.0.next_row_group()?;
        for column in columns {
            let Some(mut out) = group.next_column()? else { break };
            match column {
                Column::Whole(values) => out.typed::<Int64Type>().write_batch(&values, None, None)?,
                Column::Real(values) => out.typed::<DoubleType>().write_batch(&values, None, None)?,
                Column::Optional(values) => {
                    let levels: Vec<_> = values.iter().map(|value| i16::from(value.is_some())).collect();
                    let present: Vec<_> = values.into_iter().flatten().collect();
                    out.typed::<DoubleType>().write_batch(&present, Some(&levels), None)?
                }
                Column::Text(values) => {
                    let values: Vec<_> = values.into_iter().map(|text| text.into_bytes().into()).collect();
                    out.typed::<ByteArrayType>().write_batch(&values, None, None)?
                }
            };
            out.close()?;
        }
        group.close()?;
        Ok(())
    }

    /// Writes the end of the file.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn finish(self) -> io::Result<()> {
        self.0.close()?;
        Ok(())
    }
}

impl Column {
    fn field(&self, name: &str) -> Result<Type, ParquetError> {
        let (kind, repetition, converted) = match self {
            Self::Whole(_) => (PhysicalType::INT64, Repetition::REQUIRED, ConvertedType::NONE),
            Self::Real(_) => (PhysicalType::DOUBLE, Repetition::REQUIRED, ConvertedType::NONE),
            Self::Optional(_) => (PhysicalType::DOUBLE, Repetition::OPTIONAL, ConvertedType::NONE),
            Self::Text(_) => (PhysicalType::BYTE_ARRAY, Repetition::REQUIRED, ConvertedType::UTF8),
        };
        let field = Type::primitive_type_builder(name, kind).with_repetition(repetition);
        field.with_converted_type(converted).build()
    }
}

/// Writes the columns of a record.
///
/// # Errors
/// The file can't be written.
pub(crate) fn write(columns: &Columns, path: &Path) -> Result<(), WriteError> {
    let error = |action| move |source| WriteError { path: path.to_owned(), action, source };
    let file = File::create(path).map_err(error("created"))?;
    encode(columns, file).map_err(error("written"))
}

fn encode(columns: &Columns, file: File) -> io::Result<()> {
    let (signals, real) = (columns.signals(), Column::Real(Vec::new()));
    let names = signals.iter().map(|signal| (&*signal.name, &real));
    let units = signals.iter().map(|it| (format!("unit of {}", it.name), it.unit.to_string()));
    let values = signals.iter().map(|it| Column::Real(columns.get(&it.name).unwrap_or_default().to_vec()));
    let mut writer = ParquetWriter::new(file, names, units)?;
    writer.write(values)?;
    writer.finish()
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use lashloop_plant::Signal;
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

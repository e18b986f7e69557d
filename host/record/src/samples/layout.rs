//! The layout of a message: fields of fixed size. The schema is the text of a ROS 2 message; the comment of a field has the
//! name and the unit of its column.

use std::fmt::Write;

use lashloop_plant::Signal;

use super::packing::{Packing, Unpacker, begin, push};

/// Type of a field.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum FieldType {
    Float64,
    Float32,
    Int64,
    Int32,
    UInt8,
}

/// A field with the column that it holds.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Field {
    pub(crate) ty: FieldType,
    pub(crate) column: Signal,
}

impl FieldType {
    const ALL: [Self; 5] = [Self::Float64, Self::Float32, Self::Int64, Self::Int32, Self::UInt8];

    fn name(self) -> &'static str {
        match self {
            Self::Float64 => "float64",
            Self::Float32 => "float32",
            Self::Int64 => "int64",
            Self::Int32 => "int32",
            Self::UInt8 => "uint8",
        }
    }

    /// Appends a value that fits the type.
    fn push(self, value: f64, message: &mut Vec<u8>) {
        match self {
            Self::Float64 => push(value.to_le_bytes(), message),
            Self::Float32 => push((value as f32).to_le_bytes(), message),
            Self::Int64 => push((value as i64).to_le_bytes(), message),
            Self::Int32 => push((value as i32).to_le_bytes(), message),
            Self::UInt8 => push([value as u8], message),
        }
    }

    /// The next value of a message; `None` at its end.
    fn take(self, message: &mut Unpacker<'_>) -> Option<f64> {
        Some(match self {
            Self::Float64 => f64::from_le_bytes(message.take()?),
            Self::Float32 => f32::from_le_bytes(message.take()?).into(),
            // Times in ns: exact for 104 days.
            Self::Int64 => i64::from_le_bytes(message.take()?) as f64,
            Self::Int32 => i32::from_le_bytes(message.take()?).into(),
            Self::UInt8 => message.take::<1>()?[0].into(),
        })
    }
}

/// The fields as the text of a ROS message.
pub(crate) fn schema(fields: &[Field]) -> String {
    let mut used = Vec::new();
    fields.iter().fold(String::new(), |mut text, Field { ty, column: Signal { name, unit } }| {
        let field = identifier(name, &used);
        // A String takes every character.
        let _ = writeln!(text, "{} {field} # {name} [{unit}]", ty.name());
        used.push(field);
        text
    })
}

/// The fields of a schema; `None` if it isn't one of this layout.
pub(crate) fn fields(schema: &str) -> Option<Vec<Field>> {
    let field = |line: &str| {
        let (declaration, comment) = line.split_once(" # ")?;
        let (ty, _) = declaration.split_once(' ')?;
        let ty = FieldType::ALL.into_iter().find(|it| it.name() == ty)?;
        let (name, unit) = comment.strip_suffix(']')?.rsplit_once(" [")?;
        let column = Signal { name: name.to_owned().into(), unit: unit.to_owned().into() };
        Some(Field { ty, column })
    };
    schema.lines().map(field).collect()
}

/// Writes the values to `message`.
pub(crate) fn encode(fields: &[Field], values: impl IntoIterator<Item = f64>, message: &mut Vec<u8>) {
    begin(message);
    for (field, value) in fields.iter().zip(values) {
        field.ty.push(value, message);
    }
}

/// Appends the values of a message to `values`; `false` if it is shorter than its fields.
pub(crate) fn decode(fields: &[Field], packing: Packing, message: &[u8], values: &mut Vec<f64>) -> bool {
    let Some(mut message) = Unpacker::new(packing, message) else { return false };
    fields.iter().all(|field| field.ty.take(&mut message).map(|value| values.push(value)).is_some())
}

/// A name as ROS 2 allows it, without underscores next to each other or at the end, and unlike those before.
fn identifier(name: &str, used: &[String]) -> String {
    let name = name.strip_prefix(lashloop_plant::metrics::DRIVE_PREFIX).unwrap_or(name).to_ascii_lowercase();
    let words = name.split(|c: char| !c.is_ascii_alphanumeric()).filter(|word| !word.is_empty());
    let mut field = words.collect::<Vec<_>>().join("_");
    if !field.starts_with(|c: char| c.is_ascii_lowercase()) {
        field.insert(0, 'f');
    }
    while used.contains(&field) {
        field.push_str("_2");
    }
    field
}

#[cfg(test)]
mod tests {
    use super::*;

    fn field(ty: FieldType, name: &'static str, unit: &'static str) -> Field {
        Field { ty, column: Signal::new(name, unit) }
    }

    #[test]
    fn a_schema_reads_back_with_any_name() {
        let fields_written = [
            field(FieldType::Float64, "twist_rad", "rad"),
            field(FieldType::Float32, "middle mass, [2] # speed", "N m s/rad"),
            field(FieldType::Int32, "Middle_mass, [2] # speed", ""),
            field(FieldType::UInt8, "3rd", "1"),
            field(FieldType::UInt8, "_", "1"),
            field(FieldType::Float32, "drive.load_error_rad", "rad"),
        ];
        let text = schema(&fields_written);
        assert_eq!(fields(&text).as_deref(), Some(&fields_written[..]));
        let names: Vec<_> = text.lines().filter_map(|line| line.split(' ').nth(1)).collect();
        let plain = "middle_mass_2_speed";
        let second = format!("{plain}_2");
        assert_eq!(names, ["twist_rad", plain, &second, "f3rd", "f", "load_error_rad"]);
    }

    #[test]
    fn values_read_back_to_the_same_bits() {
        let fields = [
            field(FieldType::Float64, "a", ""),
            field(FieldType::Float32, "b", ""),
            field(FieldType::Int32, "c", ""),
            field(FieldType::UInt8, "d", ""),
            field(FieldType::Int64, "e", ""),
        ];
        let values = [-1.0 / 3.0, f64::from(0.1_f32), -8_388_608.0, 1.0, 9e15];
        let mut bytes = Vec::new();
        encode(&fields, values, &mut bytes);
        let packed = [
            &values[0].to_le_bytes()[..],
            &0.1_f32.to_le_bytes(),
            &(-8_388_608_i32).to_le_bytes(),
            &[1],
            &9_000_000_000_000_000_i64.to_le_bytes(),
        ]
        .concat();
        // A head, and three bytes and four before the last number.
        assert_eq!(bytes.len(), 4 + packed.len() + 7);
        for (packing, bytes) in [(Packing::Cdr, &bytes), (Packing::Ros1, &packed)] {
            let mut read = Vec::new();
            assert!(decode(&fields, packing, bytes, &mut read));
            assert_eq!(read.iter().map(|it| it.to_bits()).collect::<Vec<_>>(), values.map(f64::to_bits));
            assert!(!decode(&fields, packing, &bytes[..bytes.len() - 1], &mut read));
        }
    }
}

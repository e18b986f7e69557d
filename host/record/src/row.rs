//! Rows whose columns are declared once.

use crate::reader::{ReadError, Table};

/// A row of numbers in a table with named columns.
pub trait Row: Sized {
    /// Name and unit of each column, in their order in the file.
    const COLUMNS: &'static [(&'static str, &'static str)];

    /// The values, in the order of [`COLUMNS`](Self::COLUMNS).
    fn values(&self) -> impl Iterator<Item = f64>;

    /// Reads all rows of a table, each column by its name. Further columns are ignored.
    ///
    /// # Errors
    /// The table lacks a column.
    fn read(table: &Table) -> Result<Vec<Self>, ReadError>;
}

/// Declares the columns of a row: the name of each field with its unit.
macro_rules! row {
    ($row:ident { $($column:ident: $unit:literal,)+ }) => {
        impl $crate::row::Row for $row {
            const COLUMNS: &'static [(&'static str, &'static str)] = &[$((stringify!($column), $unit)),+];

            fn values(&self) -> impl Iterator<Item = f64> {
                [$(self.$column),+].into_iter()
            }

            fn read(
                table: &$crate::reader::Table,
            ) -> Result<Vec<Self>, $crate::reader::ReadError> {
                $(let $column = table.column(stringify!($column))?;)+
                Ok((0..table.len()).map(|row| Self { $($column: $column[row]),+ }).collect())
            }
        }
    };
}

pub(crate) use row;

//! Rows whose columns are declared once.

use super::reader::{ReadError, Table};

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

/// Declares a row. A column has the name of its field, then its unit.
macro_rules! row {
    (
        $(#[$attribute:meta])*
        pub struct $row:ident {
            $($(#[$doc:meta])* $column:ident: $unit:literal,)+
        }
    ) => {
        $(#[$attribute])*
        #[derive(Debug, Clone, Copy, PartialEq)]
        pub struct $row {
            $($(#[$doc])* pub $column: f64,)+
        }

        impl $crate::record::row::Row for $row {
            const COLUMNS: &'static [(&'static str, &'static str)] = &[$((stringify!($column), $unit)),+];

            fn values(&self) -> impl Iterator<Item = f64> {
                [$(self.$column),+].into_iter()
            }

            fn read(
                table: &$crate::record::reader::Table,
            ) -> Result<Vec<Self>, $crate::record::reader::ReadError> {
                $(let $column = table.column(stringify!($column))?;)+
                Ok((0..table.len()).map(|row| Self { $($column: $column[row]),+ }).collect())
            }
        }
    };
}

pub(super) use row;

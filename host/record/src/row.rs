//! Rows whose columns are declared once.

/// A row of numbers in a table with named columns.
pub trait Row: Sized {
    /// Name and unit of each column, in their order in the file.
    const COLUMNS: &'static [(&'static str, &'static str)];

    /// The values, in the order of [`COLUMNS`](Self::COLUMNS).
    fn values(&self) -> impl Iterator<Item = f64>;

    /// The row with these values; `value` is called once for each column, in their order.
    fn of(value: impl FnMut() -> f64) -> Self;
}

/// Declares the columns of a row: the name of each field with its unit.
macro_rules! row {
    ($row:ident { $($column:ident: $unit:literal,)+ }) => {
        impl $crate::row::Row for $row {
            const COLUMNS: &'static [(&'static str, &'static str)] = &[$((stringify!($column), $unit)),+];

            fn values(&self) -> impl Iterator<Item = f64> {
                [$(self.$column),+].into_iter()
            }

            fn of(mut value: impl FnMut() -> f64) -> Self {
                Self { $($column: value()),+ }
            }
        }
    };
}

pub(crate) use row;

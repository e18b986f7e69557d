//! Columns of numbers with names and units.

use lashloop_plant::Signal;

use crate::row::Row;

/// A table in memory: one column for each signal, all of the same length.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Columns {
    signals: Vec<Signal>,
    values: Vec<Vec<f64>>,
}

impl Columns {
    /// Empty columns of these names and units.
    #[must_use]
    pub fn new(signals: Vec<Signal>) -> Self {
        let values = vec![Vec::new(); signals.len()];
        Self { signals, values }
    }

    /// Columns with their values, which are of one length.
    #[must_use]
    pub(crate) fn from_parts(parts: impl IntoIterator<Item = (Signal, Vec<f64>)>) -> Self {
        let (signals, values) = parts.into_iter().unzip();
        Self { signals, values }
    }

    /// Appends a row: a value for each signal, in their order.
    ///
    /// # Panics
    /// The row has another number of values than the table has signals.
    pub fn push(&mut self, row: impl IntoIterator<Item = f64>) {
        let mut row = row.into_iter();
        for column in &mut self.values {
            column.push(row.next().expect("a value for each signal"));
        }
        assert!(row.next().is_none(), "a signal for each value");
    }

    /// Name and unit of each column.
    #[must_use]
    pub fn signals(&self) -> &[Signal] {
        &self.signals
    }

    /// The values of a column; `None` if the table has no column of this name.
    #[must_use]
    pub fn get(&self, name: &str) -> Option<&[f64]> {
        self.position(name).map(|at| &self.values[at][..])
    }

    /// The unit of a column; `None` if the table has no column of this name.
    #[must_use]
    pub fn unit(&self, name: &str) -> Option<&str> {
        self.position(name).map(|at| &*self.signals[at].unit)
    }

    /// All rows, each column by its name; NaN for a column that the table lacks.
    #[must_use]
    pub fn rows<R: Row>(&self) -> Vec<R> {
        let columns: Vec<_> = R::COLUMNS.iter().map(|(name, _)| self.get(name).unwrap_or_default()).collect();
        let row = |row: usize| {
            let mut values = columns.iter().map(|column| column.get(row).copied().unwrap_or(f64::NAN));
            R::of(|| values.next().unwrap_or(f64::NAN))
        };
        (0..self.len()).map(row).collect()
    }

    /// The rows whose index `keep` accepts.
    #[must_use]
    pub fn select(&self, keep: impl Fn(usize) -> bool) -> Self {
        let kept = |column: &Vec<f64>| {
            let rows = column.iter().enumerate().filter(|(row, _)| keep(*row));
            rows.map(|(_, value)| *value).collect()
        };
        Self { signals: self.signals.clone(), values: self.values.iter().map(kept).collect() }
    }

    /// The values of a row, in the order of the columns.
    ///
    /// # Panics
    /// There is no such row.
    pub fn row(&self, row: usize) -> impl Iterator<Item = f64> {
        self.values.iter().map(move |column| column[row])
    }

    /// Number of rows.
    #[must_use]
    pub fn len(&self) -> usize {
        self.values.first().map_or(0, Vec::len)
    }

    /// Whether the table has no rows.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    fn position(&self, name: &str) -> Option<usize> {
        self.signals.iter().position(|signal| signal.name == name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn signal(name: &'static str, unit: &'static str) -> Signal {
        Signal { name: name.into(), unit: unit.into() }
    }

    #[test]
    fn columns_are_found_by_name_and_keep_their_unit() {
        let mut table = Columns::new(vec![signal("time_s", "s"), signal("twist", "rad")]);
        table.push([0.0, 1.0]);
        table.push([0.5, -1.0]);
        assert_eq!((table.get("twist"), table.unit("twist")), (Some(&[1.0, -1.0][..]), Some("rad")));
        assert_eq!((table.get("gap"), table.len()), (None, 2));
        assert_eq!(table.select(|row| row == 1).get("time_s"), Some(&[0.5][..]));
    }

    #[test]
    #[should_panic(expected = "a signal for each value")]
    fn a_row_with_too_many_values_is_a_bug() {
        Columns::new(vec![signal("time_s", "s")]).push([0.0, 1.0]);
    }
}

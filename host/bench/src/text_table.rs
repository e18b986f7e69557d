//! Tables of plain text.

/// Rows as lines, in columns as wide as their widest cell and two spaces apart. `is_right` chooses the columns that are aligned
/// to the right.
pub fn aligned<R: AsRef<[String]>>(rows: &[R], is_right: impl Fn(usize) -> bool) -> Vec<String> {
    let mut widths = Vec::new();
    for row in rows {
        for (column, cell) in row.as_ref().iter().enumerate() {
            widths.resize(widths.len().max(column + 1), 0);
            widths[column] = widths[column].max(cell.chars().count());
        }
    }
    let line = |row: &R| {
        let cells = row.as_ref().iter().zip(&widths).enumerate().map(|(column, (cell, width))| {
            if is_right(column) { format!("{cell:>width$}") } else { format!("{cell:<width$}") }
        });
        cells.collect::<Vec<_>>().join("  ").trim_end().to_owned()
    };
    rows.iter().map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_as_wide_as_their_widest_cell() {
        let rows = [["name", "value", "unit"], ["µ", "0.25", ""], ["torque_nm", "12", "N m"]];
        let rows = rows.map(|row| row.map(str::to_owned));
        let lines = aligned(&rows, |column| column == 1);
        assert_eq!(lines, ["name       value  unit", "µ           0.25", "torque_nm     12  N m"]);
    }
}

//! Linear least squares, summed up row by row.

use nalgebra::{DMatrix, DVector};

/// Share of each diagonal element that is added to it, and what is added to one that is 0: a column that no row shows stays 0.
const RIDGE: f64 = 1e-9;
const RIDGE_LEAST: f64 = 1e-12;

/// Products of the columns with each other and with the values.
pub(crate) struct LeastSquares {
    matrix: DMatrix<f64>,
    right: DVector<f64>,
    square: f64,
    rows: f64,
}

impl LeastSquares {
    pub(crate) fn new(columns: usize) -> Self {
        let (matrix, right) = (DMatrix::zeros(columns, columns), DVector::zeros(columns));
        Self { matrix, right, square: 0.0, rows: 0.0 }
    }

    pub(crate) fn add(&mut self, row: &[f64], value: f64, weight: f64) {
        for (i, &left) in row.iter().enumerate() {
            let left = left * weight;
            self.right[i] += left * value;
            for (j, &right) in row[..=i].iter().enumerate() {
                self.matrix[(i, j)] += left * right;
            }
        }
        self.square += weight * value * value;
        self.rows += weight;
    }

    /// Sum of the weights.
    pub(crate) fn rows(&self) -> f64 {
        self.rows
    }

    /// Root mean square of the values.
    pub(crate) fn root_mean_square(&self) -> f64 {
        (self.square / self.rows).sqrt()
    }

    /// The solution, and the sum of the squares that it leaves. `None` if the columns don't differ.
    pub(crate) fn solve(&self) -> Option<(DVector<f64>, f64)> {
        let mut matrix = self.matrix.clone();
        for i in 0..matrix.nrows() {
            // The factorisation reads the lower triangle alone.
            matrix[(i, i)] += RIDGE * matrix[(i, i)] + RIDGE_LEAST;
        }
        let solution = matrix.cholesky()?.solve(&self.right);
        let left = (self.square - solution.dot(&self.right)).max(0.0);
        Some((solution, left))
    }
}

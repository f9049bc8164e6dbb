//! Square matrices, as small as a count of streams.

/// A square matrix, row by row.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Matrix {
    size: usize,
    values: Vec<f64>,
}

impl Matrix {
    /// From the value at each row and column.
    pub(super) fn from_fn(size: usize, value: impl Fn(usize, usize) -> f64) -> Self {
        let values = (0..size * size).map(|index| value(index / size, index % size)).collect();
        Self { size, values }
    }

    /// One row.
    pub(super) fn row(&self, row: usize) -> &[f64] {
        &self.values[row * self.size..(row + 1) * self.size]
    }

    /// Values of two matrices, combined one by one.
    pub(super) fn zip(&self, other: &Self, combine: impl Fn(f64, f64) -> f64) -> Self {
        let values = self.values.iter().zip(&other.values).map(|(a, b)| combine(*a, *b)).collect();
        Self { size: self.size, values }
    }

    /// Each value, and whether it is on the diagonal, made another.
    pub(super) fn map(&self, change: impl Fn(f64, bool) -> f64) -> Self {
        let on_diagonal = |index: usize| index / self.size == index % self.size;
        let values = self.values.iter().enumerate().map(|(index, value)| change(*value, on_diagonal(index)));
        Self { size: self.size, values: values.collect() }
    }

    /// The matrix product.
    pub(super) fn times(&self, other: &Self) -> Self {
        let mut values = vec![0.0; self.values.len()];
        for (row, sums) in values.chunks_exact_mut(self.size).enumerate() {
            for (factor, line) in self.row(row).iter().zip(other.values.chunks_exact(self.size)) {
                add_multiple(sums, line, *factor);
            }
        }
        Self { size: self.size, values }
    }

    /// The product with a column.
    pub(super) fn times_column(&self, column: &[f64]) -> Vec<f64> {
        (0..self.size).map(|row| dot(self.row(row), column)).collect()
    }

    /// What this matrix times gives `right`, which has as many columns as it likes, row by row: Gauss's elimination with pivots.
    pub(super) fn solve(mut self, mut right: Vec<f64>) -> Vec<f64> {
        let (size, width) = (self.size, right.len() / self.size);
        for step in 0..size {
            let at = |row: usize| self.values[row * size + step].abs();
            let pivot = (step..size).max_by(|a, b| at(*a).total_cmp(&at(*b))).unwrap_or(step);
            swap_rows(&mut self.values, size, step, pivot);
            swap_rows(&mut right, width, step, pivot);
            let (done, below) = self.values.split_at_mut((step + 1) * size);
            let (right_done, right_below) = right.split_at_mut((step + 1) * width);
            let (line, right_line) = (&done[step * size..], &right_done[step * width..]);
            for (row, right_row) in below.chunks_exact_mut(size).zip(right_below.chunks_exact_mut(width)) {
                let factor = -row[step] / line[step];
                add_multiple(&mut row[step..], &line[step..], factor);
                add_multiple(right_row, right_line, factor);
            }
        }
        for step in (0..size).rev() {
            let (above, line) = right.split_at_mut(step * width);
            let line = &mut line[..width];
            line.iter_mut().for_each(|value| *value /= self.values[step * size + step]);
            for (row, right_row) in above.chunks_exact_mut(width).enumerate() {
                add_multiple(right_row, line, -self.values[row * size + step]);
            }
        }
        right
    }

    /// As [`Self::solve`], of a square right side.
    pub(super) fn solve_matrix(self, right: Self) -> Self {
        let size = self.size;
        Self { size, values: self.solve(right.values) }
    }

    /// The greatest magnitude.
    pub(super) fn greatest(&self) -> f64 {
        self.values.iter().fold(0.0, |greatest, value| value.abs().max(greatest))
    }
}

/// The sum of products.
pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn add_multiple(sums: &mut [f64], line: &[f64], factor: f64) {
    for (sum, value) in sums.iter_mut().zip(line) {
        *sum += factor * value;
    }
}

fn swap_rows(values: &mut [f64], width: usize, a: usize, b: usize) {
    if a != b {
        let (first, second) = values.split_at_mut(b * width);
        first[a * width..(a + 1) * width].swap_with_slice(&mut second[..width]);
    }
}

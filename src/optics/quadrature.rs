//! Gauss's quadrature, made on demand.

use std::f64::consts::PI;

/// The `count` nodes and weights of Gauss-Legendre quadrature from `low` to `high`, in rising order.
pub(super) fn gauss_legendre(count: usize, low: f64, high: f64) -> Vec<(f64, f64)> {
    let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
    let node = |index: usize| {
        // Newton's method from Tricomi's guess at the root; Legendre's polynomial by its recurrence, its slope beside it.
        let mut x = -((index as f64 + 0.75) / (count as f64 + 0.5) * PI).cos();
        let mut slope = 1.0;
        for _ in 0..6 {
            let (mut before, mut value) = (1.0, x);
            for order in 2..=count {
                let order = order as f64;
                (before, value) = (value, ((2.0 * order - 1.0) * x * value - (order - 1.0) * before) / order);
            }
            slope = count as f64 * (x * value - before) / (x * x - 1.0);
            x -= value / slope;
        }
        (middle + half * x, half * 2.0 / ((1.0 - x * x) * slope * slope))
    };
    (0..count).map(node).collect()
}

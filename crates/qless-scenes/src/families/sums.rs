//! Redundant equations `row_a + row_b`.

use qless::SystemBuilder;

use crate::Rng;

/// Terms of an equation: pairs `(DOF, coefficient)`.
pub(super) type Terms = Vec<(usize, f64)>;

/// Adds equations that are sums of two random rows among `0..count`. Pairs without a common DOF are preferred, because their sum is exact.
pub(super) fn add_sums(
    builder: &mut SystemBuilder,
    sums: usize,
    count: usize,
    row: impl Fn(usize) -> Terms,
    rng: &mut Rng,
) {
    let apart = |[a, b]: &[Terms; 2]| a.iter().all(|(j, _)| b.iter().all(|(k, _)| j != k));
    for k in 1..=sums {
        let mut draw = || {
            let pair = rng.drawn(2, count);
            [row(pair[0]), row(pair[1])]
        };
        let sum = (0..64).map(|_| draw()).find(apart).unwrap_or_else(draw).concat();
        builder.labelled_equation(format!("sum {k}"), sum, 0.0);
    }
}

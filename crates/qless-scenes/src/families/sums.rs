//! `row_a + row_b`: equations that say nothing new, to be found again.

use crate::Rng;

/// An equation's `(DOF, coefficient)`.
pub(super) type Terms = Vec<(usize, f64)>;

/// The sum of two of `count` rows, of such as share no DOF where a few draws find some: then it is exact.
pub(super) fn sum_of_two(count: usize, row: impl Fn(usize) -> Terms, rng: &mut Rng) -> Terms {
    let mut draw = || {
        let pair = rng.drawn(2, count);
        [row(pair[0]), row(pair[1])]
    };
    let apart = |[a, b]: &[Terms; 2]| a.iter().all(|(j, _)| b.iter().all(|(k, _)| j != k));
    (0..64).map(|_| draw()).find(apart).unwrap_or_else(draw).concat()
}

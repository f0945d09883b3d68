//! Rows near dependence: `row_3 = row_1 + row_2` except for a relative change eps in one coefficient.

use qless::SystemBuilder;

use super::MOST;
use crate::error::within;
use crate::{Scene, SceneError, Truth};

/// The coefficient in which the third row differs from the sum of the other two.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Near {
    /// The coefficient is in a column in which only the first and the third row have coefficients.
    Own,
    /// The coefficient is in a column in which the first two rows have coefficients too.
    Shared,
}

/// Unconnected triples of rows on 7 DOFs each; the third row of a triple is the sum of the others except for eps.
///
/// The exact rank of a triple is 3 if eps changes the coefficient, otherwise 2. The smallest singular value is about
/// eps / 10 of the largest. For `|eps|` up to 1e-4 the truth is marked ambiguous.
///
/// ```
/// use qless_scenes::families::{Near, near};
/// assert_eq!(near(1, 0.0, Near::Own)?.truth.rank_free, Some(2));
/// assert!(near(1, 1e-8, Near::Shared)?.truth.ambiguous);
/// # Ok::<(), qless_scenes::SceneError>(())
/// ```
///
/// # Errors
/// [`SceneError::Size`] without triples; [`SceneError::System`] for an eps that is not finite.
pub fn near(triples: usize, eps: f64, column: Near) -> Result<Scene, SceneError> {
    within("triples", triples, 1, MOST / 8)?;
    let first = [2.0, -1.0, 1.0, 0.0, 0.0, 0.0, 3.0];
    let second = [1.0, 3.0, 0.0, -2.0, 1.0, 1.0, 0.0];
    let mut third: [f64; 7] = std::array::from_fn(|j| first[j] + second[j]);
    let at = if column == Near::Own { 6 } else { 0 };
    let exact = third[at];
    third[at] *= 1.0 + eps;
    let mut builder = SystemBuilder::new(7 * triples);
    for triple in 0..triples {
        for row in [first, second, third] {
            builder.equation(row.into_iter().enumerate().map(|(j, a)| (7 * triple + j, a)), 0.0);
        }
    }
    let distinct = third[at] != exact;
    let rank = if distinct { 3 * triples } else { 2 * triples };
    Scene::bare(builder, Truth { ambiguous: distinct && eps.abs() <= 1e-4, ..Truth::rank(3 * triples, rank) })
}

//! Chains of equations with a prescribed or a free start, well-conditioned or near-singular.

use qless::SystemBuilder;

use super::MOST;
use crate::error::within;
use crate::{Scene, SceneError, Truth};

/// If the ratio of the largest to the smallest DOF exceeds this, the smallest singular value is below about 1e-4.
const STEEP: f64 = 1e4;

/// `u_i - u_(i+1) / factor = 0` for i = 1..n - 1, with `u_1 = 1` prescribed: `u_(i+1) = factor u_i`.
///
/// The rank is exactly n - 1. For a factor above 1 the smallest singular value decreases as `factor^-n`. The truth is marked
/// ambiguous if `factor^(n-1) > 1e4`, which long chains reach with a factor of 1.01.
///
/// ```
/// let scene = qless_scenes::families::geometric_chain(4, 2.0)?;
/// assert_eq!(scene.truth.generated, Some(vec![(1, 2.0), (2, 4.0), (3, 8.0)]));
/// assert!(qless_scenes::families::geometric_chain(3000, 1.01)?.truth.ambiguous);
/// # Ok::<(), qless_scenes::SceneError>(())
/// ```
///
/// # Errors
/// [`SceneError::Size`] for n < 2; [`SceneError::Number`] for a factor that is zero, infinite or NaN;
/// [`SceneError::System`] if `1 / factor` overflows.
pub fn geometric_chain(n: usize, factor: f64) -> Result<Scene, SceneError> {
    within("n", n, 2, MOST)?;
    if factor == 0.0 || !factor.is_finite() {
        return Err(SceneError::Number { what: "the factor", found: factor });
    }
    let mut builder = SystemBuilder::new(n);
    builder.prescribe(0, 1.0);
    for i in 1..n {
        builder.equation([(i - 1, 1.0), (i, -1.0 / factor)], 0.0);
    }
    let values = std::iter::successors(Some(factor), |u| Some(u * factor));
    solved(builder, n - 1, (1..n).zip(values).collect())
}

/// `u_(i-1) + 4 u_i + u_(i+1) = 0` with `u_1 = 0` and `u_2 = 1` prescribed: each row determines the next DOF.
///
/// The rank is exactly `rows`. The smallest singular value decreases as `3.73^-rows`: ambiguous from 7 rows on.
///
/// # Errors
/// [`SceneError::Size`] without rows.
pub fn recurrence(rows: usize) -> Result<Scene, SceneError> {
    within("rows", rows, 1, MOST)?;
    let mut builder = SystemBuilder::new(rows + 2);
    builder.prescribe(0, 0.0);
    builder.prescribe(1, 1.0);
    let (mut before, mut last) = (0.0, 1.0);
    let mut values = Vec::with_capacity(rows);
    for i in 1..=rows {
        builder.equation([(i - 1, 1.0), (i, 4.0), (i + 1, 1.0)], 0.0);
        (before, last) = (last, -4.0 * last - before);
        values.push((i + 1, last));
    }
    solved(builder, rows, values)
}

/// Each pair of DOFs is the previous pair `(a, b)` rotated by 45 degrees: `c (a - b)`, `c (a + b)`, c = 0.7071...
///
/// It has 2 n equations on 2 (n + 1) DOFs. A rotation changes no length, so the smallest singular value decreases only as
/// 1 / n, as that of [`super::path`].
///
/// # Errors
/// [`SceneError::Size`] for n = 0.
pub fn rotations(n: usize) -> Result<Scene, SceneError> {
    within("n", n, 1, MOST / 2)?;
    let c = std::f64::consts::FRAC_1_SQRT_2;
    let mut builder = SystemBuilder::new(2 * (n + 1));
    for i in 0..n {
        let (a, b) = (2 * i, 2 * i + 1);
        builder.equation([(a, c), (b, -c), (a + 2, -1.0)], 0.0);
        builder.equation([(a, c), (b, c), (b + 2, -1.0)], 0.0);
    }
    Scene::bare(builder, Truth::independent(2 * n).without_generated(true))
}

/// A scene in which every free DOF is fixed. The values are unknown if they exceed the range of a double.
fn solved(builder: SystemBuilder, rank: usize, values: Vec<(usize, f64)>) -> Result<Scene, SceneError> {
    let largest = values.iter().fold(1.0, |a: f64, (_, u)| a.max(u.abs()));
    let generated = values.iter().all(|(_, u)| u.is_finite()).then_some(values);
    Scene::bare(builder, Truth { generated, ambiguous: largest > STEEP, ..Truth::independent(rank) })
}

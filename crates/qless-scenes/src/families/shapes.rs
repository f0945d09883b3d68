//! Stars, arrows and ladders: patterns in which the choice of slaves or the order of elimination matters.

use qless::SystemBuilder;

use super::{MOST, incidence};
use crate::error::within;
use crate::{Scene, SceneError, Truth};

/// `u_1 - u_k = 0` for k = 2..=legs + 1: all equations start with the same DOF.
///
/// # Errors
/// [`SceneError::Size`] without legs.
pub fn spider(legs: usize) -> Result<Scene, SceneError> {
    within("legs", legs, 1, MOST)?;
    incidence(legs + 1, &(1..=legs).map(|k| (0, k, 0.0)).collect::<Vec<_>>())
}

/// `u_i - u_last = 0` for n DOFs; the last row is the sum of these n rows, dense and redundant.
///
/// ```
/// let scene = qless_scenes::families::arrow(3)?;
/// assert_eq!(scene.system.matrix().row(3).collect::<Vec<_>>(), [(0, 1.0), (1, 1.0), (2, 1.0), (3, -3.0)]);
/// # Ok::<(), qless_scenes::SceneError>(())
/// ```
///
/// # Errors
/// [`SceneError::Size`] for n = 0.
pub fn arrow(n: usize) -> Result<Scene, SceneError> {
    within("n", n, 1, MOST)?;
    let mut builder = SystemBuilder::new(n + 1);
    for i in 0..n {
        builder.equation([(i, 1.0), (n, -1.0)], 0.0);
    }
    builder.equation((0..n).map(|i| (i, 1.0)).chain([(n, -(n as f64))]), 0.0);
    Scene::bare(builder, Truth::rank(n + 1, n))
}

/// `u_i - 2 u_{i+1} = 0`: independent. With the wrong slaves the entries of T grow to `2^rungs`.
///
/// # Errors
/// [`SceneError::Size`] without rungs.
pub fn ladder(rungs: usize) -> Result<Scene, SceneError> {
    within("rungs", rungs, 1, MOST)?;
    let mut builder = SystemBuilder::new(rungs + 1);
    for i in 0..rungs {
        builder.equation([(i, 1.0), (i + 1, -2.0)], 0.0);
    }
    Scene::bare(builder, Truth::independent(rungs))
}

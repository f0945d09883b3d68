//! Band matrices, `(u_(i-1) + 4 u_i + u_(i+1)) / 6 = b_i`, with a few changed coefficients.

use qless::SystemBuilder;

use super::MOST;
use crate::error::within;
use crate::{Rng, Scene, SceneError, Truth};

/// Number of rows of a window. Only one of the first [`FIRST`] rows of a window may have a changed coefficient, so changed rows are at
/// least 9 rows apart.
const WINDOW: usize = 16;
const FIRST: usize = 8;

/// The n x n band `1/6, 4/6, 1/6`; in about one of 32 rows -1 or 4 replaces one coefficient.
///
/// In elimination from the first row, the pivots converge to 0.622, and return to it a few rows after a changed row. The
/// smallest pivots have size 1/3. So the rank is n, and every DOF has one value. The first window always has a changed row.
///
/// ```
/// let scene = qless_scenes::families::spotted_band(100, 1)?;
/// assert!(scene.system.matrix().values().iter().any(|&v| v == 4.0 || v == -1.0));
/// # Ok::<(), qless_scenes::SceneError>(())
/// ```
///
/// # Errors
/// [`SceneError::Size`] for n < 2.
pub fn spotted_band(n: usize, seed: u64) -> Result<Scene, SceneError> {
    within("n", n, 2, MOST)?;
    let mut rng = Rng::new(seed);
    let mut builder = SystemBuilder::new(n);
    for start in (0..n).step_by(WINDOW) {
        let length = WINDOW.min(n - start);
        let spot = (start == 0 || rng.below(2) == 0).then(|| rng.below(FIRST.min(length)));
        for k in 0..length {
            let mut row = row(start + k, n);
            if spot == Some(k) {
                let at = rng.below(row.len());
                row[at].1 = [-1.0, 4.0][rng.below(2)];
            }
            builder.equation(row, rng.below(7) as f64 - 3.0);
        }
    }
    Scene::bare(builder, Truth::independent(n))
}

fn row(i: usize, n: usize) -> Vec<(usize, f64)> {
    let columns = i.saturating_sub(1)..n.min(i + 2);
    columns.map(|j| (j, if j == i { 4.0 / 6.0 } else { 1.0 / 6.0 })).collect()
}

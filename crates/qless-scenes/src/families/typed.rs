//! Equations that were typed a second time, with coefficients rounded to a few digits.

use qless::SystemBuilder;

use super::MOST;
use crate::error::within;
use crate::{Rng, Scene, SceneError, Truth};

type TypedRow = Vec<(usize, f64)>;

/// n random equations, and rounded copies of about a third of them.
///
/// Each of the n equations has two DOFs that no later equation has, with coefficients of size 1 to 2, and up to four DOFs of
/// later equations, with coefficients of up to 1/4; so they are well-conditioned. A copy differs by up to `5 10^-digits`,
/// relative to each coefficient. All equations are independent, the copies only because of that difference. So the truth
/// is marked ambiguous. Rows and DOFs are in random order.
///
/// ```
/// let scene = qless_scenes::families::typed_twice(30, 6, 1)?;
/// assert_eq!(scene.truth.rank_free, Some(scene.system.equations()));
/// assert!(scene.system.equations() > 30 && scene.truth.ambiguous);
/// # Ok::<(), qless_scenes::SceneError>(())
/// ```
///
/// # Errors
/// [`SceneError::Size`] for n = 0 or digits other than 3 to 8.
pub fn typed_twice(n: usize, digits: usize, seed: u64) -> Result<Scene, SceneError> {
    within("n", n, 1, MOST / 2)?;
    within("digits", digits, 3, 8)?;
    let mut rng = Rng::new(seed);
    let place = rng.shuffled(2 * n);
    let mut equations = Vec::new();
    for i in 0..n {
        let (row, rhs) = (equation(i, &place, &mut rng), rng.below(7) as f64 - 3.0);
        if i == 0 || rng.below(3) == 0 {
            let copy = row.iter().map(|&(j, v)| (j, typed(v, digits))).collect();
            equations.push((format!("equation {}, typed again", i + 1), copy, rhs));
        }
        equations.push((format!("equation {}", i + 1), row, rhs));
    }
    rng.shuffle(&mut equations);
    let truth = Truth { ambiguous: true, ..Truth::independent(equations.len()) };
    let mut builder = SystemBuilder::new(2 * n);
    for (label, row, rhs) in equations {
        builder.labelled_equation(label, row, rhs);
    }
    Scene::bare(builder, truth)
}

/// Equation i: its own DOFs are `place[2 i]` and `place[2 i + 1]`.
fn equation(i: usize, place: &[usize], rng: &mut Rng) -> TypedRow {
    let mut own = |k: usize| {
        let v = rng.real();
        (place[2 * i + k], v + v.signum())
    };
    let mut row = vec![own(0), own(1)];
    let later = &place[2 * i + 2..];
    let wanted = 1 + rng.below(4);
    row.extend(rng.drawn(wanted, later.len()).into_iter().map(|k| (later[k], 0.25 * rng.real())));
    row
}

/// The number rounded to `digits` significant decimal digits.
pub(super) fn typed(value: f64, digits: usize) -> f64 {
    format!("{value:.*e}", digits - 1).parse().expect("a number in scientific notation")
}

//! Rods along unit vectors n, `n . (u_i - u_j) = 0`, with direction cosines that were typed with a few digits.

use qless::{Csr, SystemBuilder};

use super::MOST;
use super::typed::typed;
use crate::error::within;
use crate::oracle::exact_rank;
use crate::{Dof, Rng, Scene, SceneError, Truth};

/// Corners of a pentagon before they are moved by up to 0.2.
const CORNERS: [[f64; 2]; 5] = [[1.0, 0.0], [0.3, 0.95], [-0.8, 0.6], [-0.8, -0.6], [0.3, -0.95]];

/// A chain of n irregular pentagons in the plane, hinged to their neighbours, with rods between all corners of a pentagon.
///
/// Seven of the 10 rods of a pentagon make it rigid, and 3 are redundant. Cosines rounded to `digits` digits prevent its
/// rotation too: with them 8 rods are independent, one of them only by about `10^-digits`. So the 10 n equations on 8 n + 2 DOFs
/// have rank 8 n but are near rank 7 n, and the truth is marked ambiguous.
///
/// ```
/// let scene = qless_scenes::families::typed_cosines(3, 5, 1)?;
/// assert_eq!((scene.system.equations(), scene.system.dofs(), scene.truth.rank_free), (30, 26, Some(24)));
/// # Ok::<(), qless_scenes::SceneError>(())
/// ```
///
/// # Errors
/// [`SceneError::Size`] for n = 0 or digits other than 3 to 8.
pub fn typed_cosines(n: usize, digits: usize, seed: u64) -> Result<Scene, SceneError> {
    within("n", n, 1, MOST / 16)?;
    within("digits", digits, 3, 8)?;
    let mut rng = Rng::new(seed);
    let mut builder = SystemBuilder::new(2 * (4 * n + 1));
    let (mut nodes, mut rank) = (vec![[0.0; 3]], 0);
    for polygon in 0..n {
        let corners = corners(&mut rng);
        let hinge = nodes[4 * polygon];
        nodes.extend((1..5).map(|k| [0, 1, 2].map(|axis| hinge[axis] + corners[k][axis] - corners[0][axis])));
        let rods = rods(&corners, digits)?;
        rank += exact_rank(&rods)?;
        for row in 0..rods.rows() {
            let label = format!("polygon {}, rod {}", polygon + 1, row + 1);
            builder.labelled_equation(label, rods.row(row).map(|(j, v)| (8 * polygon + j, v)), 0.0);
        }
    }
    let dofs = Dof::of_nodes(nodes.len(), 2);
    let truth = Truth { ambiguous: true, ..Truth::rank(10 * n, rank) };
    Ok(Scene { system: builder.build()?, truth, nodes, dofs })
}

fn corners(rng: &mut Rng) -> [[f64; 3]; 5] {
    CORNERS.map(|[x, y]| [x + 0.2 * rng.real(), y + 0.2 * rng.real(), 0.0])
}

/// A row for each pair of corners. Its coefficients add up to exactly 0, so the ranks of pentagons with a common corner add up.
fn rods(corners: &[[f64; 3]; 5], digits: usize) -> Result<Csr, SceneError> {
    let mut rows = Csr::empty(10);
    for (a, b) in (0..5).flat_map(|b| (0..b).map(move |a| (a, b))) {
        let [x, y] = [0, 1].map(|axis| corners[a][axis] - corners[b][axis]);
        let length = (x * x + y * y).sqrt();
        let [x, y] = [x, y].map(|side| typed(side / length, digits));
        rows.push_row(
            [(2 * a, x), (2 * a + 1, y), (2 * b, -x), (2 * b + 1, -y)].into_iter().filter(|&(_, v)| v != 0.0),
        )?;
    }
    Ok(rows)
}

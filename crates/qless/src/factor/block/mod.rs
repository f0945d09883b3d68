//! The equations that remain after presolve, block by block: which rows depend on which, and how the DOFs can move (Eq. 21 and 22 of the
//! paper).
//!
//! The diagnosis factors `C^T`: its dependent columns are the dependent equations, and `R1 y = R2_k` gives the certificate of row k.
//! Heath-style rank detection is far more often right on `C^T` (tall) than on C. Random vectors of the null space ([`triangle`]) show
//! which DOFs can move. No slave is chosen here.

pub(crate) mod dependent;
mod gathered;
pub(crate) mod tableau;
pub(crate) mod triangle;
mod twins;
mod unexplained;

use crate::factor::backend::BackendError;
use dependent::Rows;
use triangle::{BlockVectors, Triangle};
use unexplained::{Explained, leaves_more_than_rounding, unexplained};

pub(crate) use gathered::{Block, FactorContext};
pub(crate) use twins::diagnose_all;

/// The diagnosis of a matrix; rows and DOFs are named by their places in it.
struct Found {
    rows: Rows,
    vectors: BlockVectors,
}

/// Finds which rows of a block depend on which, and how its DOFs can move.
///
/// The block is diagnosed in balanced units first, or in the units of its rows if these are near. What remains of a dropped row beside the
/// largest coefficients of the row then depends on the units; so if more than rounding remains in balanced units, the block is diagnosed
/// again in these. If a diagnosis in balanced units drops rows that are no combinations of others, the block is diagnosed again in the
/// units of its rows, and the result that keeps more rows is used. In balanced units the rotations of a motion can be so large that DOFs
/// with smaller motions seem fixed. If a DOF seems fixed, the motions are computed in the units of the rows too, and those with fewer
/// fixed DOFs are used.
fn diagnose(block: &mut Block, means: FactorContext) -> Result<Found, BackendError> {
    let mut rows = dependent::find(block, means)?;
    let mut vectors = rows.triangle.vectors(block);
    let all = Explained { unexplained: 0, is_exact: true };
    let found = if means.check { unexplained(block, &mut rows, &vectors.motions.moves) } else { all };
    let is_balanced = block.units.iter().any(|&unit| unit != 0);
    if !found.is_exact && !is_balanced && means.is_scaled {
        let mut balanced = block.clone();
        if balanced.balance() && leaves_more_than_rounding(&balanced, &rows) {
            let other = diagnose(&mut balanced, means)?;
            let Rows { kept, nearness, .. } = &other.rows;
            let keeps_more = kept.len() > rows.kept.len();
            // Rows that are nearer to the others than the tolerance stay dropped, with a doubt.
            if !(keeps_more && nearness.distance <= means.tolerance) {
                *block = balanced;
                return Ok(other);
            }
            let is_kept = |row: u32| block.rows.binary_search(&row).is_ok_and(|i| kept.binary_search(&i).is_ok());
            let added = rows.dependent.iter_mut().filter(|d| is_kept(d.row));
            added.for_each(|d| d.dropped = d.dropped.max(nearness.distance));
        }
    }
    if is_balanced && found.unexplained > 0 {
        let mut plain = block.clone();
        plain.restore_units();
        let mut other = dependent::find(&plain, means)?;
        if other.kept.len() > rows.kept.len() {
            vectors = other.triangle.vectors(&plain);
            unexplained(&plain, &mut other, &vectors.motions.moves);
            (*block, rows) = (plain, other);
        }
    }
    let BlockVectors { motions, solutions } = &mut vectors;
    motions.set_resting(&block.matrix, &rows.kept, rows.nearness.sigma);
    [&mut *motions].into_iter().chain(solutions).for_each(|some| some.restore_units(&block.units));
    if is_balanced && motions.resting() > 0 {
        let mut plain = block.clone();
        plain.restore_units();
        let triangle = Triangle::of(&plain, &rows.kept, &[], means)?;
        // If rows are dependent to the last bit in the units of the rows, the triangle lacks them, and its motions violate them.
        if triangle.rows.len() == rows.kept.len() {
            let mut other = triangle.motions(&plain);
            let hold = other.set_resting(&plain.matrix, &rows.kept, triangle.factor.smallest_singular_value().0);
            if hold && other.resting() < motions.resting() {
                *motions = other;
            }
        }
    }
    Ok(Found { rows, vectors })
}

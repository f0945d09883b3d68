//! Finds rows that a QR without pivoting kept although they are combinations of others to within the tolerance.
//!
//! ```text
//! N^T rows = 0      N, r x k: a basis of the near null space of R1, the factor of the kept rows
//! row_d = Y^T rows  R1 Y = R2: the dropped rows over the kept ones, to the accuracy of R1
//! row_W = ...       these equations solved for k weak rows W and the dropped rows d, over the remaining rows
//! ```
//!
//! Two factorizations are enough. The certificates of the first one are good to some digits, and decide which of equivalent equations are
//! kept. The second factorization computes the certificates to full accuracy.

use super::certificate::{Choice, Rows, STEEP, in_order, later, over_kept, rest, rows, sounder};
use crate::Csr;
use crate::factor::backend::faer::Faer;
use crate::factor::backend::null::Weak;
use crate::factor::backend::{Backend, BackendError};
use crate::factor::block::gathered::{Block, FactorContext};
use crate::factor::block::tableau::Tableau;
use crate::factor::block::triangle::{MANY, Triangle};
use crate::presolve::basis::NEAR;

/// Largest number of rounds in which rows are dropped and taken back in search of a sound choice.
pub(super) const ROUNDS: usize = 8;

/// Stands in place of a row number for a combination of rows that vanishes.
const NOTHING: u32 = u32::MAX;

/// The backend kept rows that are combinations of others to within the tolerance, as a QR without pivoting does if their remainders are
/// spread over many columns. The singular vectors identify these rows, and they are dropped. A dropped row that is no combination of the
/// kept rows comes back and stays. It comes back for one of two reasons: its certificate needs a row that is now dropped, or many
/// rows together are nearer to dependence than each alone. None if this does not lead to a sound choice.
pub(super) fn without_weak(
    block: &Block,
    means: FactorContext,
    first: &Choice,
    order: &[usize],
) -> Result<Option<Rows>, BackendError> {
    let limit = means.tolerance;
    let Triangle { factor, rows: kept, dropped, .. } = &first.triangle;
    let (mut kept, mut dropped) = (kept.clone(), dropped.clone());
    let mut sure = vec![false; block.matrix.rows()];
    let Some(found) = factor.weak_columns(limit, dropped.len())? else { return Ok(None) };
    let foreseen = foreseen(first, &found);
    // The first certificates also decide which of equivalent equations are kept.
    let mut is_ordered = foreseen.is_some();
    match foreseen {
        Some(Tableau { basic, free, .. }) => {
            let names = |some: Vec<u32>| some.into_iter().map(|k| k as usize).collect();
            (kept, dropped) = (names(free), names(basic));
        }
        None => drop_weak(found.columns, &mut kept, &mut dropped),
    }
    for _ in 0..ROUNDS {
        let mut choice = Choice::of(block, &kept, &dropped, means)?;
        kept.clone_from(&choice.triangle.rows);
        // Many rows together can be nearer to dependence than the tolerance, although no single row is.
        if choice.weakest.left <= limit {
            let Some(still) = choice.triangle.factor.weak_columns(limit, 0)? else { return Ok(None) };
            let weak: Vec<usize> = still.columns.into_iter().filter(|&k| !sure[kept[k]]).collect();
            if !weak.is_empty() {
                dropped.clone_from(&choice.triangle.dropped);
                drop_weak(weak, &mut kept, &mut dropped);
                is_ordered = false;
                continue;
            }
        }
        let tableau = over_kept(&mut choice.triangle);
        let unexplained = unexplained(block, &tableau, choice.triangle.rests(), limit)?;
        if unexplained.is_empty() {
            let left = choice.remainder(block);
            let settle = if is_ordered { sounder } else { in_order };
            let (tableau, choice) = settle(block, means, tableau, choice)?;
            let sound = choice.near.distance >= NEAR || choice.weakest.left > limit;
            return Ok(sound.then(|| rows(block, &tableau, left, choice, order.to_vec())));
        }
        unexplained.iter().for_each(|&k| sure[k] = true);
        is_ordered = false;
        dropped = choice.triangle.dropped.iter().copied().filter(|k| !unexplained.contains(k)).collect();
        kept.extend(unexplained);
    }
    Ok(None)
}

/// Moves rows from the kept to the dropped ones; `weak` has their positions among the kept ones.
fn drop_weak(mut weak: Vec<usize>, kept: &mut Vec<usize>, dropped: &mut Vec<usize>) {
    weak.sort_unstable_by(|a, b| b.cmp(a));
    dropped.extend(weak.into_iter().map(|k| kept.swap_remove(k)));
}

/// The dropped and the weak rows as combinations of the rest. Rows are exchanged to bound the coefficients by [`STEEP`] and to keep the
/// earlier ones of equivalent equations. None if the tableau is too large, or if some numbers are not finite.
fn foreseen(first: &Choice, weak: &Weak) -> Option<Tableau> {
    let mut tableau = without(weak, with_null_space(first, weak)?)?;
    tableau.limit(STEEP);
    // One exchange can make another one worthwhile.
    for _ in 0..ROUNDS {
        let before = tableau.basic.clone();
        tableau.prefer(later);
        if tableau.basic == before {
            break;
        }
    }
    Some(tableau)
}

/// A tableau of coefficients over all kept rows. Its first rows express the dropped rows. The rows after them are combinations of kept rows
/// that vanish; their name is [`NOTHING`]. None if the tableau is too large, or if the factor cannot express the dropped rows.
fn with_null_space(first: &Choice, weak: &Weak) -> Option<Tableau> {
    let Triangle { factor, rows, dropped, .. } = &first.triangle;
    let (width, nothings) = (rows.len(), weak.columns.len());
    if (dropped.len() + nothings).saturating_mul(width) > MANY || !first.triangle.holds_dropped() {
        return None;
    }
    let mut data = factor.all_coefficients().concat();
    data.reserve(nothings * width);
    (0..nothings).for_each(|c| data.extend((0..width).map(|i| weak.null[(i, c)])));
    let names = |some: &[usize]| some.iter().map(|&k| k as u32).collect::<Vec<_>>();
    let basic = [names(dropped), vec![NOTHING; nothings]].concat();
    data.iter().all(|v| v.is_finite()).then(|| Tableau { basic, free: names(rows), width, data })
}

/// Exchanges the weak rows with the vanishing combinations, and then removes the columns of these combinations.
fn without(weak: &Weak, mut tableau: Tableau) -> Option<Tableau> {
    let mut weak = weak.columns.clone();
    for i in (0..tableau.basic.len()).filter(|&i| tableau.basic[i] == NOTHING).collect::<Vec<_>>() {
        let row = tableau.row(i);
        let best = (0..weak.len()).max_by(|&a, &b| row[weak[a]].abs().total_cmp(&row[weak[b]].abs()))?;
        tableau.exchange(i, weak.swap_remove(best));
    }
    let stays: Vec<bool> = tableau.free.iter().map(|&k| k != NOTHING).collect();
    let mut place = (0..tableau.data.len()).map(|k| stays[k % stays.len()]);
    tableau.data.retain(|_| place.next().unwrap_or_default());
    tableau.free.retain(|&k| k != NOTHING);
    tableau.width = tableau.free.len();
    tableau.data.iter().all(|v| v.is_finite()).then_some(tableau)
}

/// Finds dropped rows that are independent of the kept rows and of each other. `rests` has the norms of what remains of the first rows of
/// `tableau`.
pub(super) fn unexplained(
    block: &Block,
    tableau: &Tableau,
    rests: &[f64],
    tolerance: f64,
) -> Result<Vec<usize>, BackendError> {
    let large: Vec<usize> = (0..rests.len()).filter(|&i| rests[i] > tolerance).collect();
    let mut rows = Csr::empty(block.matrix.cols);
    large.iter().for_each(|&i| rows.append(rest(block, tableau, i).into_iter().enumerate()));
    let factor = Faer.factor(&rows, &[], tolerance)?;
    Ok(factor.order[..factor.rank].iter().map(|&k| tableau.basic[large[k]] as usize).collect())
}

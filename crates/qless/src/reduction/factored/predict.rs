//! Bounds the number of nonzeros of T for each part, before any of T is formed.

use crate::input::components::Labels;
use crate::input::numbering::LocalSystem;
use crate::presolve::basis::Basis;

/// Sizes of a part.
#[derive(Clone, Copy, Default)]
pub(crate) struct Prediction {
    /// Number of nonzeros of the equations of the part.
    pub given: usize,
    /// Upper bound of the number of nonzeros of the rows of T of the part.
    pub predicted: usize,
    /// True if T needs substitution: a row contains another slave, or the part has a block.
    pub needs_work: bool,
}

/// Predicts the sizes of each part, by label. A row of T has at most the entries of its masters and of the rows of its slaves, and at most
/// one per master of the part. `row(t)` is the user's equation of row t of the basis, `block_row(k)` an equation of block k.
pub(crate) fn predict(
    local: LocalSystem,
    basis: &Basis,
    labels: &Labels,
    row: impl Fn(usize) -> usize,
    block_row: impl Fn(usize) -> usize,
) -> Vec<Prediction> {
    let mut all = vec![Prediction::default(); labels.count];
    let mut free_dofs = vec![0_usize; labels.count];
    let mut seen = vec![false; local.dofs()];
    for (i, &label) in labels.of_row.iter().enumerate() {
        let label = label as usize;
        all[label].given += local.length(i);
        for &j in local.parts(i).0 {
            if !std::mem::replace(&mut seen[j as usize], true) && local.free()[j as usize] {
                free_dofs[label] += 1;
            }
        }
    }
    let mut kept = vec![0; labels.count];
    (0..basis.rows()).for_each(|t| kept[labels.of_row[row(t)] as usize] += 1);
    let mut length = vec![1_usize; local.dofs()];
    let mut is_slave = vec![false; local.dofs()];
    for (k, block) in basis.blocks.iter().enumerate() {
        let label = labels.of_row[block_row(k)] as usize;
        kept[label] += block.rows.len();
        let masters = block.dofs.len() - block.rows.len();
        all[label].predicted += masters * block.rows.len();
        all[label].needs_work = true;
        block.dofs.iter().for_each(|&j| (length[j as usize], is_slave[j as usize]) = (masters, true));
    }
    for t in (0..basis.rows()).rev() {
        let label = labels.of_row[row(t)] as usize;
        let masters = free_dofs[label].saturating_sub(kept[label]);
        let mut sum = 0;
        for j in basis.row(local, t).dofs() {
            sum += length[j as usize];
            all[label].needs_work |= is_slave[j as usize];
        }
        let slave = basis.slave(t) as usize;
        (length[slave], is_slave[slave]) = (sum.min(masters), true);
        all[label].predicted += length[slave];
    }
    all
}

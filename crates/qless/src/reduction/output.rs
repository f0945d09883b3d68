//! `[T G g]` in the user's numbers: rows by ascending slave, columns by ascending master and prescribed DOF.
//!
//! Rows are read in the order of the basis and written to their places, because independent writes to random places cost far less than
//! dependent reads. O(nnz + n).

use super::Reduction;
use super::order::{RowRange, SlaveOrder, row_ranges};
use super::relation::Relation;
use crate::common::pool::{each, gather};
use crate::{ConstraintSystem, Csr};

pub(super) fn write(system: &ConstraintSystem, relation: &Relation) -> Reduction {
    let dofs = &relation.system.numbering.dofs;
    let mut side = vec![MASTER; system.dofs()];
    relation.slave.iter().for_each(|&s| side[dofs[s as usize] as usize] = SLAVE);
    system.prescribed().iter().for_each(|&(j, _)| side[j] = PRESCRIBED);
    let (places, [slaves, masters, prescribed]) = sides(&side, relation.rows(), system.prescribed().len());
    // For each local DOF, its place among the slaves, masters or prescribed DOFs.
    let place = gather(&places, dofs);
    drop(places);
    let order = SlaveOrder::new(&relation.slave, &place);
    let mut t = sized(&order, masters.len(), |i| relation.length(i) - relation.prescribed_in(i));
    let mut g_matrix = match prescribed.len() {
        0 => Csr { start: vec![0; slaves.len() + 1], ..Csr::default() },
        cols => sized(&order, cols, |i| relation.prescribed_in(i)),
    };
    let mut g = vec![0.0; slaves.len()];
    let constants = g.chunks_mut(order.together);
    let parts = row_ranges(&mut t, order.together).into_iter();
    let parts = parts.zip(row_ranges(&mut g_matrix, order.together)).zip(constants);
    each(parts.enumerate().collect(), |(k, ((mut t, mut g_matrix), g))| {
        order.visit(k, |batch| {
            t.prefetch(batch);
            batch
                .iter()
                .for_each(|&(i, row)| write_row(relation, &place, i as usize, row as usize, &mut t, &mut g_matrix, g));
        });
    });
    Reduction { slaves, masters, prescribed, t, g_matrix, g, ..Reduction::default() }
}

/// Writes row i of the relation as a row of T, G and g.
#[inline]
fn write_row(
    relation: &Relation,
    place: &[u32],
    i: usize,
    row: usize,
    t: &mut RowRange,
    g_matrix: &mut RowRange,
    g: &mut [f64],
) {
    let (dofs, is_free) = (&relation.system.numbering.dofs, relation.system.free());
    // Most constants are zero; not writing them leaves the zeroed memory of g untouched, which costs nothing.
    if relation.constant[i] != 0.0 {
        g[row] = relation.constant[i];
    }
    let terms = relation.row(i);
    let sorted = relation.is_users(i) || terms.dofs().is_sorted_by_key(|j| dofs[j as usize]);
    let fixed = relation.prescribed_in(i);
    let part = |free: bool| terms.entries().filter(move |&(j, _)| is_free[j as usize] == free);
    let in_place = |(j, v): (u32, f64)| (place[j as usize], v);
    if fixed == 0 {
        t.fill(row, terms.len(), sorted, terms.entries().map(in_place));
    } else {
        t.fill(row, terms.len() - fixed, sorted, part(true).map(in_place));
        g_matrix.fill(row, fixed, sorted, part(false).map(in_place));
    }
}

const SLAVE: u8 = 0;
const MASTER: u8 = 1;
const PRESCRIBED: u8 = 2;

/// The place of each DOF within its side, and the DOFs of each side, ascending. The side of a DOF is [`SLAVE`], [`MASTER`] or
/// [`PRESCRIBED`]; `slaves` and `prescribed` are the numbers of such DOFs.
fn sides(side: &[u8], slaves: usize, prescribed: usize) -> (Vec<u32>, [Vec<usize>; 3]) {
    let counts = [slaves, side.len() - slaves - prescribed, prescribed];
    // Each DOF is written to the next place of all three sides, but only its own side moves on: a branch would be unpredictable.
    let mut sides = counts.map(|count| vec![0; count + 1]);
    let mut next = [0; 3];
    let mut places = Vec::with_capacity(side.len());
    for (j, &side) in side.iter().enumerate() {
        (0..3).for_each(|k| sides[k][next[k]] = j);
        places.push(next[side as usize] as u32);
        (0..3).for_each(|k| next[k] += usize::from(side == k as u8));
    }
    sides.iter_mut().zip(counts).for_each(|(side, count)| side.truncate(count));
    (places, sides)
}

/// A matrix of zeros whose rows have the lengths of the relation's rows.
fn sized(order: &SlaveOrder, cols: usize, length: impl Fn(usize) -> usize + Sync) -> Csr {
    let rows = order.rows();
    let mut start = vec![0; rows + 1];
    each(start[1..].chunks_mut(order.together).enumerate().collect(), |(k, lengths)| {
        order.visit(k, |batch| {
            batch.iter().for_each(|&(i, row)| lengths[row as usize] = length(i as usize));
        });
    });
    (0..rows).for_each(|i| start[i + 1] += start[i]);
    let nnz = start[rows];
    Csr { cols, start, col: vec![0; nnz], val: vec![0.0; nnz] }
}

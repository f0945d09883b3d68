//! `[T G g]` in the user's numbers: rows by ascending slave, columns by ascending master and prescribed DOF.
//!
//! Rows are taken in the order in which they were made, and each is written to its place: the user's numbers may be in any order,
//! and independent writes cost far less than reads that wait for one another. O(nnz + n).

use super::Reduction;
use super::rows::Relation;
use crate::{ConstraintSystem, Csr};

pub(super) fn write(system: &ConstraintSystem, relation: &Relation) -> Reduction {
    let dofs = &relation.system.numbering.dofs;
    let mut places = vec![MASTER; system.dofs()];
    relation.slave.iter().for_each(|&s| places[dofs[s as usize] as usize] = SLAVE);
    system.prescribed().iter().for_each(|&(j, _)| places[j] = PRESCRIBED);
    let [slaves, masters, prescribed] = sides(&mut places);
    // Place within its side of every DOF that occurs.
    let place: Vec<u32> = dofs.iter().map(|&j| places[j as usize]).collect();
    drop(places);
    let (mut t, mut g_matrix) = sized(relation, &place, [slaves.len(), masters.len(), prescribed.len()]);
    let mut g = vec![0.0; slaves.len()];
    let is_free = relation.system.free();
    for (i, &slave) in relation.slave.iter().enumerate() {
        let row = place[slave as usize] as usize;
        // Memory that need not be touched costs nothing; most constants are zero.
        if relation.constant[i] != 0.0 {
            g[row] = relation.constant[i];
        }
        let terms = relation.row(i).0;
        let sorted = relation.is_users(i) || terms.is_sorted_by_key(|&j| dofs[j as usize]);
        let fixed = relation.prescribed_terms(i);
        let part = |free: bool| relation.entries(i).filter(move |&(j, _)| is_free[j as usize] == free);
        let in_place = |(j, v)| (place[j as usize], v);
        if fixed == 0 {
            fill(&mut t, row, terms.len(), sorted, relation.entries(i).map(in_place));
        } else {
            fill(&mut t, row, terms.len() - fixed, sorted, part(true).map(in_place));
            fill(&mut g_matrix, row, fixed, sorted, part(false).map(in_place));
        }
    }
    Reduction { slaves, masters, prescribed, t, g_matrix, g, ..Reduction::default() }
}

const SLAVE: u32 = 0;
const MASTER: u32 = 1;
const PRESCRIBED: u32 = 2;

/// The DOFs of each side, ascending; turns sides into places within them.
fn sides(places: &mut [u32]) -> [Vec<usize>; 3] {
    let mut count = [0; 3];
    places.iter().for_each(|&side| count[side as usize] += 1);
    let mut sides = count.map(Vec::with_capacity);
    for (j, place) in places.iter_mut().enumerate() {
        let side: &mut Vec<usize> = &mut sides[*place as usize];
        *place = side.len() as u32;
        side.push(j);
    }
    sides
}

/// T and G with their rows of the right length and nothing in them.
fn sized(relation: &Relation, place: &[u32], [slaves, masters, prescribed]: [usize; 3]) -> (Csr, Csr) {
    let (mut t, mut g) = (vec![0; slaves + 1], vec![0; slaves + 1]);
    for (i, &slave) in relation.slave.iter().enumerate() {
        let fixed = relation.prescribed_terms(i);
        let row = place[slave as usize] as usize;
        (t[row + 1], g[row + 1]) = (relation.row(i).0.len() - fixed, fixed);
    }
    let make = |cols: usize, mut start: Vec<usize>| {
        (0..slaves).for_each(|i| start[i + 1] += start[i]);
        let nnz = start[slaves];
        Csr { cols, start, col: vec![0; nnz], val: vec![0.0; nnz] }
    };
    (make(masters, t), make(prescribed, g))
}

/// Writes a row of this length, ascending.
///
/// The length comes from the caller: where rows are written in any order, a loop that had to wait for `matrix.start` to learn
/// where it ends would hold up all that follows.
#[inline]
fn fill(matrix: &mut Csr, row: usize, length: usize, sorted: bool, entries: impl Iterator<Item = (u32, f64)>) {
    let start = matrix.start[row];
    let range = start..start + length;
    let places = matrix.col[range.clone()].iter_mut().zip(&mut matrix.val[range]);
    if sorted {
        places.zip(entries).for_each(|((column, value), entry)| (*column, *value) = entry);
    } else {
        let mut entries: Vec<_> = entries.collect();
        entries.sort_unstable_by_key(|&(j, _)| j);
        places.zip(entries).for_each(|((column, value), entry)| (*column, *value) = entry);
    }
}

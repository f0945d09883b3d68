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
        g[row] = relation.constant[i];
        let sorted = relation.is_users(i) || relation.row(i).0.is_sorted_by_key(|&j| dofs[j as usize]);
        if g_matrix.nnz() == 0 || g_matrix.start[row] == g_matrix.start[row + 1] {
            fill(&mut t, row, sorted, relation.entries(i).map(|(j, v)| (place[j as usize], v)));
        } else {
            let part = |free: bool| {
                let side = relation.entries(i).filter(move |&(j, _)| is_free[j as usize] == free);
                side.map(|(j, v)| (place[j as usize], v))
            };
            fill(&mut t, row, sorted, part(true));
            fill(&mut g_matrix, row, sorted, part(false));
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
    let is_free = relation.system.free();
    for (i, &slave) in relation.slave.iter().enumerate() {
        let entries = relation.row(i).0;
        let fixed = if prescribed == 0 { 0 } else { entries.iter().filter(|&&j| !is_free[j as usize]).count() };
        let row = place[slave as usize] as usize;
        (t[row + 1], g[row + 1]) = (entries.len() - fixed, fixed);
    }
    let make = |cols: usize, mut start: Vec<usize>| {
        (0..slaves).for_each(|i| start[i + 1] += start[i]);
        let nnz = start[slaves];
        Csr { cols, start, col: vec![0; nnz], val: vec![0.0; nnz] }
    };
    (make(masters, t), make(prescribed, g))
}

/// Writes a row of the right length, ascending.
#[inline]
fn fill(matrix: &mut Csr, row: usize, sorted: bool, entries: impl Iterator<Item = (u32, f64)>) {
    let range = matrix.start[row]..matrix.start[row + 1];
    let places = matrix.col[range.clone()].iter_mut().zip(&mut matrix.val[range]);
    if sorted {
        places.zip(entries).for_each(|((column, value), entry)| (*column, *value) = entry);
    } else {
        let mut entries: Vec<_> = entries.collect();
        entries.sort_unstable_by_key(|&(j, _)| j);
        places.zip(entries).for_each(|((column, value), entry)| (*column, *value) = entry);
    }
}

//! Connected parts of the equations: two rows belong to the same part if a chain of DOFs that are not prescribed connects them.
//!
//! Results of a part depend on that part alone. A prescribed DOF may occur in many parts: its column of G is then split into one column per
//! part, so that means and maxima over columns do not mix parts.

use qless::Csr;
use qless::common::DisjointSets;

/// Marks a DOF without a part.
const NONE: u32 = u32::MAX;

/// Parts of rows and DOFs, in the order of their first rows.
pub struct EquationParts {
    of_row: Vec<u32>,
    of_dof: Vec<u32>,
    /// Number of parts.
    pub count: usize,
    /// Columns of G, split by parts.
    pub columns: PartColumns,
}

impl EquationParts {
    /// `together` lists DOFs that belong together, such as those of a rotation.
    pub fn new(g: &Csr, prescribed: &[(usize, f64)], together: &[[usize; 3]]) -> Self {
        let mut is_prescribed = vec![false; g.cols()];
        prescribed.iter().for_each(|&(j, _)| is_prescribed[j] = true);
        let mut sets = DisjointSets::new(g.cols());
        let free = |r: usize| g.row(r).map(|(j, _)| j).filter(|&j| !is_prescribed[j]);
        (0..g.rows()).for_each(|r| join_all(&mut sets, free(r)));
        together.iter().for_each(|&dofs| join_all(&mut sets, dofs));
        let roots: Vec<usize> = (0..g.cols()).map(|j| sets.root(j)).collect();
        let (mut of_root, mut count) = (vec![NONE; g.cols()], 0);
        let number = |r: usize| {
            let root = free(r).next().map(|j| roots[j]);
            let known = root.map_or(NONE, |root| of_root[root]);
            if known != NONE {
                return known;
            }
            root.into_iter().for_each(|root| of_root[root] = count);
            count += 1;
            count - 1
        };
        let of_row: Vec<u32> = (0..g.rows()).map(number).collect();
        let of_dof = (0..g.cols()).map(|j| if is_prescribed[j] { NONE } else { of_root[roots[j]] }).collect();
        let columns = PartColumns::of_parts(g, &is_prescribed, &of_row);
        Self { of_row, of_dof, count: count as usize, columns }
    }

    pub fn of_row(&self, r: usize) -> usize {
        self.of_row[r] as usize
    }

    /// None for DOFs that are prescribed or in no equation.
    pub fn of_dof(&self, j: usize) -> Option<usize> {
        let part = self.of_dof[j];
        (part != NONE).then_some(part as usize)
    }

    /// Folds the rows of each part into one value.
    pub fn fold<T: Clone>(&self, start: T, mut with: impl FnMut(&mut T, usize)) -> Vec<T> {
        let mut all = vec![start; self.count];
        (0..self.of_row.len()).for_each(|r| with(&mut all[self.of_row(r)], r));
        all
    }
}

/// The column that each entry of the Jacobian counts in: its own or, for a prescribed DOF, one for each part.
pub struct PartColumns {
    column_of_entry: Vec<u32>,
    /// Number of columns.
    pub count: usize,
}

impl PartColumns {
    /// The columns of G itself.
    pub fn plain(g: &Csr) -> Self {
        Self { column_of_entry: g.columns().to_vec(), count: g.cols() }
    }

    /// Splits the column of each prescribed DOF into one per part; these come after the others.
    fn of_parts(g: &Csr, is_prescribed: &[bool], of_row: &[u32]) -> Self {
        let entries = |r: usize| g.row(r).map(move |(j, _)| (j as u32, of_row[r]));
        let mut split: Vec<_> = (0..g.rows()).flat_map(entries).filter(|&(j, _)| is_prescribed[j as usize]).collect();
        split.sort_unstable();
        split.dedup();
        let split_column = |pair: (u32, u32)| (g.cols() + split.partition_point(|other| *other < pair)) as u32;
        let column = |pair: (u32, u32)| if is_prescribed[pair.0 as usize] { split_column(pair) } else { pair.0 };
        let column_of_entry = (0..g.rows()).flat_map(entries).map(column).collect();
        Self { column_of_entry, count: g.cols() + split.len() }
    }

    /// `(column, value)` of the entries of a row.
    pub fn row(&self, g: &Csr, r: usize) -> impl Iterator<Item = (usize, f64)> {
        let entries = g.starts()[r]..g.starts()[r + 1];
        self.column_of_entry[entries.clone()].iter().zip(&g.values()[entries]).map(|(&j, &v)| (j as usize, v))
    }
}

/// Joins the sets of all members.
pub(crate) fn join_all(sets: &mut DisjointSets, members: impl IntoIterator<Item = usize>) {
    let mut members = members.into_iter();
    let Some(first) = members.next() else { return };
    members.for_each(|member| sets.join(first, member));
}

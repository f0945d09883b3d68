//! Rows of `u_s = T u_q + G u_p + g`, over the DOFs of the job.

use crate::components::NONE;

/// Marks a prescribed DOF in the terms of a row.
pub(crate) const PRESCRIBED_BIT: u64 = 1 << 63;

/// One row of `u_s = T u_q + G u_p + g`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ReductionRow<'a> {
    pub slave: u64,
    pub constant: f64,
    /// Masters, and prescribed DOFs with [`PRESCRIBED_BIT`]; ascending by DOF.
    pub dofs: &'a [u64],
    pub values: &'a [f64],
}

/// Rows of T, G and g; ascending by slave after [`ReductionRows::sort`].
#[derive(Clone, Debug, Default)]
pub(crate) struct ReductionRows {
    heads: Vec<RowHead>,
    dofs: Vec<u64>,
    values: Vec<f64>,
}

/// The slave and the constant of a row, and the range of its terms.
#[derive(Clone, Copy, Debug)]
struct RowHead {
    slave: u64,
    constant: f64,
    start: usize,
    len: u32,
}

impl ReductionRows {
    /// Reserves memory for more rows, with this many terms in total.
    pub fn reserve(&mut self, rows: usize, terms: usize) {
        self.heads.reserve(rows);
        self.dofs.reserve(terms);
        self.values.reserve(terms);
    }

    pub fn len(&self) -> usize {
        self.heads.len()
    }

    pub fn slaves(&self) -> impl ExactSizeIterator<Item = u64> + '_ {
        self.heads.iter().map(|head| head.slave)
    }

    pub fn row(&self, i: usize) -> ReductionRow<'_> {
        let RowHead { slave, constant, start, len } = self.heads[i];
        let range = start..start + len as usize;
        ReductionRow { slave, constant, dofs: &self.dofs[range.clone()], values: &self.values[range] }
    }

    pub fn iter(&self) -> impl Iterator<Item = ReductionRow<'_>> {
        (0..self.len()).map(|i| self.row(i))
    }

    /// The row of a DOF; `None` if these rows do not have it as a slave.
    pub fn find(&self, dof: u64) -> Option<ReductionRow<'_>> {
        self.heads.binary_search_by_key(&dof, |head| head.slave).ok().map(|i| self.row(i))
    }

    /// The rows whose slaves are among `dofs`; rows and `dofs` ascend.
    pub fn among<'a>(&'a self, dofs: &'a [u64]) -> impl Iterator<Item = ReductionRow<'a>> {
        let inside = move |(i, head): (usize, &RowHead)| dofs.binary_search(&head.slave).ok().map(|_| self.row(i));
        self.heads.iter().enumerate().filter_map(inside)
    }

    pub fn push(&mut self, slave: u64, constant: f64, terms: impl Iterator<Item = (u64, f64)>) {
        let start = self.dofs.len();
        for (dof, value) in terms {
            self.dofs.push(dof);
            self.values.push(value);
        }
        self.heads.push(RowHead { slave, constant, start, len: (self.dofs.len() - start) as u32 });
    }

    pub fn clear(&mut self) {
        self.heads.clear();
        self.dofs.clear();
        self.values.clear();
    }

    /// Sorts the rows by slave and removes repeated slaves.
    pub fn sort(mut self) -> Self {
        self.heads.sort_unstable_by_key(|head| head.slave);
        self.heads.dedup_by_key(|head| head.slave);
        self
    }

    pub fn push_row(&mut self, row: ReductionRow) {
        self.push(row.slave, row.constant, row.dofs.iter().copied().zip(row.values.iter().copied()));
    }

    /// Appends the rows of a message.
    pub fn read(&mut self, words: &[u64]) {
        let mut at = 0;
        while at < words.len() {
            let (head, len) = (&words[at..at + 3], words[at + 2] as usize);
            let terms = words[at + 3..at + 3 + 2 * len].chunks_exact(2);
            self.push(head[0], f64::from_bits(head[1]), terms.map(|pair| (pair[0], f64::from_bits(pair[1]))));
            at += 3 + 2 * len;
        }
    }
}

impl ReductionRow<'_> {
    /// Appends the row to a message.
    pub fn write(&self, words: &mut Vec<u64>) {
        words.extend([self.slave, self.constant.to_bits(), self.dofs.len() as u64]);
        words.extend(self.dofs.iter().zip(self.values).flat_map(|(&dof, value)| [dof, value.to_bits()]));
    }
}

/// The rows of T for the slaves among the DOFs of a rank's equations.
pub(crate) struct SlaveRows {
    pub reduction: ReductionRows,
    /// For each DOF of the equations, the index of its row in `reduction`.
    pub of_place: Vec<u32>,
    /// Whether a DOF is prescribed, for each DOF of the equations.
    pub is_prescribed: Vec<bool>,
}

impl SlaveRows {
    pub fn find(&self, place: u32) -> Option<ReductionRow<'_>> {
        let i = self.of_place[place as usize];
        (i != NONE).then(|| self.reduction.row(i as usize))
    }
}

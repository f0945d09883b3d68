//! Rows of `u_s = T u_q + G u_p + g`, over the DOFs of the job.

/// Marks the prescribed among the DOFs of a line.
pub(crate) const GIVEN: u64 = 1 << 63;

/// One row.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Line<'a> {
    pub slave: u64,
    pub constant: f64,
    /// Masters, and prescribed DOFs with [`GIVEN`]; ascending by DOF.
    pub dofs: &'a [u64],
    pub values: &'a [f64],
}

/// Rows, ascending by slave once [`Lines::sort`]ed.
#[derive(Clone, Debug)]
pub(crate) struct Lines {
    pub slaves: Vec<u64>,
    constants: Vec<f64>,
    starts: Vec<usize>,
    dofs: Vec<u64>,
    values: Vec<f64>,
}

impl Lines {
    pub fn new() -> Self {
        Self { slaves: Vec::new(), constants: Vec::new(), starts: vec![0], dofs: Vec::new(), values: Vec::new() }
    }

    /// Room for more rows with so many terms.
    pub fn reserve(&mut self, rows: usize, terms: usize) {
        self.slaves.reserve(rows);
        self.constants.reserve(rows);
        self.starts.reserve(rows);
        self.dofs.reserve(terms);
        self.values.reserve(terms);
    }

    pub fn len(&self) -> usize {
        self.slaves.len()
    }

    pub fn line(&self, i: usize) -> Line<'_> {
        let range = self.starts[i]..self.starts[i + 1];
        Line {
            slave: self.slaves[i],
            constant: self.constants[i],
            dofs: &self.dofs[range.clone()],
            values: &self.values[range],
        }
    }

    pub fn iter(&self) -> impl Iterator<Item = Line<'_>> {
        (0..self.len()).map(|i| self.line(i))
    }

    /// The row of a DOF, if it is a slave of these.
    pub fn find(&self, dof: u64) -> Option<Line<'_>> {
        self.slaves.binary_search(&dof).ok().map(|i| self.line(i))
    }

    /// The rows of those of `dofs` that are slaves of these; both ascend.
    pub fn among<'a>(&'a self, dofs: &'a [u64]) -> impl Iterator<Item = Line<'a>> {
        let inside = move |(i, slave): (usize, &u64)| dofs.binary_search(slave).ok().map(|_| self.line(i));
        self.slaves.iter().enumerate().filter_map(inside)
    }

    pub fn push(&mut self, slave: u64, constant: f64, terms: impl Iterator<Item = (u64, f64)>) {
        for (dof, value) in terms {
            self.dofs.push(dof);
            self.values.push(value);
        }
        self.starts.push(self.dofs.len());
        self.slaves.push(slave);
        self.constants.push(constant);
    }

    pub fn clear(&mut self) {
        self.slaves.clear();
        self.constants.clear();
        self.starts.truncate(1);
        self.dofs.clear();
        self.values.clear();
    }

    /// Ascending by slave, each once.
    pub fn sort(self) -> Self {
        if self.slaves.is_sorted_by(|a, b| a < b) {
            return self;
        }
        let mut order: Vec<usize> = (0..self.len()).collect();
        order.sort_unstable_by_key(|&i| self.slaves[i]);
        order.dedup_by_key(|i| self.slaves[*i]);
        let mut sorted = Self::new();
        order.into_iter().for_each(|i| sorted.push_line(self.line(i)));
        sorted
    }

    pub fn push_line(&mut self, line: Line) {
        self.push(line.slave, line.constant, line.dofs.iter().copied().zip(line.values.iter().copied()));
    }

    /// The rows that a message holds.
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

impl Line<'_> {
    /// Appends the row to a message.
    pub fn write(&self, words: &mut Vec<u64>) {
        words.extend([self.slave, self.constant.to_bits(), self.dofs.len() as u64]);
        words.extend(self.dofs.iter().zip(self.values).flat_map(|(&dof, value)| [dof, value.to_bits()]));
    }
}

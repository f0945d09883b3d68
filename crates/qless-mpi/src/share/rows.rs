//! Equations in one form: terms ascending by DOF, each DOF once, no zeros.

/// Rows over global DOFs.
#[derive(Clone, Debug)]
pub(crate) struct Rows {
    pub numbers: Vec<u64>,
    pub starts: Vec<usize>,
    pub dofs: Vec<u64>,
    pub values: Vec<f64>,
    pub rhs: Vec<f64>,
}

impl Rows {
    pub fn new() -> Self {
        Self { numbers: Vec::new(), starts: vec![0], dofs: Vec::new(), values: Vec::new(), rhs: Vec::new() }
    }

    pub fn len(&self) -> usize {
        self.numbers.len()
    }

    pub fn row(&self, i: usize) -> impl ExactSizeIterator<Item = (u64, f64)> + Clone + '_ {
        let range = self.starts[i]..self.starts[i + 1];
        self.dofs[range.clone()].iter().copied().zip(self.values[range].iter().copied())
    }

    pub fn values(&self, i: usize) -> &[f64] {
        &self.values[self.starts[i]..self.starts[i + 1]]
    }

    pub fn push(&mut self, number: u64, rhs: f64, terms: impl Iterator<Item = (u64, f64)>) {
        terms.for_each(|(dof, value)| {
            self.dofs.push(dof);
            self.values.push(value);
        });
        self.starts.push(self.dofs.len());
        self.numbers.push(number);
        self.rhs.push(rhs);
    }
}

/// Sorts the terms of a row, sums repeats, drops what is zero or cancels to rounding, as [`qless::SystemBuilder`] does.
pub(crate) fn sum_repeats(terms: &mut Vec<(u64, f64)>) {
    let ascends = terms.windows(2).all(|pair| pair[0].0 < pair[1].0);
    if ascends && terms.iter().all(|&(_, value)| value != 0.0) {
        return;
    }
    terms.sort_by_key(|&(dof, _)| dof);
    let summed = |repeats: &[(u64, f64)]| {
        let sum: f64 = repeats.iter().map(|&(_, value)| value).sum();
        let parts = repeats.iter().map(|&(_, value)| value.abs()).fold(0.0, f64::max);
        let cancelled = repeats.len() > 1 && sum.abs() <= 4.0 * f64::EPSILON * parts;
        (sum != 0.0 && !cancelled).then_some((repeats[0].0, sum))
    };
    *terms = terms.chunk_by(|a, b| a.0 == b.0).filter_map(summed).collect();
}

//! Equations in one form: terms ascending by DOF, each DOF once, no zeros.

use super::{Share, ShareError, SharePlace};

/// Rows over global DOFs.
#[derive(Clone, Debug, Default)]
pub(crate) struct Rows {
    pub numbers: Vec<u64>,
    pub starts: Vec<usize>,
    pub dofs: Vec<u64>,
    pub values: Vec<f64>,
    pub rhs: Vec<f64>,
}

impl Rows {
    pub fn new() -> Self {
        Self { starts: vec![0], ..Self::default() }
    }

    pub fn len(&self) -> usize {
        self.numbers.len()
    }

    pub fn row(&self, i: usize) -> impl Iterator<Item = (u64, f64)> + Clone + '_ {
        let range = self.starts[i]..self.starts[i + 1];
        self.dofs[range.clone()].iter().copied().zip(self.values[range].iter().copied())
    }

    /// Size of the largest coefficient of a row.
    pub fn largest(&self, i: usize) -> f64 {
        self.row(i).fold(0.0, |most, (_, value)| most.max(value.abs()))
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

    /// The equations of a share, as [`qless::SystemBuilder`] would keep them.
    pub fn of(share: &Share, rank: usize, dofs: u64) -> Result<Self, ShareError> {
        let mut rows = Self::new();
        let mut terms = Vec::new();
        for (i, &number) in share.numbers.iter().enumerate() {
            if number >= 1 << 62 {
                return Err(ShareError::NumberTooLarge { rank, number });
            }
            terms.clear();
            terms.extend_from_slice(&share.terms[share.starts[i]..share.starts[i + 1]]);
            let place = |dof| SharePlace::Coefficient { equation: number, dof };
            for &(dof, value) in &terms {
                within(dof, dofs, rank, place(dof))?;
                finite(value, rank, place(dof))?;
            }
            finite(share.rhs[i], rank, SharePlace::RightHandSide { equation: number })?;
            qless_terms(&mut terms);
            for &(dof, value) in &terms {
                finite(value, rank, place(dof))?;
            }
            rows.push(number, share.rhs[i], terms.iter().copied());
        }
        Ok(rows)
    }
}

/// Sorts the terms of a row, sums repeats, drops what is zero or cancels to rounding.
fn qless_terms(terms: &mut Vec<(u64, f64)>) {
    terms.sort_by_key(|&(dof, _)| dof);
    let summed = |repeats: &[(u64, f64)]| {
        let sum: f64 = repeats.iter().map(|&(_, value)| value).sum();
        let parts = repeats.iter().map(|&(_, value)| value.abs()).fold(0.0, f64::max);
        let cancelled = repeats.len() > 1 && sum.abs() <= 4.0 * f64::EPSILON * parts;
        (sum != 0.0 && !cancelled).then_some((repeats[0].0, sum))
    };
    if terms.windows(2).any(|pair| pair[0].0 == pair[1].0) || terms.iter().any(|&(_, value)| value == 0.0) {
        *terms = terms.chunk_by(|a, b| a.0 == b.0).filter_map(summed).collect();
    }
}

pub(crate) fn within(dof: u64, dofs: u64, rank: usize, what: SharePlace) -> Result<(), ShareError> {
    if dof < dofs { Ok(()) } else { Err(ShareError::DofOutOfRange { rank, what, dofs }) }
}

pub(crate) fn finite(value: f64, rank: usize, what: SharePlace) -> Result<(), ShareError> {
    if value.is_finite() { Ok(()) } else { Err(ShareError::NotFinite { rank, what, value }) }
}

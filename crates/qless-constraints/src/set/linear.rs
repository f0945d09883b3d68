//! All linear equations, `c = G u - b`; G is written once.

use qless::Csr;
use rayon::prelude::*;

use super::labels::Owner;

/// Rows per task.
const CHUNK: usize = 4096;

/// Linear equations, whatever types they come from.
#[derive(Default)]
pub(super) struct Rows {
    /// Where each row ends among the terms.
    end: Vec<usize>,
    /// Moved into the pattern when the set is built.
    terms: Vec<(u32, f64)>,
    rhs: Vec<f64>,
    owners: Vec<Owner>,
}

impl Rows {
    pub fn push(&mut self, owner: Owner, terms: &[(u32, f64)], rhs: f64) {
        self.terms.extend_from_slice(terms);
        self.end.push(self.terms.len());
        self.rhs.push(rhs);
        self.owners.push(owner);
    }

    pub fn rows(&self) -> usize {
        self.rhs.len()
    }

    pub fn nnz(&self) -> usize {
        self.end.last().copied().unwrap_or(0)
    }

    pub fn owner(&self, row: usize) -> &Owner {
        &self.owners[row]
    }

    /// Moves the terms to the end of `g`, which has no rows yet.
    pub fn write_pattern(&mut self, g: &mut Csr) {
        let mut first = 0;
        for &end in &self.end {
            g.push_row(self.terms[first..end].iter().map(|&(j, v)| (j as usize, v)));
            first = end;
        }
        self.terms = Vec::new();
    }

    /// `c = G u - b` with the columns and values of these rows.
    pub fn evaluate(&self, col: &[u32], val: &[f64], u: &[f64], c: &mut [f64]) {
        c.par_chunks_mut(CHUNK).enumerate().for_each(|(chunk, c)| {
            let first = chunk * CHUNK;
            let mut from = if first == 0 { 0 } else { self.end[first - 1] };
            for ((c, &end), &rhs) in c.iter_mut().zip(&self.end[first..]).zip(&self.rhs[first..]) {
                let terms = col[from..end].iter().zip(&val[from..end]);
                *c = terms.map(|(&j, &v)| v * u[j as usize]).sum::<f64>() - rhs;
                from = end;
            }
        });
    }
}

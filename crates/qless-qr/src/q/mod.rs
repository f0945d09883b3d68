//! `Q = H_1 H_2 ... H_F`: the reflections of every front, kept in Householder form; Q itself is never formed.
//!
//! A row of A has one name, its number, from the front that assembles it to the front that finishes it. Front f turns
//! the rows `rows`: reflection t is `I - tau v v^T` on the rows from `first[t]` on. After all fronts, row k of
//! `Q^T A P` is the row of A that `row[k]` names: the r rows of R first, then what no column is left for.
//!
//! Cost: sum of the lengths of all v in memory ([`Symbolic::memory_of_q`](crate::Symbolic::memory_of_q)), four
//! operations for each of those numbers and each vector (Davis 2011, Sec. 3.4).

mod apply;

/// The reflections of one front.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Reflections {
    /// Row of A at each row of the front.
    pub rows: Vec<u32>,
    /// First row of each reflection.
    pub first: Vec<u32>,
    /// Where the vector of each reflection ends in `v`.
    pub end: Vec<usize>,
    pub tau: Vec<f64>,
    /// Their vectors, each with its leading 1.
    pub v: Vec<f64>,
}

impl Reflections {
    pub fn clear(&mut self) {
        self.first.clear();
        self.end.clear();
        self.tau.clear();
        self.v.clear();
    }

    pub fn push(&mut self, first: usize, tau: f64, v: &[f64]) {
        self.first.push(first as u32);
        self.tau.push(tau);
        self.v.extend_from_slice(v);
        self.end.push(self.v.len());
    }

    /// First row, factor and vector of reflection t.
    fn get(&self, t: usize) -> (usize, f64, &[f64]) {
        let from = if t == 0 { 0 } else { self.end[t - 1] };
        (self.first[t] as usize, self.tau[t], &self.v[from..self.end[t]])
    }
}

/// All of Q.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Q {
    /// Row of A that holds each row of `Q^T A P`; a permutation.
    pub row: Vec<u32>,
    /// Fronts with reflections, children before parents.
    pub fronts: Vec<Reflections>,
}

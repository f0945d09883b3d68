//! Rows of a matrix that need not be symmetric as the columns that solvers take.

use qless::elimination::{CondensedPattern, Storage};

use super::super::solver::Columns;

/// Columns made of rows.
#[derive(Debug)]
pub struct Turned {
    starts: Vec<u32>,
    rows: Vec<u32>,
    /// For each entry its place by rows.
    places: Vec<u32>,
    values: Vec<f64>,
}

impl Turned {
    pub fn new(condensed: &CondensedPattern) -> Self {
        let (n, by_row) = (condensed.unknowns(), condensed.starts());
        let mut starts = vec![0_u32; n + 1];
        condensed.index().iter().for_each(|&j| starts[j as usize + 1] += 1);
        (0..n).for_each(|j| starts[j + 1] += starts[j]);
        let mut next = starts.clone();
        let (mut rows, mut places) = (vec![0; condensed.nnz()], vec![0; condensed.nnz()]);
        for i in 0..n {
            for place in by_row[i]..by_row[i + 1] {
                let slot = &mut next[condensed.index()[place as usize] as usize];
                rows[*slot as usize] = i as u32;
                places[*slot as usize] = place;
                *slot += 1;
            }
        }
        Self { starts, rows, places, values: vec![0.0; condensed.nnz()] }
    }

    pub fn columns(&mut self, k_q: &[f64]) -> Columns<'_> {
        self.values.iter_mut().zip(&self.places).for_each(|(value, &place)| *value = k_q[place as usize]);
        Columns { starts: &self.starts, rows: &self.rows, values: &self.values, storage: Storage::Full }
    }
}

//! The DOFs of a rank's equations, numbered from 0.

use rustc_hash::FxHashMap;

use crate::share::Rows;

/// The DOFs, ascending, and the place among them of each term.
pub(crate) struct Touched {
    pub dofs: Vec<u64>,
    pub places: Vec<u32>,
    /// Whether a coefficient of the DOF may be rounding of its equation, by place.
    pub faint: Vec<bool>,
}

/// Coefficients further below the largest of their row may be.
const FAINT: f64 = 1e-12;

impl Touched {
    pub fn by(rows: &Rows) -> Self {
        let mut place_of: FxHashMap<u64, u32> = FxHashMap::default();
        rows.dofs.iter().for_each(|&dof| _ = place_of.insert(dof, 0));
        let mut dofs: Vec<u64> = place_of.keys().copied().collect();
        dofs.sort_unstable();
        dofs.iter().zip(0..).for_each(|(&dof, place)| _ = place_of.insert(dof, place));
        let places = rows.dofs.iter().map(|dof| place_of[dof]).collect();
        let mut touched = Self { faint: vec![false; dofs.len()], dofs, places };
        for i in 0..rows.len() {
            let limit = FAINT * rows.largest(i);
            let range = rows.starts[i]..rows.starts[i + 1];
            let faint = range.filter(|&k| rows.values[k].abs() < limit);
            faint.for_each(|k| touched.faint[touched.places[k] as usize] = true);
        }
        touched
    }

    /// Places of the terms of row i.
    pub fn row<'a>(&'a self, rows: &Rows, i: usize) -> &'a [u32] {
        &self.places[rows.starts[i]..rows.starts[i + 1]]
    }
}

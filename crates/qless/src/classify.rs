//! Redundant or conflicting: `b_k - sum c_i b_i`, prescribed DOFs moved into b (Eq. 27, 28).

use crate::block::Solved;
use crate::presolve::eliminate::{Eliminated, Mismatch};
use crate::presolve::rows::MORE_THAN_ROUNDING;
use crate::scale::{Scaling, ldexp};

/// Error of a certificate that comes from a factorization, in units in the last place for each of its terms, times the
/// condition of the kept rows.
const CERTIFICATE_UNITS: f64 = 2.0;

/// What an equation is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// No combination of the others that were kept.
    Independent,
    /// A combination of kept equations, and consistent with them.
    Redundant,
    /// A combination of kept equations whose right-hand side contradicts them.
    Conflicting,
}

/// A redundant or conflicting equation.
#[derive(Clone, Debug)]
pub struct Dependent {
    /// The equation, 0-based.
    pub row: usize,
    /// Redundant or conflicting.
    pub kind: Kind,
    /// `b_k - sum c_i b_i` in the units of the equation, prescribed DOFs moved into b.
    pub mismatch: f64,
    /// The mismatch relative to the largest part that went into it; 0 if it is no more than rounding.
    pub relative_mismatch: f64,
    /// What was dropped to call the equation dependent, relative to its size; 0 if it is no more than rounding.
    pub dropped: f64,
    /// Index of the row among those that went through elimination, and its certificate over rows of its block.
    pub(crate) source: (u32, Vec<(u32, f64)>),
}

/// Redundant or conflicting, for every dependent row.
pub(crate) fn classify(
    names: &[u32],
    eliminated: &Eliminated,
    solved: &[Solved],
    scaling: &Scaling,
    tolerance: f64,
) -> Vec<Dependent> {
    let make = |source: u32, because: Vec<(u32, f64)>, mismatch: Mismatch, dropped: f64| {
        let row = names[source as usize] as usize;
        let Mismatch { value, size, error } = mismatch;
        let conflicting = value.abs() > (tolerance * size).max(MORE_THAN_ROUNDING * error);
        Dependent {
            row,
            kind: if conflicting { Kind::Conflicting } else { Kind::Redundant },
            mismatch: ldexp(value, -scaling.row[row]),
            relative_mismatch: if value.abs() > MORE_THAN_ROUNDING * error { value.abs() / size } else { 0.0 },
            dropped,
            source: (source, because),
        }
    };
    let mut all: Vec<_> = eliminated.dead.iter().map(|d| make(d.row, Vec::new(), d.mismatch, d.dropped)).collect();
    for (block, dependent) in solved.iter().flat_map(|block| block.dependent.iter().map(move |d| (block, d))) {
        let mut mismatch = Mismatch::of(&eliminated.rows[dependent.row as usize]);
        dependent.because.iter().for_each(|&(i, y)| mismatch.subtract(y, &eliminated.rows[i as usize]));
        // The coefficients themselves come from a factorization.
        let units = CERTIFICATE_UNITS * dependent.because.len() as f64 / block.sigma.min(1.0);
        mismatch.error += units * f64::EPSILON * mismatch.size;
        all.push(make(dependent.row, dependent.because.clone(), mismatch, dependent.dropped));
    }
    all.sort_unstable_by_key(|d| d.row);
    all
}

//! `row_k = sum_i c_i row_i`: why an equation is dependent, in terms of the user's equations.
//!
//! Presolve subtracted multiples of its pivot rows (the steps) from other rows; steps are themselves rows from which earlier steps were
//! subtracted. A certificate is found by undoing these subtractions, from the last step to the first. If the kept rows are independent, the
//! certificate is unique, and its support is the smallest set of kept equations that explains the row.

use std::collections::BTreeMap;

use crate::input::scale::ldexp;

/// One term of a certificate: `coefficient` times the equation `row` (0-based).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct CertificateTerm {
    /// A kept equation.
    pub row: usize,
    /// The coefficient of the equation.
    pub coefficient: f64,
}

/// A sum that cancels to this fraction of its largest term is zero.
const NOISE: f64 = 1e-11;

/// The operations that changed rows before they reached the blocks.
pub(crate) struct History {
    /// For each row that went through elimination, the user's row.
    pub rows: Vec<u32>,
    /// For each row that went through elimination, the steps whose pivot rows were subtracted from it, with their factors.
    pub factors: Vec<Vec<(u32, f64)>>,
    /// For each step, the index of its pivot row.
    pub steps: Vec<u32>,
    /// Exponents of the row scaling, by row of the user.
    pub exponents: Vec<i32>,
}

/// A sum and its largest term.
#[derive(Clone, Copy, Default)]
struct CertificateSum {
    value: f64,
    size: f64,
}

impl CertificateSum {
    fn add(&mut self, part: f64) {
        self.value += part;
        self.size = self.size.max(part.abs());
    }

    fn is_zero(self) -> bool {
        self.value.abs() <= NOISE * self.size
    }
}

impl History {
    /// The certificate of row `k`. `because` expresses the row by other rows of its block, and is empty outside blocks.
    pub fn certificate(&self, k: u32, because: &[(u32, f64)]) -> Vec<CertificateTerm> {
        let mut rows: BTreeMap<u32, CertificateSum> = BTreeMap::new();
        let mut steps: BTreeMap<u32, CertificateSum> = BTreeMap::new();
        for &(i, y) in because {
            rows.entry(i).or_default().add(y);
            self.undo(i, -y, &mut steps);
        }
        self.undo(k, 1.0, &mut steps);
        self.expand(rows, steps, self.exponents[self.rows[k as usize] as usize])
    }

    /// Expresses a sum of pivot rows (`steps`) and of rows of a block, each with its factor, by the user's equations. `exponent` is the row
    /// scaling of the result.
    pub fn combination(&self, steps: &[(u32, f64)], block: &[(u32, f64)], exponent: i32) -> Vec<CertificateTerm> {
        let mut rows: BTreeMap<u32, CertificateSum> = BTreeMap::new();
        let mut sums: BTreeMap<u32, CertificateSum> = BTreeMap::new();
        steps.iter().for_each(|&(t, w)| sums.entry(t).or_default().add(w));
        for &(i, y) in block {
            rows.entry(i).or_default().add(y);
            self.undo(i, -y, &mut sums);
        }
        self.expand(rows, sums, exponent)
    }

    /// Undoes the elimination of row i: for each pivot row that was subtracted from it, adds `weight` times the factor to the sum of its
    /// step.
    fn undo(&self, i: u32, weight: f64, steps: &mut BTreeMap<u32, CertificateSum>) {
        for &(step, factor) in &self.factors[i as usize] {
            steps.entry(step).or_default().add(weight * factor);
        }
    }

    /// Replaces each pivot row by the row before elimination and earlier pivot rows, from the last step to the first. Returns the sum of
    /// all rows in the user's equations.
    fn expand(
        &self,
        mut rows: BTreeMap<u32, CertificateSum>,
        mut steps: BTreeMap<u32, CertificateSum>,
        exponent: i32,
    ) -> Vec<CertificateTerm> {
        while let Some((step, sum)) = steps.pop_last() {
            if !sum.is_zero() {
                let row = self.steps[step as usize];
                rows.entry(row).or_default().add(sum.value);
                self.undo(row, -sum.value, &mut steps);
            }
        }
        let unscaled = |(&i, sum): (&u32, &CertificateSum)| {
            let row = self.rows[i as usize] as usize;
            CertificateTerm { row, coefficient: ldexp(sum.value, self.exponents[row] - exponent) }
        };
        let mut terms: Vec<_> = rows.iter().filter(|(_, sum)| !sum.is_zero()).map(unscaled).collect();
        terms.sort_unstable_by_key(|term| term.row);
        terms
    }
}

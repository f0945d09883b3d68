//! Sparse rows under elimination: unsorted, with fast lookup even in long rows.

use rustc_hash::FxHashMap;

use crate::input::scale::ldexp;

/// Rows longer than this find their entries by a hash table.
const LONG: usize = 48;

/// A coefficient, the size of its largest term, and a bound of its rounding error.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Entry {
    pub dof: u32,
    /// Bound of the rounding error, relative to `size`. The ratio does not depend on units, so single precision has enough range.
    error: f32,
    /// The largest term of the sum that gave the value; each term is a multiple of a user's coefficient. [`Entry::left`] is relative to
    /// this size.
    size: f64,
    pub value: f64,
}

impl Entry {
    /// A coefficient of the user, exact to the last place.
    pub fn given(dof: u32, value: f64) -> Self {
        Self::new(dof, value, f64::EPSILON * value.abs(), value.abs())
    }

    /// A coefficient with a bound of its error and the size of its largest term; a size below the coefficient is raised to it.
    pub fn new(dof: u32, value: f64, error: f64, size: f64) -> Self {
        let size = size.max(value.abs());
        Self { dof, error: (error / size.max(f64::MIN_POSITIVE)) as f32, size, value }
    }

    /// The same coefficient, times `2^exponent`, under the number `dof`.
    pub fn renamed(self, dof: u32, exponent: i32) -> Self {
        Self { dof, size: ldexp(self.size, exponent), value: ldexp(self.value, exponent), ..self }
    }

    pub fn size(&self) -> f64 {
        self.size
    }

    pub fn error(&self) -> f64 {
        f64::from(self.error) * self.size
    }

    /// The fraction of the largest term that is left, at most 1.
    pub fn left(&self) -> f64 {
        self.value.abs() / self.size.max(f64::MIN_POSITIVE)
    }

    /// The fraction of the largest term that is left ([`Entry::left`]), or 0 if the coefficient may be only rounding.
    pub fn certain_left(&self) -> f64 {
        if self.is_certain() { self.left() } else { 0.0 }
    }

    /// Returns true if the coefficient certainly exceeds rounding.
    pub fn is_certain(&self) -> bool {
        self.value.abs() > MORE_THAN_ROUNDING * self.error()
    }
}

/// A sum of at most this many times its error bound is zero.
const NOISE: f64 = 16.0;
/// A number above this many times its error bound is more than rounding.
pub(crate) const MORE_THAN_ROUNDING: f64 = 2.0;

/// A row `sum entries = rhs` in scaled coefficients, with bounds of their rounding errors.
#[derive(Clone, Debug, Default)]
pub(crate) struct WorkingRow {
    /// The terms of free and prescribed DOFs.
    pub entries: Vec<Entry>,
    /// Number of free DOFs among the entries.
    pub free: u32,
    /// The right-hand side b.
    pub rhs: f64,
    /// `b - C_p u_p`. The next two fields are the largest term of this sum and a bound of its rounding error.
    pub effective: f64,
    pub effective_size: f64,
    pub effective_error: f64,
    /// The largest [`Entry::left`] of the dropped coefficients of free DOFs: the fraction of a coefficient's largest term that is left. A
    /// coefficient that may be only rounding counts as 0.
    pub dropped: f64,
    /// The largest product of factors by which a user's equation was added to this row, at least 1. It amplifies the rounding errors of
    /// that equation.
    pub reach: f64,
    table: Option<FxHashMap<u32, u32>>,
}

impl WorkingRow {
    /// A row without terms: `0 = rhs`.
    pub fn new(rhs: f64) -> Self {
        let error = f64::EPSILON * rhs.abs();
        Self { rhs, effective: rhs, effective_size: rhs.abs(), effective_error: error, reach: 1.0, ..Self::default() }
    }

    /// Moves a term of a prescribed DOF into b.
    pub fn prescribe(&mut self, part: f64) {
        self.effective -= part;
        self.effective_size = self.effective_size.max(part.abs());
        // The product and the sum are rounded.
        self.effective_error += f64::EPSILON * part.abs().max(self.effective.abs());
    }

    pub fn position(&self, dof: u32) -> Option<usize> {
        match &self.table {
            Some(table) => table.get(&dof).map(|&k| k as usize),
            None => self.entries.iter().position(|entry| entry.dof == dof),
        }
    }

    pub fn insert(&mut self, entry: Entry) {
        self.entries.push(entry);
        let last = self.entries.len() as u32 - 1;
        if let Some(table) = &mut self.table {
            table.insert(entry.dof, last);
        } else if self.entries.len() > LONG {
            self.table = Some(self.entries.iter().map(|entry| entry.dof).zip(0..).collect());
        }
    }

    /// Adds to the entry at a position. If the sum counts as zero ([`NOISE`]), returns the fraction of its largest term that is left, or 0
    /// if the sum may be only rounding.
    pub fn add(&mut self, position: usize, value: f64, error: f64, size: f64) -> Option<f64> {
        let entry = &mut self.entries[position];
        let sum = entry.value + value;
        let error = entry.error() + error + f64::EPSILON * sum.abs();
        *entry = Entry::new(entry.dof, sum, error, entry.size.max(size));
        (sum.abs() <= NOISE * error).then_some(if sum.abs() > MORE_THAN_ROUNDING * error { entry.left() } else { 0.0 })
    }

    /// Removes the entry at a position; the last entry moves into its place.
    pub fn remove(&mut self, position: usize) -> Entry {
        let removed = self.entries.swap_remove(position);
        if let Some(table) = &mut self.table {
            table.remove(&removed.dof);
            if let Some(moved) = self.entries.get(position) {
                table.insert(moved.dof, position as u32);
            }
        }
        removed
    }

    pub fn forget_table(&mut self) {
        self.table = None;
    }
}

#[cfg(test)]
mod tests {
    use super::WorkingRow;
    use crate::common::SplitMix64;
    use crate::input::scale::ldexp;

    /// `b - sum parts`, compared with the sum in whole numbers.
    #[test]
    fn rounding_of_a_side_without_prescribed_terms_is_within_its_bound() {
        let mut random = SplitMix64::new(3);
        for case in 0..2000 {
            let mut number = || {
                let whole = i128::from(random.next() >> 11) << (random.next() % 8);
                (whole, ldexp(whole as f64, -60))
            };
            let (mut exact, rhs) = number();
            let mut row = WorkingRow::new(rhs);
            for sign in (0..=case % 6).map(|k| if k % 3 == 2 { -1 } else { 1 }) {
                let (part, value) = number();
                exact -= i128::from(sign) * part;
                row.prescribe(f64::from(sign) * value);
            }
            let error = (row.effective - ldexp(exact as f64, -60)).abs();
            assert!(error <= row.effective_error, "{case}: {error:e} of {:e}", row.effective_error);
            assert!(row.effective.abs() <= row.effective_size * f64::from(2 + case % 6), "{case}");
        }
    }
}

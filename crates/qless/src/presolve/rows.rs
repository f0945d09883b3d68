//! Rows that change: sparse, unordered, with a lookup that stays fast in long rows.

use std::collections::HashMap;

/// Rows longer than this find their entries through a table.
const LONG: usize = 48;

/// A coefficient and a bound of its rounding error (in single precision, which is enough for a bound).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Entry {
    pub dof: u32,
    pub error: f32,
    pub value: f64,
}

/// A bound in single precision; what its subnormal numbers could tell only roughly is zero.
pub(crate) fn bound(error: f64) -> f32 {
    let error = error as f32;
    if error < f32::MIN_POSITIVE { 0.0 } else { error }
}

impl Entry {
    /// Whether it is more than rounding.
    pub fn is_certain(&self) -> bool {
        self.value.abs() > MORE_THAN_ROUNDING * f64::from(self.error)
    }
}

/// A number that was cancelled to within this many times its error bound is a zero.
const NOISE: f64 = 16.0;
/// A number that is larger than this many times its error bound is more than rounding.
pub(crate) const MORE_THAN_ROUNDING: f64 = 2.0;

/// `sum entries = rhs` in scaled coefficients, with what rounding may have done to it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Row {
    /// Free and prescribed DOFs.
    pub entries: Vec<Entry>,
    /// Number of free DOFs among the entries.
    pub free: u32,
    /// b.
    pub rhs: f64,
    /// `b - C_p u_p`, the largest part that went into it, and a bound of its rounding error.
    pub effective: f64,
    pub effective_size: f64,
    pub effective_error: f64,
    /// Largest coefficient that ever went into the row: what its entries are relative to.
    pub size: f64,
    /// Largest coefficient of a free DOF that was cancelled though it was more than rounding.
    pub dropped: f64,
    /// How large a multiple of a user's equation went into the row at most, by the product of the factors along its way: what
    /// rounding of that equation is multiplied by.
    pub reach: f64,
    table: Option<HashMap<u32, u32, Hasher>>,
}

type Hasher = std::hash::BuildHasherDefault<Multiplicative>;

/// DOF numbers need no defence against collisions made on purpose, and the table must not depend on a random key.
#[derive(Default)]
pub(crate) struct Multiplicative(u64);

impl std::hash::Hasher for Multiplicative {
    fn finish(&self) -> u64 {
        self.0
    }
    fn write(&mut self, bytes: &[u8]) {
        bytes.iter().for_each(|&b| self.write_u32(u32::from(b)));
    }
    fn write_u32(&mut self, x: u32) {
        self.0 = (self.0.rotate_left(5) ^ u64::from(x)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    }
}

impl Row {
    /// No terms yet: `0 = rhs`.
    pub fn new(rhs: f64) -> Self {
        let error = f64::EPSILON * rhs.abs();
        Self { rhs, effective: rhs, effective_size: rhs.abs(), effective_error: error, reach: 1.0, ..Self::default() }
    }

    /// Moves a term with a known value into b.
    pub fn prescribe(&mut self, part: f64) {
        self.effective -= part;
        self.effective_size = self.effective_size.max(part.abs());
        self.effective_error += f64::EPSILON * part.abs();
    }

    pub fn position(&self, dof: u32) -> Option<usize> {
        match &self.table {
            Some(table) => table.get(&dof).map(|&k| k as usize),
            None => self.entries.iter().position(|entry| entry.dof == dof),
        }
    }

    /// A coefficient as given: right to the last place.
    pub fn push(&mut self, dof: u32, value: f64) {
        self.insert(Entry { dof, value, error: bound(f64::EPSILON * value.abs()) });
    }

    /// A coefficient that may be nothing but rounding.
    pub fn push_uncertain(&mut self, dof: u32, value: f64) {
        self.insert(Entry { dof, value, error: bound(value.abs()) });
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

    /// Adds to the entry at a position; where nothing is left of it, what was given up though it was more than rounding, or zero.
    pub fn add(&mut self, position: usize, value: f64, error: f64) -> Option<f64> {
        let entry = &mut self.entries[position];
        let sum = entry.value + value;
        let error = f64::from(entry.error) + error + f64::EPSILON * sum.abs();
        (entry.value, entry.error) = (sum, bound(error));
        let given_up = if sum.abs() > MORE_THAN_ROUNDING * error { sum.abs() } else { 0.0 };
        (sum.abs() <= NOISE * error).then_some(given_up)
    }

    /// Takes the entry at a position out; the last entry moves into its place.
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

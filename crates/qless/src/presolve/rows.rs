//! Rows that change: sparse, unordered, with a lookup that stays fast in long rows.

use std::collections::HashMap;

/// Rows longer than this find their entries through a table.
const LONG: usize = 48;

/// `sum entries = rhs` in scaled coefficients, with what rounding may have done to it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Row {
    /// (DOF, coefficient); free and prescribed DOFs.
    pub entries: Vec<(u32, f64)>,
    /// Number of free DOFs among the entries.
    pub free: u32,
    /// b.
    pub rhs: f64,
    /// `b - C_p u_p`, and the largest part that went into it.
    pub effective: f64,
    pub effective_size: f64,
    /// Largest coefficient that ever went into the row: what its entries are relative to.
    pub size: f64,
    /// Bound of the rounding error in each entry.
    pub error: f64,
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
        Self { rhs, effective: rhs, effective_size: rhs.abs(), ..Self::default() }
    }

    pub fn position(&self, dof: u32) -> Option<usize> {
        match &self.table {
            Some(table) => table.get(&dof).map(|&k| k as usize),
            None => self.entries.iter().position(|&(j, _)| j == dof),
        }
    }

    pub fn push(&mut self, dof: u32, value: f64) {
        self.entries.push((dof, value));
        if let Some(table) = &mut self.table {
            table.insert(dof, self.entries.len() as u32 - 1);
        } else if self.entries.len() > LONG {
            self.table = Some(self.entries.iter().enumerate().map(|(k, &(j, _))| (j, k as u32)).collect());
        }
    }

    /// Takes the entry at a position out; the last entry moves into its place.
    pub fn remove(&mut self, position: usize) -> f64 {
        let (dof, value) = self.entries.swap_remove(position);
        if let Some(table) = &mut self.table {
            table.remove(&dof);
            if let Some(&(moved, _)) = self.entries.get(position) {
                table.insert(moved, position as u32);
            }
        }
        value
    }

    pub fn forget_table(&mut self) {
        self.table = None;
    }
}

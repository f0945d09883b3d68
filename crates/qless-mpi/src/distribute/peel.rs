//! Peeling: if an equation has a DOF that is in no other equation of the job, the rank that holds the equation solves it for this DOF.
//!
//! Such an equation is independent of all others and is in no certificate. It is peeled only if the serial analysis would do the same:
//! the coefficient of the DOF exceeds those of the equation's other free DOFs, no DOF of the equation has a coefficient that may be
//! rounding, and the equations of the component neither mix units nor hold numbers of extreme magnitude.

use crate::components::{ConnectedComponents, KnownDofs, NONE, TouchedDofs};
use crate::share::ShareRows;

/// A row that can be peeled, and the position of its slave among the terms of the row.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Peel {
    pub row: u32,
    pub position: u32,
}

/// A component is taken to mix units if more than one in this many of its shared columns has only small coefficients.
const MANY: u64 = 20;
/// Magnitudes far from the smallest and the largest double.
const MODEST: std::ops::Range<f64> = 1e-100..1e100;

/// Counts of rows and columns in a fragment. Their sums over the fragments of a component are conservative: they suggest mixed units too
/// often.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Sizes {
    /// Rows whose largest coefficient or nonzero right-hand side is near the smallest or the largest double.
    pub wild: u64,
    /// Columns that occur in several rows of the job and whose coefficients are small in every row of this rank.
    small: u64,
    /// Columns that occur in several rows of this rank and in none of other ranks.
    shared: u64,
}

impl Peel {
    pub fn row(self) -> usize {
        self.row as usize
    }

    /// The index of the slave's term among the terms of all rows.
    pub fn place(self, rows: &ShareRows) -> usize {
        rows.starts[self.row as usize] + self.position as usize
    }
}

impl Sizes {
    pub fn words(self) -> [u64; 3] {
        [self.wild, self.small, self.shared]
    }

    /// Whether a component has no numbers of extreme magnitude and seems not to mix units. `sum` holds three counts, summed over the
    /// fragments of the component: `wild`, `small` and `shared`, as in [`Sizes`].
    pub fn are_even(sum: &[u64; 3]) -> bool {
        sum[0] == 0 && MANY * sum[1] <= sum[2]
    }
}

/// The counts of rows and columns, [`Sizes`], of each fragment.
pub(crate) fn sizes(
    rows: &ShareRows,
    touched: &TouchedDofs,
    known: &KnownDofs,
    components: &ConnectedComponents,
) -> Vec<Sizes> {
    let mut sizes = vec![Sizes::default(); components.fragments()];
    for i in 0..rows.len() {
        let largest = rows.values(i).iter().fold(0.0, |most: f64, value| most.max(value.abs()));
        let rhs = rows.rhs[i].abs();
        let is_modest = MODEST.contains(&largest) && (rhs == 0.0 || MODEST.contains(&rhs));
        sizes[components.of_row[i] as usize].wild += u64::from(!is_modest);
    }
    let columns = components.of_dof.iter().zip(&touched.columns).zip(&known.flags);
    for ((&fragment, column), flags) in columns.filter(|((fragment, _), _)| **fragment != NONE) {
        let own = &mut sizes[fragment as usize];
        own.small += u64::from(column.is_small && (column.count >= 2 || flags.is_shared()));
        own.shared += u64::from(column.count >= 2 && !flags.is_shared());
    }
    sizes
}

/// Finds the rows that can be peeled, among those for which `allowed` is true.
pub(crate) fn peel(
    rows: &ShareRows,
    touched: &TouchedDofs,
    known: &KnownDofs,
    allowed: impl Fn(usize) -> bool,
) -> Vec<Peel> {
    (0..rows.len()).filter(|&row| allowed(row)).filter_map(|row| slave(rows, touched, known, row)).collect()
}

fn slave(rows: &ShareRows, touched: &TouchedDofs, known: &KnownDofs, row: usize) -> Option<Peel> {
    let places = touched.row(rows, row);
    let (mut position, mut largest, mut is_alone) = (None, 0.0, false);
    for (k, (&j, value)) in places.iter().zip(rows.values(row)).enumerate() {
        let (flags, size) = (known.flags[j as usize], value.abs());
        // The row is not peeled: whether this coefficient is rounding depends on all equations of its DOF, which this rank does not know.
        if flags.is_faint() {
            return None;
        }
        if flags.is_free() && size >= largest {
            (position, largest, is_alone) = (Some(k), size, size > largest);
        }
    }
    let position = position.filter(|_| is_alone)?;
    let j = places[position] as usize;
    (touched.columns[j].count == 1 && !known.flags[j].is_shared())
        .then_some(Peel { row: row as u32, position: position as u32 })
}

//! What a rank can decide alone: an equation with a DOF of no other equation of the job is solved for it where it stands.
//!
//! It is independent of all others, and stands in nobody's certificate. Only where the serial analysis would do just the same: the DOF's
//! coefficient is larger than all others of the equation, and no equation of the component mixes sizes.

use crate::parts::{Components, Known, Touched};
use crate::share::Rows;

/// An equation and the position of its slave.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Peel {
    pub row: usize,
    pub position: usize,
}

/// Columns all of whose coefficients are further below may be in another unit.
const SMALL: f64 = 1.0 / 512.0;
/// More than one column in this many must not be.
const MANY: u64 = 20;
/// Sizes that come nowhere near the ends of the range of doubles.
const MODEST: std::ops::Range<f64> = 1e-100..1e100;

/// How sizes lie in a part, counted so that what parts add up to errs towards mixed units.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Sizes {
    /// Rows near the ends of the range of doubles.
    pub wild: u64,
    /// Columns that are small in all rows that this rank holds.
    small: u64,
    /// Columns in two rows or more that no other rank knows.
    shared: u64,
}

impl Sizes {
    pub fn words(self) -> [u64; 3] {
        [self.wild, self.small, self.shared]
    }

    /// Whether sizes mix nowhere in a component, from the sums over its parts.
    pub fn are_even(sum: &[u64; 3]) -> bool {
        sum[0] == 0 && MANY * sum[1] <= sum[2]
    }
}

/// Of each part.
pub(crate) fn sizes(rows: &Rows, touched: &Touched, known: &Known, components: &Components) -> Vec<Sizes> {
    let mut of_part = vec![Sizes::default(); components.parts()];
    // Part, number of entries and number of small ones of each column.
    let mut columns = vec![(0, 0_u32, 0_u32); touched.dofs.len()];
    for i in 0..rows.len() {
        let largest = rows.largest(i);
        let rhs = rows.rhs[i].abs();
        let is_modest = MODEST.contains(&largest) && (rhs == 0.0 || MODEST.contains(&rhs));
        of_part[components.of_row[i] as usize].wild += u64::from(!is_modest);
        for (&j, (_, value)) in touched.row(rows, i).iter().zip(rows.row(i)) {
            let column = &mut columns[j as usize];
            *column = (components.of_row[i], column.1 + 1, column.2 + u32::from(value.abs() < SMALL * largest));
        }
    }
    for (j, (part, count, small)) in columns.into_iter().enumerate().filter(|&(j, _)| known.free[j]) {
        let of = &mut of_part[part as usize];
        of.small += u64::from(count == small && (count >= 2 || known.shared[j]));
        of.shared += u64::from(count >= 2 && !known.shared[j]);
    }
    of_part
}

/// The rows among those allowed that have such a DOF.
pub(crate) fn peel(rows: &Rows, touched: &Touched, known: &Known, allowed: impl Fn(usize) -> bool) -> Vec<Peel> {
    let mut times = vec![0_u32; touched.dofs.len()];
    touched.places.iter().for_each(|&j| times[j as usize] += 1);
    let is_private = |j: usize| known.free[j] && !known.shared[j] && times[j] == 1;
    let slave = |row: usize| {
        let places = touched.row(rows, row).iter().map(|&j| j as usize);
        // What is rounding is told by all equations of a DOF.
        if places.clone().any(|j| known.faint[j]) {
            return None;
        }
        let free = places.zip(rows.row(row)).enumerate().filter(|(_, (j, _))| known.free[*j]);
        let size = |(_, (_, (_, value))): &(usize, (usize, (u64, f64)))| value.abs();
        let (position, (j, (_, value))) = free.clone().max_by(|a, b| size(a).total_cmp(&size(b)))?;
        let alone = free.filter(|other| size(other) == value.abs()).count() == 1;
        (alone && is_private(j)).then_some(Peel { row, position })
    };
    (0..rows.len()).filter(|&row| allowed(row)).filter_map(slave).collect()
}

//! What a rank can decide alone: an equation with a DOF of no other equation of the job is solved for it where it stands.
//!
//! It is independent of all others, and stands in nobody's certificate. Only where the serial analysis would do just the same: the DOF's
//! coefficient is larger than all others of the equation, and no equation of the component mixes sizes.

use crate::parts::{Known, Touched};
use crate::share::Rows;

/// An equation and the position of its slave.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Peel {
    pub row: usize,
    pub position: usize,
}

/// Coefficients further below the largest may be in another unit, which only the whole component can tell.
const SPAN: f64 = 1.0 / 256.0;
/// Sizes that come nowhere near the ends of the range of doubles.
const MODEST: std::ops::Range<f64> = 1e-100..1e100;

/// Whether nothing of the row asks for a look at the rest of its component.
pub(crate) fn is_mild(rows: &Rows, i: usize) -> bool {
    let largest = rows.row(i).fold(0.0, |most: f64, (_, value)| most.max(value.abs()));
    let even = rows.row(i).all(|(_, value)| value.abs() >= SPAN * largest);
    let rhs = rows.rhs[i].abs();
    even && MODEST.contains(&largest) && (rhs == 0.0 || MODEST.contains(&rhs))
}

/// The rows among those allowed that have such a DOF.
pub(crate) fn peel(rows: &Rows, touched: &Touched, known: &Known, allowed: impl Fn(usize) -> bool) -> Vec<Peel> {
    let mut times = vec![0_u32; touched.dofs.len()];
    touched.places.iter().for_each(|&j| times[j as usize] += 1);
    let is_private = |j: usize| known.free[j] && !known.shared[j] && times[j] == 1;
    let slave = |row: usize| {
        let places = touched.row(rows, row).iter().map(|&j| j as usize);
        let free = places.zip(rows.row(row)).enumerate().filter(|(_, (j, _))| known.free[*j]);
        let size = |(_, (_, (_, value))): &(usize, (usize, (u64, f64)))| value.abs();
        let (position, (j, (_, value))) = free.clone().max_by(|a, b| size(a).total_cmp(&size(b)))?;
        let alone = free.filter(|other| size(other) == value.abs()).count() == 1;
        (alone && is_private(j)).then_some(Peel { row, position })
    };
    (0..rows.len()).filter(|&row| allowed(row)).filter_map(slave).collect()
}

//! The constraint set along a path: constant, or driven through time, `t = t_0 + s (t_1 - t_0)` at the load factor s.

use std::f64::consts::PI;

use qless_constraints::{ConstraintSet, TimeError};

use super::EquilibriumError;

/// Largest turn of a motor in one load step. The constraint values alone would allow almost half a turn, but Newton's method changes to
/// another branch earlier. An eighth of half a turn is far below that.
const FARTHEST: f64 = PI / 8.0;

/// The constraint set of a path.
pub enum TimePath<'a> {
    /// The set keeps its time.
    Still(&'a ConstraintSet),
    /// The set advances from one time to another.
    Driven { set: &'a mut ConstraintSet, times: [f64; 2] },
}

impl TimePath<'_> {
    pub fn set(&self) -> &ConstraintSet {
        match self {
            Self::Still(set) => set,
            Self::Driven { set, .. } => set,
        }
    }

    /// Sets the time of a load factor; fails if a motor turns too far from the last equilibrium.
    ///
    /// The constraint values see an angle modulo 2 pi, so that steps have to stay below pi.
    pub fn advance_to(&mut self, factor: f64) -> Result<(), EquilibriumError> {
        let before = self.set().angles();
        self.set_factor(factor)?;
        let turns = before.iter().zip(self.set().angles()).map(|(&(_, before), (row, now))| (row, now - before));
        let most = turns.max_by(|(_, a), (_, b)| a.abs().total_cmp(&b.abs()));
        let far = most.filter(|(_, angle)| angle.abs() > FARTHEST);
        let label = |row| self.set().label(row).unwrap_or_default();
        far.map_or(Ok(()), |(row, angle)| Err(EquilibriumError::Turn { factor: 0.0, label: label(row), angle }))
    }

    /// Sets the time of a load factor without a limit on angles. It cannot fail for the factor of an earlier equilibrium.
    pub fn set_factor(&mut self, factor: f64) -> Result<(), TimeError> {
        match self {
            Self::Still(_) => Ok(()),
            Self::Driven { set, times: [from, to] } => {
                set.set_time(if factor == 1.0 { *to } else { *from + factor * (*to - *from) })
            }
        }
    }
}

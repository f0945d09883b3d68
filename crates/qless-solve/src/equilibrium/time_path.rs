//! The constraints on the way: at rest, or driven through time, `t = t_0 + s (t_1 - t_0)` at the load factor s.

use std::f64::consts::PI;

use qless_constraints::{ConstraintSet, TimeError};

use super::StepFailure;

/// Most that a motor turns by in a load step. c would follow nearly half a turn; Newton's method goes over to another branch sooner.
const FARTHEST: f64 = PI / 8.0;

/// The set of a path.
pub enum TimePath<'a> {
    /// It stays at its time.
    Still(&'a ConstraintSet),
    /// It goes from one time to another.
    Driven { set: &'a mut ConstraintSet, times: [f64; 2] },
}

impl TimePath<'_> {
    pub fn set(&self) -> &ConstraintSet {
        match self {
            Self::Still(set) => set,
            Self::Driven { set, .. } => set,
        }
    }

    /// Goes to the time of a load factor, from that of an equilibrium.
    ///
    /// Of an angle c knows no whole turns, and follows it the shorter way: nearer than by half a turn, which is too far for Newton's method too.
    pub fn go(&mut self, factor: f64) -> Result<(), StepFailure> {
        let before = self.set().angles();
        self.go_between(factor)?;
        let turns = before.iter().zip(self.set().angles()).map(|(&(_, before), (row, now))| (row, now - before));
        let most = turns.max_by(|(_, a), (_, b)| a.abs().total_cmp(&b.abs()));
        let far = most.filter(|(_, angle)| angle.abs() > FARTHEST);
        far.map_or(Ok(()), |(row, angle)| Err(StepFailure::Turn { row, angle }))
    }

    /// Goes to the time of a load factor, however far that turns.
    pub fn go_between(&mut self, factor: f64) -> Result<(), StepFailure> {
        self.put(factor).map_err(|error| StepFailure::Fatal(error.into()))
    }

    /// Goes back to where it was at a load factor.
    pub fn back(&mut self, factor: f64) {
        // All functions of time were finite there.
        let _ = self.put(factor);
    }

    fn put(&mut self, factor: f64) -> Result<(), TimeError> {
        match self {
            Self::Still(_) => Ok(()),
            Self::Driven { set, times: [from, to] } => {
                set.set_time(if factor == 1.0 { *to } else { *from + factor * (*to - *from) })
            }
        }
    }
}

//! Right-hand sides and parameters that are functions of time: `c(u, t) = 0`.
//!
//! Patterns do not depend on time: [`ConstraintSet::set_time`] writes new numbers in place. The functions of an inactive
//! constraint need not be finite. While one is not, [`ConstraintSet::values_of`] and [`ConstraintSet::activate`] refuse the
//! constraint.

use crate::set::ConstraintSet;
use crate::set::error::TimeError;

impl ConstraintSet {
    /// The time at which the set is evaluated; 0 at first.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Changes the time: right-hand sides and parameters that are functions of time are evaluated there.
    ///
    /// ```
    /// use qless_constraints::{ConstraintSet, types::Driven};
    /// let mut builder = ConstraintSet::builder(2);
    /// builder.add("piston", Driven::new([(1, 1.0)], |t| 0.5 * t))?;
    /// let mut set = builder.build()?;
    /// let mut evaluation = set.allocate();
    /// set.set_time(4.0)?;
    /// set.evaluate(&[0.0, 3.0], &mut evaluation)?;
    /// assert_eq!(evaluation.c(), [1.0]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`TimeError`] if the time, or a function of time of an active constraint, is not finite; the set then keeps its time.
    pub fn set_time(&mut self, time: f64) -> Result<(), TimeError> {
        if !time.is_finite() {
            return Err(TimeError::Time(time));
        }
        let mut values = Vec::new();
        for (row, function) in self.linear.driven() {
            let value = function(time);
            if !value.is_finite() {
                let label = self.label(row).unwrap_or_default();
                return Err(TimeError::NotFinite { label, time, value });
            }
            values.push((row, value));
        }
        if let Err((row, value)) = self.nonlinear.set_time(time) {
            let label = self.label(self.linear.rows() + row).unwrap_or_default();
            // This cannot fail: all values were finite at the old time.
            let _ = self.nonlinear.set_time(self.time);
            return Err(TimeError::NotFinite { label, time, value });
        }
        values.into_iter().for_each(|(row, value)| self.linear.set_rhs(row, value));
        self.register.inactive.values_mut().for_each(|contents| contents.not_finite = contents.at_time(time).err());
        self.time = time;
        self.version.renew();
        Ok(())
    }

    /// `(row of c, angle in radians)` at the time of the set, for each equation that determines a prescribed angle only up to multiples of
    /// 2 pi, such as that of a rotation motor.
    pub fn angles(&self) -> Vec<(usize, f64)> {
        let mut angles = Vec::new();
        for (first, batch) in self.nonlinear.with_rows() {
            batch.angles(&mut |row, angle| angles.push((self.linear.rows() + first + row, angle)));
        }
        angles
    }
}

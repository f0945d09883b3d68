//! Where a load path starts and ends.

use super::Equilibrium;
use qless_constraints::ConstraintSet;

/// Where a load path starts: an equilibrium, or a guess of one.
#[derive(Clone, Debug, PartialEq)]
pub struct Start {
    /// DOFs.
    pub u: Vec<f64>,
    /// Multipliers, one per equation.
    pub multipliers: Vec<f64>,
    /// The loads that it carries; the load factor 0.
    pub loads: Vec<f64>,
}

impl Start {
    /// All zero.
    pub fn at_rest(set: &ConstraintSet) -> Self {
        let zeros = || vec![0.0; set.dofs()];
        Self { u: zeros(), multipliers: vec![0.0; set.equations()], loads: zeros() }
    }
}

/// Where it ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target<'a> {
    /// `f_ext`, one number per DOF.
    pub loads: &'a [f64],
    /// DOFs and their values.
    pub prescribed: &'a [(usize, f64)],
}

impl Equilibrium {
    /// From here the next path starts.
    pub fn start(&self) -> Start {
        Start { u: self.u.clone(), multipliers: self.multipliers.clone(), loads: self.loads.clone() }
    }
}

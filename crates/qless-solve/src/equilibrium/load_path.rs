//! Start, target and settings of a load path.

use qless::Options;
use qless_constraints::{ConstraintSet, PerConstraint};

use super::{Equilibrium, EquilibriumError};

/// Start of a load path: an equilibrium, or a guess of one.
#[derive(Clone, Debug, PartialEq)]
pub struct Start {
    /// Values of the DOFs at the start.
    pub u: Vec<f64>,
    /// Multipliers; a constraint that has none starts with zero.
    pub multipliers: PerConstraint,
    /// The loads with which the start is in equilibrium, at load factor 0.
    pub loads: Vec<f64>,
}

impl Start {
    /// A start with zero displacements, multipliers and loads.
    pub fn at_rest(set: &ConstraintSet) -> Self {
        let zeros = || vec![0.0; set.dofs()];
        Self { u: zeros(), multipliers: PerConstraint::default(), loads: zeros() }
    }
}

/// Target of a load path, at load factor 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target<'a> {
    /// External loads `f_ext`, one number per DOF. At the rotation of a body, these are the components of a moment in space: three for a
    /// rotation vector; for Euler parameters, a zero and then the three components. Such a moment keeps its axis in space while the body
    /// turns; it has no energy, so that the tangent is not symmetric ([`super::Stability::NotSymmetric`]).
    pub loads: &'a [f64],
    /// Prescribed DOFs and their values.
    pub prescribed: &'a [(usize, f64)],
}

impl Equilibrium {
    /// The start of the next path.
    pub fn start(&self) -> Start {
        Start { u: self.u.clone(), multipliers: self.multipliers.clone(), loads: self.loads.clone() }
    }
}

/// Settings of [`super::solve`].
#[derive(Clone, Debug)]
pub struct EquilibriumOptions {
    /// Largest residual force `|r_j|` in equilibrium, relative to the sum of the sizes of its terms; rounding is allowed as well. Default
    /// 1e-10.
    pub tolerance: f64,
    /// Tolerance of constraints in units of their rounding, as [`crate::newton::NewtonOptions::tolerance`]. Default 4.
    pub roundings: f64,
    /// Largest number of iterations of a part in one load step. Default 25.
    pub iterations: usize,
    /// The first load step, relative to the whole path. Default 1: a single step, if it works.
    pub first: f64,
    /// The shortest load step, relative to the whole path. Default 1e-4.
    pub shortest: f64,
    /// Whether to compute [`super::Equilibrium::stability`], which costs another factorization. Default no.
    pub stability: bool,
    /// How the constraints are analysed.
    pub analysis: Options,
}

impl Default for EquilibriumOptions {
    fn default() -> Self {
        let analysis = Options::default();
        Self {
            tolerance: 1e-10,
            roundings: 4.0,
            iterations: 25,
            first: 1.0,
            shortest: 1e-4,
            stability: false,
            analysis,
        }
    }
}

impl EquilibriumOptions {
    pub(super) fn validate(&self) -> Result<(), EquilibriumError> {
        let part = "it must lie between 0 and 1";
        let list = [
            ("tolerance", self.tolerance, self.tolerance > 0.0 && self.tolerance < 1.0, part),
            ("first", self.first, self.first > 0.0 && self.first <= 1.0, part),
            ("shortest", self.shortest, self.shortest > 0.0 && self.shortest <= 1.0, part),
            ("roundings", self.roundings, self.roundings >= 1.0 && self.roundings.is_finite(), "it must be at least 1"),
        ];
        let bad = list.into_iter().find(|&(_, _, good, _)| !good);
        bad.map_or(Ok(()), |(what, value, _, range)| Err(EquilibriumError::Option { what, value, range }))
    }
}

//! A load path: its start, target and settings, and the equilibrium at its end with the load steps and iterates.

use qless::Options;
use qless_constraints::ConstraintSet;

use super::{EquilibriumError, Stability};

/// Start of a load path: an equilibrium, or a guess of one.
#[derive(Clone, Debug, PartialEq)]
pub struct Start {
    /// DOFs.
    pub u: Vec<f64>,
    /// Multipliers, one per equation.
    pub multipliers: Vec<f64>,
    /// The loads in equilibrium at the start, at load factor 0.
    pub loads: Vec<f64>,
}

impl Start {
    /// All zero.
    pub fn at_rest(set: &ConstraintSet) -> Self {
        let zeros = || vec![0.0; set.dofs()];
        Self { u: zeros(), multipliers: vec![0.0; set.equations()], loads: zeros() }
    }
}

/// Target of a load path, at load factor 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target<'a> {
    /// `f_ext`, one number per DOF.
    pub loads: &'a [f64],
    /// DOFs and their values.
    pub prescribed: &'a [(usize, f64)],
}

/// One iterate, with its residuals.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EquilibriumIterate {
    /// `max_j |r_j|` over the free DOFs, relative to the sizes of its terms or to what rounding allows.
    pub force: f64,
    /// `max_r eps |c_r| / rounding_r` over the kept rows, relative to the sizes of the terms of c. If c no longer falls, the largest terms of
    /// its part count, or less if the motion that makes up for c changes forces by less than their rounding.
    pub constraint: f64,
    /// Step length that led to this iterate: 1 for a full correction, 0 if only multipliers changed. The smallest of the connected parts that
    /// moved; the other fields are the largest of all parts.
    pub length: f64,
    /// Whether the tangent of the last correction was singular and was regularised.
    pub regularised: bool,
}

/// One load step.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadStep {
    /// Load factor: 0 at the start, 1 at the target.
    pub factor: f64,
    /// Whether the step found an equilibrium. If not, failed parts were tried again from a configuration that satisfies the constraints, or
    /// the step was shortened.
    pub converged: bool,
    /// Whether branches of the determined DOFs meet on the way, or nearly meet. Newton's method then chose one: check the result, or use
    /// other steps.
    pub branches_meet: bool,
    /// The iterates of the parts that were tried.
    pub iterates: Vec<EquilibriumIterate>,
}

/// An equilibrium.
#[derive(Clone, Debug, PartialEq)]
pub struct Equilibrium {
    /// DOFs.
    pub u: Vec<f64>,
    /// One per equation, in units of force times displacement per unit of c; 0 for redundant equations.
    pub multipliers: Vec<f64>,
    /// `f_int + G^T lambda - f_ext` at prescribed DOFs, in the order of [`super::Target::prescribed`]: the support forces.
    pub reactions: Vec<f64>,
    /// `-G^T lambda`: force of the constraints on the model, one per DOF.
    pub constraint_forces: Vec<f64>,
    /// Redundant equations, which have no multiplier.
    pub redundant: Vec<usize>,
    /// Result of the check that [`super::EquilibriumOptions::stability`] asks for. [`Stability::Stable`] if all connected parts are stable;
    /// the unstable directions of all parts are added up; not symmetric or undecided if one part is.
    pub stability: Option<Stability>,
    /// All attempted load steps, including failed ones.
    pub steps: Vec<LoadStep>,
    /// The loads in equilibrium.
    pub loads: Vec<f64>,
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
    /// Largest `|r_j|` in equilibrium, relative to the sum of the sizes of its terms; rounding is allowed as well. Default 1e-10.
    pub tolerance: f64,
    /// Tolerance of constraints, as [`crate::newton::NewtonOptions::tolerance`]. Default 4.
    pub roundings: f64,
    /// Most iterations of a part in one load step. Default 25.
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

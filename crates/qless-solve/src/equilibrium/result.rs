//! What comes out: an equilibrium, and the load steps and iterates on the way to it.

use super::Stability;

/// One iterate: what was out of balance when it was reached.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EquilibriumIterate {
    /// `max_j |r_j|` over the free DOFs, relative to the sizes of its terms, or to what rounding allows.
    pub force: f64,
    /// `max_r eps |c_r| / rounding_r` over the kept rows: relative to the sizes of the terms of c, its own or, where it no longer
    /// falls, the largest; or less, where a motion that makes up for c is less than the rounding of forces.
    pub constraint: f64,
    /// How much of the correction was gone to come here: 1 for all of it, 0 where only multipliers changed. The least of the connected parts that were
    /// still on their way; all else is the largest of all parts.
    pub length: f64,
    /// Whether a tangent before it was singular, and something was added to it.
    pub regularised: bool,
}

/// One load step.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadStep {
    /// EquilibriumPart of the way from the start to the target.
    pub factor: f64,
    /// Whether equilibrium was found there; if not, the parts that failed were tried once more from a configuration that satisfies the constraints, or
    /// the step was cut.
    pub converged: bool,
    /// Whether branches of what the constraints determine meet on the way there, or nearly so: which one was taken, Newton's method decided. Look
    /// at the result, or go there in other steps.
    pub branches_meet: bool,
    /// The way there, of the parts that were tried.
    pub iterates: Vec<EquilibriumIterate>,
}

/// An equilibrium.
#[derive(Clone, Debug, PartialEq)]
pub struct Equilibrium {
    /// DOFs.
    pub u: Vec<f64>,
    /// One per equation, in units of force times displacement per unit of c; 0 for those left out.
    pub multipliers: Vec<f64>,
    /// `f_int + G^T lambda - f_ext` at prescribed DOFs, in the order of [`super::Target::prescribed`]: what the supports push with.
    pub reactions: Vec<f64>,
    /// `-G^T lambda`: what the constraints push the model with, one per DOF.
    pub constraint_forces: Vec<f64>,
    /// Equations that are redundant here, without multipliers.
    pub redundant: Vec<usize>,
    /// Whether it is stable, where [`super::EquilibriumOptions::stability`] asks: [`Stability::Stable`] if all connected parts are, and unstable in as
    /// many directions as these together; not symmetric or undecided if one of them is.
    pub stability: Option<Stability>,
    /// All attempts at load steps, those that failed too.
    pub steps: Vec<LoadStep>,
    /// The loads that it carries.
    pub loads: Vec<f64>,
}

//! Results: an equilibrium, with its load steps and iterates.

use qless_constraints::PerConstraint;

use super::Stability;

/// One iterate, with its residuals.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EquilibriumIterate {
    /// Largest residual force `|r_j|` of the free DOFs, relative to the sizes of its terms. The rounding that the tolerance allows is
    /// included in these sizes.
    pub force: f64,
    /// `max_r eps |c_r| / rounding_r` over the kept rows: the constraint values c_r relative to the sizes of their terms. If c no longer
    /// falls, two other measures of c_r count if they are smaller: relative to the largest terms of the part, or by the forces that a
    /// motion removing c_r would change, relative to their rounding.
    pub constraint: f64,
    /// Step length that led to this iterate: 1 for a full correction, 0 if only multipliers changed. Of all connected parts that moved, the
    /// smallest length counts; in the other fields, the largest number of all parts counts.
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
    /// Whether branches of the DOFs that constraints and prescribed DOFs determine meet on the way, or nearly meet. Newton's method then
    /// chose one: check the result, or use other steps.
    pub branches_meet: bool,
    /// The iterates of the parts that were tried.
    pub iterates: Vec<EquilibriumIterate>,
}

/// An equilibrium.
#[derive(Clone, Debug, PartialEq)]
pub struct Equilibrium {
    /// Displacements of all DOFs.
    pub u: Vec<f64>,
    /// Multipliers, one per equation, in units of force times displacement per unit of the constraint value; 0 for redundant equations.
    /// Each multiplier belongs to its constraint, also after other constraints are added or removed.
    pub multipliers: PerConstraint,
    /// Support forces `f_int + G^T lambda - f_ext` at prescribed DOFs, one number per DOF, zero elsewhere. At rotations of bodies they are
    /// moments in space, as in [`super::Target::loads`].
    pub reactions: Vec<f64>,
    /// Forces `-G^T lambda` of all constraints on the model, one number per DOF. At rotations of bodies they are moments in space.
    /// [`qless_constraints::ConstraintSet::forces_of`] gives the forces of a single constraint.
    pub constraint_forces: Vec<f64>,
    /// Redundant equations, which have no multiplier.
    pub redundant: Vec<usize>,
    /// Result of the check that [`super::EquilibriumOptions::stability`] asks for: [`Stability::Stable`] if all connected parts are stable.
    /// The unstable directions of all parts are added up. If one part is not symmetric or undecided, so is the result.
    pub stability: Option<Stability>,
    /// All attempted load steps, including failed ones.
    pub steps: Vec<LoadStep>,
    /// The loads with which the model is in equilibrium.
    pub loads: Vec<f64>,
}

//! Evaluates f_int, K, c, G and H at one configuration, and the residual `r = f_int + G^T lambda - f_ext`.

use qless::Csr;
use qless_constraints::{ConstraintSet, Evaluation, Rounding};

use super::EquilibriumError;
use super::model::{Assembly, AssemblyFault, Model};
use crate::newton::{Part, Parts, Scales, at_rest, in_roundings};

/// Relative rounding of a force: about eight operations between a coordinate and the sum of its terms.
pub const ULPS: f64 = 8.0 * f64::EPSILON;

/// Displacements and multipliers.
#[derive(Clone, Debug)]
pub struct Unknowns {
    pub u: Vec<f64>,
    pub multipliers: Vec<f64>,
}

/// The model and the constraints, evaluated at one configuration.
pub struct EquilibriumState {
    pub assembly: Assembly,
    pub evaluation: Evaluation,
    /// The residual forces `f_int + G^T lambda - f_ext` at all DOFs.
    pub residual: Vec<f64>,
    /// For each DOF, the sum of the absolute terms of its residual force.
    pub terms: Vec<f64>,
    /// Effect of the rounding of u and of the constraint Jacobian G on the residual forces.
    rounding: Vec<f64>,
    /// Stiffness of moments that are fixed in space: entries `(i, j, -d f_i / du_j)`, sorted by row. Their generalised forces f depend on
    /// u, because the moments rotate relative to the body.
    moments: Vec<(usize, usize, f64)>,
    /// The constraint value `|c_r|` of each equation in units of the rounding of its terms. If c no longer falls, the rounding of
    /// coordinates or of forces may count instead.
    pub constraints: Vec<f64>,
    /// Bounds on the rounding of the constraint values c and their Jacobian G.
    of_constraints: Option<Rounding>,
}

impl EquilibriumState {
    pub fn new(model: &impl Model, set: &ConstraintSet) -> Result<Self, EquilibriumError> {
        let assembly = Assembly::new(model);
        fault(&assembly)?;
        let n = set.dofs();
        let zeros = || vec![0.0; n];
        let (evaluation, constraints) = (set.allocate(), vec![0.0; set.equations()]);
        Ok(Self {
            assembly,
            evaluation,
            residual: zeros(),
            terms: zeros(),
            rounding: zeros(),
            moments: Vec::new(),
            constraints,
            of_constraints: None,
        })
    }

    /// Evaluates only the residual forces and the constraint values c, for trial points.
    pub fn balance(
        &mut self,
        model: &mut impl Model,
        set: &ConstraintSet,
        at: &Unknowns,
        loads: &[f64],
    ) -> Result<(), EquilibriumError> {
        self.assembly.clear(false);
        model.assemble(&at.u, &mut self.assembly).map_err(model_error)?;
        set.evaluate(&at.u, &mut self.evaluation)?;
        self.sum(set, at, loads)
    }

    /// Evaluates the forces f_int and their stiffness K, the constraint values c and their Jacobian G, and the stiffness H of the
    /// constraints.
    pub fn evaluate(
        &mut self,
        model: &mut impl Model,
        set: &ConstraintSet,
        at: &Unknowns,
        loads: &[f64],
    ) -> Result<(), EquilibriumError> {
        self.assembly.clear(true);
        model.assemble(&at.u, &mut self.assembly).map_err(model_error)?;
        set.assemble(&at.u, &at.multipliers, &mut self.evaluation)?;
        self.sum(set, at, loads)?;
        let moments = &mut self.moments;
        moments.clear();
        set.moment_stiffness(&at.u, loads, &mut |i, j, v| moments.push((i, j, -v)))?;
        moments.sort_by_key(|&(i, j, _)| (i, j));
        let rounding = set.rounding(&at.u)?;
        self.constraints = in_roundings(self.evaluation.c(), rounding.c());
        self.round(model, at, rounding.g());
        self.of_constraints = Some(rounding);
        Ok(())
    }

    /// Measures the constraint values c again in the parts `settled`, where c no longer falls. The remaining c_r may be rounding of larger
    /// terms in other rows, or may change forces by less than their rounding.
    pub fn settle(&mut self, set: &ConstraintSet, parts: &Parts, settled: &[usize]) -> Result<(), EquilibriumError> {
        let Some(rounding) = self.of_constraints.as_ref().filter(|_| !settled.is_empty()) else { return Ok(()) };
        let weights = Scales::new(set, &self.evaluation, rounding, parts).weights;
        let rest = at_rest(set, (&self.evaluation, rounding, &weights), parts)?;
        for part in settled.iter().map(|&part| &parts.list[part]) {
            let in_forces = self.in_forces(part);
            part.rows.iter().zip(in_forces).for_each(|(&r, in_forces)| self.constraints[r] = rest[r].min(in_forces));
        }
        Ok(())
    }

    /// For each equation r of the part, how much its violation c_r matters, as a change of force in units in the last place of the largest
    /// force: `min_j |c_r / G_rj| K_jj^1/2 / max_i terms_i K_ii^-1/2`. A motion of DOF j by `c_r / G_rj` makes c_r zero; the DOF with the
    /// smallest change of force counts. The `terms_i` are the sums of the sizes of the forces on the free DOFs i.
    ///
    /// If the result is small, c_r is negligible. Its own terms cannot show this if they are small too, as those of a support `u_0 = 0` are
    /// near zero.
    fn in_forces(&self, part: &Part) -> Vec<f64> {
        let stiffness = |j: usize| self.assembly.row(j).find(|&(k, _)| k == j).map_or(0.0, |(_, v)| v.abs().sqrt());
        let sizes = part.free.iter().map(|&j| (stiffness(j), self.terms[j])).filter(|(stiffness, _)| *stiffness > 0.0);
        let most = sizes.map(|(stiffness, terms)| terms / stiffness).fold(0.0, f64::max);
        let (c, g) = (self.evaluation.c(), self.evaluation.g());
        let of_row = |&r: &usize| {
            let motions = g.row(r).filter(|&(j, v)| v != 0.0 && stiffness(j) > 0.0);
            let least = motions.map(|(j, v)| (c[r] / v).abs() * stiffness(j)).fold(f64::INFINITY, f64::min);
            if most > 0.0 { least / (f64::EPSILON * most) } else { f64::INFINITY }
        };
        part.rows.iter().map(of_row).collect()
    }

    /// The entries of row i in the stiffness of moments that are fixed in space.
    pub fn moments_of(&self, i: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let first = self.moments.partition_point(|&(row, ..)| row < i);
        self.moments[first..].iter().take_while(move |&&(row, ..)| row == i).map(|&(_, j, v)| (j, v))
    }

    fn sum(&mut self, set: &ConstraintSet, at: &Unknowns, loads: &[f64]) -> Result<(), EquilibriumError> {
        fault(&self.assembly)?;
        let loads = set.generalised_forces(&at.u, loads)?;
        let Self { assembly, residual, terms, .. } = self;
        for (j, &load) in loads.iter().enumerate() {
            residual[j] = assembly.force[j] - load;
            terms[j] = assembly.terms[j] + load.abs();
        }
        let g = self.evaluation.g();
        for (r, &lambda) in at.multipliers.iter().enumerate().filter(|(_, lambda)| **lambda != 0.0) {
            g.row(r).for_each(|(j, v)| {
                residual[j] += v * lambda;
                terms[j] += (v * lambda).abs();
            });
        }
        Ok(())
    }

    /// Fails if a force, its stiffness or a constraint value of a part is not finite. Stiffness is that of the last full evaluation.
    pub fn finite(&self, part: &Part) -> Result<(), EquilibriumError> {
        finite("the force", part.free.iter().map(|&j| (j, self.residual[j])))?;
        finite("the constraint value", part.rows.iter().map(|&r| (r, self.evaluation.c()[r])))?;
        finite("the stiffness", part.free.iter().flat_map(|&i| self.assembly.row(i).map(move |(_, k)| (i, k))))
    }

    /// Fails if a force or its stiffness at prescribed DOFs is not finite.
    pub fn finite_at(&self, prescribed: &[(usize, f64)]) -> Result<(), EquilibriumError> {
        finite("the force", prescribed.iter().map(|&(j, _)| (j, self.residual[j])))?;
        finite("the stiffness", prescribed.iter().flat_map(|&(i, _)| self.assembly.row(i).map(move |(_, k)| (i, k))))
    }

    fn round(&mut self, model: &impl Model, at: &Unknowns, of_g: &[f64]) {
        self.rounding.fill(0.0);
        for (i, rounding) in self.rounding.iter_mut().enumerate() {
            let terms = self.assembly.row(i);
            terms.for_each(|(j, k)| *rounding += ULPS * k.abs() * (at.u[j].abs() + model.coordinate(j).abs()));
        }
        let g = self.evaluation.g();
        for (r, &lambda) in at.multipliers.iter().enumerate().filter(|(_, lambda)| **lambda != 0.0) {
            let bounds = &of_g[g.starts()[r]..g.starts()[r + 1]];
            g.row(r).zip(bounds).for_each(|((j, _), bound)| self.rounding[j] += (lambda * bound).abs());
        }
    }

    /// The largest relative residual force, `max |r_j| / (terms_j + rounding_j / tolerance)` over the free DOFs; at most the tolerance in
    /// equilibrium.
    pub fn force(&self, free: &[usize], tolerance: f64) -> f64 {
        let relative = |&j: &usize| {
            let size = self.terms[j] + self.rounding[j] / tolerance;
            if self.residual[j] == 0.0 { 0.0 } else { self.residual[j].abs() / size }
        };
        free.iter().map(relative).fold(0.0, f64::max)
    }

    /// Whether `c_r - sum y_k c_k` is rounding, for a redundant row r with the certificate `row_r = sum y_k row_k`. The limit is
    /// `roundings` times the rounding of c_r and of each `y_k c_k`.
    pub fn follows(&self, row: usize, because: impl Iterator<Item = (f64, usize)>, roundings: f64) -> bool {
        let Some(rounding) = &self.of_constraints else { return false };
        let (c, bounds) = (self.evaluation.c(), rounding.c());
        let start = (c[row], roundings * bounds[row]);
        let (left, limit) =
            because.fold(start, |(left, limit), (y, k)| (left - y * c[k], limit + roundings * (y * bounds[k]).abs()));
        left.abs() <= limit
    }

    /// The largest constraint value `|c_r|` of the given rows, in units of rounding.
    pub fn constraint(&self, rows: &[usize]) -> f64 {
        rows.iter().map(|&r| self.constraints[r]).fold(0.0, f64::max)
    }
}

pub fn fault(assembly: &Assembly) -> Result<(), EquilibriumError> {
    match assembly.fault {
        Some(AssemblyFault::Force(dof)) => Err(EquilibriumError::Force { dof, dofs: assembly.force.len() }),
        Some(AssemblyFault::Stiffness(row, column)) => Err(EquilibriumError::Pattern { row, column }),
        None => Ok(()),
    }
}

pub fn model_error(source: Box<dyn std::error::Error + Send + Sync>) -> EquilibriumError {
    EquilibriumError::Model { factor: 0.0, source }
}

fn finite(what: &'static str, mut numbers: impl Iterator<Item = (usize, f64)>) -> Result<(), EquilibriumError> {
    let bad = numbers.find(|(_, x)| !x.is_finite());
    bad.map_or(Ok(()), |(at, _)| Err(EquilibriumError::NotFinite { factor: 0.0, what, at }))
}

/// `G^T lambda`, where G is the constraint Jacobian and lambda holds the multipliers.
pub fn constraint_forces(g: &Csr, multipliers: &[f64]) -> Vec<f64> {
    let mut forces = vec![0.0; g.cols()];
    for (r, lambda) in multipliers.iter().enumerate() {
        g.row(r).for_each(|(j, v)| forces[j] += v * lambda);
    }
    forces
}

//! The saddle equations `K u + C^T lambda = f`, `C u - lambda / D = b` of one part, and their inverse. The unknowns are u and then lambda;
//! `1 / D` is zero except for penalties.
//!
//! One matrix M contains elimination, multipliers and springs; `x = M^-1 r`:
//!
//! ```text
//! springs        K' = K + C_P^T D C_P                     equations with a penalty or augmented
//! elimination    u = L q + u_0, C_E u_0 = r_E             K_q = L^T K' L, f_q = L^T (r + C_P^T D r_P - K' u_0)
//! multipliers    [K_q C_q^T; C_q 0] [q; lambda_M] = [f_q; r_M - C_M u_0]
//! back           lambda_P = D (C_P u - r_P),  C_E^T lambda_E = r - K u - C_M^T lambda_M - C_P^T lambda_P
//! ```
//!
//! M is [`SaddleEquations`] up to rounding, and up to `1 / D` for augmented equations.

use std::borrow::Cow;

use super::condensation::Condensation;
use super::matrix::{
    ScaledFactor, add_sizes, add_sizes_transposed, add_transposed, bordered, entries, from_triplets, shifted,
};
use super::part::EnforcedPart;
use super::problem::Method;
use super::refinement::{MeasuredEquations, levelled};
use super::units::UnitGroups;
use super::{EnforceError, units};
use crate::common::{SparseMatrix, add_product, times};

/// The equations that all methods solve, with the sizes of their terms.
pub struct SaddleEquations<'a> {
    k: &'a SparseMatrix,
    c: SparseMatrix,
    /// `1 / D` of each equation.
    compliance: Vec<f64>,
    units: Vec<f64>,
    /// Groups of DOFs with comparable units.
    pub groups: UnitGroups,
    /// All unknowns belong to one part.
    parts: Vec<usize>,
}

impl<'a> SaddleEquations<'a> {
    pub fn new(part: &'a EnforcedPart<'_>) -> Result<Self, EnforceError> {
        let (n, m) = (part.dofs.len(), part.rows.len());
        let rows = (0..m).flat_map(|i| part.system.matrix().row(i).map(move |(j, v)| (i, j, v)));
        let (k, c) = (&part.k, from_triplets(m, n, rows)?);
        let units = units::units(k, &c);
        let groups = UnitGroups::new(k, &c);
        Ok(Self { k, c, compliance: vec![0.0; m], units, groups, parts: vec![0; n + m] })
    }

    /// Replaces the equations with a penalty by their springs.
    pub fn with_penalties(mut self, methods: &[Method], springs: &[f64]) -> Self {
        let penalty = |(method, d): (&Method, &f64)| {
            if matches!(method, Method::Penalty { .. }) && *d > 0.0 { d.recip() } else { 0.0 }
        };
        self.compliance = methods.iter().zip(springs).map(penalty).collect();
        self
    }

    /// `A x` without compliance: penalties count as exact equations.
    pub fn apply_exact(&self, x: &[f64]) -> Vec<f64> {
        self.apply(x).iter().zip(self.spring_displacements(x)).map(|(a, b)| a + b).collect()
    }

    /// `Z x`: the displacement of the springs, `lambda / D`; zero for DOFs.
    pub fn spring_displacements(&self, x: &[f64]) -> Vec<f64> {
        let of_springs = self.compliance.iter().zip(&x[self.dofs()..]).map(|(z, lambda)| z * lambda);
        vec![0.0; self.dofs()].into_iter().chain(of_springs).collect()
    }

    /// All entries of `[K C^T; C 0]`.
    pub fn entries(&self) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
        let n = self.dofs();
        entries(self.k).chain(entries(&self.c).flat_map(move |(i, j, v)| [(n + i, j, v), (j, n + i, v)]))
    }

    /// Which unknowns have a known unit; a multiplier has one if all DOFs of its equation have.
    fn known(&self) -> Vec<bool> {
        let n = self.dofs();
        let mut known: Vec<bool> = (0..n + self.c.nrows()).map(|j| j >= n || self.groups.is_known(j)).collect();
        entries(&self.c).filter(|&(_, j, _)| !self.groups.is_known(j)).for_each(|(i, ..)| known[n + i] = false);
        known
    }

    /// Whether there is any stiffness.
    pub fn is_stiff(&self) -> bool {
        self.k.val().iter().any(|v| *v != 0.0)
    }

    /// Number of unknowns that are DOFs.
    pub fn dofs(&self) -> usize {
        self.k.nrows()
    }
}

impl MeasuredEquations for SaddleEquations<'_> {
    fn apply(&self, x: &[f64]) -> Vec<f64> {
        let mut y = vec![0.0; x.len()];
        let (u, lambda) = x.split_at(self.dofs());
        let (forces, gaps) = y.split_at_mut(self.dofs());
        add_product(self.k, u, forces);
        add_transposed(&self.c, lambda, forces);
        add_product(&self.c, u, gaps);
        (0..gaps.len()).for_each(|i| gaps[i] -= self.compliance[i] * lambda[i]);
        y
    }

    fn size(&self, x: &[f64]) -> Vec<f64> {
        let mut y = vec![0.0; x.len()];
        let (u, lambda) = x.split_at(self.dofs());
        let (forces, gaps) = y.split_at_mut(self.dofs());
        add_sizes(self.k, u, forces);
        add_sizes_transposed(&self.c, lambda, forces);
        add_sizes(&self.c, u, gaps);
        (0..gaps.len()).for_each(|i| gaps[i] += (self.compliance[i] * lambda[i]).abs());
        y
    }

    fn units(&self) -> &[f64] {
        &self.units
    }

    fn parts(&self) -> &[usize] {
        &self.parts
    }

    fn levels(&self, x: &[f64], size: &[f64]) -> Vec<f64> {
        if !self.groups.are_many() {
            return levelled(self, x);
        }
        let known = self.known();
        let of_known: Vec<f64> = x.iter().zip(&known).map(|(x, known)| if *known { *x } else { 0.0 }).collect();
        let (mut levels, mut most) = (levelled(self, &of_known), vec![0.0_f64; x.len()]);
        for (i, j, v) in self.entries().filter(|&(_, j, v)| v != 0.0 && !known[j]) {
            most[j] = most[j].max(size[i] / v.abs());
        }
        let alone = (0..x.len()).filter(|&j| !known[j]);
        alone.for_each(|j| levels[j] = most[j]);
        levels
    }
}

/// Factors of M (see the module): springs are added to K, eliminated equations are condensed, and those with multipliers are a border.
pub struct SaddleInverse<'a> {
    part: &'a EnforcedPart<'a>,
    /// The stiffness D of the spring of each equation; 0 without a spring.
    pub springs: Vec<f64>,
    /// `K + C_P^T D C_P`.
    sum: Cow<'a, SparseMatrix>,
    eliminated: Vec<usize>,
    /// None if no equation is eliminated.
    condensation: Option<Condensation>,
    /// Number of unknown DOFs.
    unknowns: usize,
    /// Equations with a multiplier in the matrix: those with [`Method::Multiplier`], and those of components whose T would fill.
    border: Vec<usize>,
    multipliers: usize,
    factor: ScaledFactor,
}

impl<'a> SaddleInverse<'a> {
    /// `shift` is added to the diagonal of the unknown DOFs, in units of [`super::units`]; a positive one makes a singular matrix regular.
    pub fn new(
        part: &'a EnforcedPart<'a>,
        methods: &[Method],
        springs: Vec<f64>,
        shift: f64,
    ) -> Result<Self, EnforceError> {
        let of = |method: Method| (0..methods.len()).filter(move |&row| methods[row] == method);
        let eliminated: Vec<usize> = of(Method::Elimination).collect();
        let mut border: Vec<usize> = of(Method::Multiplier).collect();
        let sum = with_springs(part, &springs)?;
        let is_any = !eliminated.is_empty();
        let condensation = is_any.then(|| Condensation::new(&part.system, &eliminated, &sum)).transpose()?;
        let multipliers = border.len();
        border.extend(condensation.iter().flat_map(|condensation| &condensation.remaining));
        let k_q = match &condensation {
            None => Cow::Borrowed(&*sum),
            Some(condensation) => Cow::Owned(condensation.matrix(&sum)?),
        };
        let c_q = over_unknowns(part, condensation.as_ref(), &border)?;
        let (units, count) = (units::units(&k_q, &c_q), k_q.nrows());
        let definite = part.symmetric && border.is_empty();
        let matrix = if border.is_empty() { k_q } else { Cow::Owned(bordered(&k_q, &c_q)?) };
        let matrix = if shift > 0.0 { Cow::Owned(shifted(&matrix, &units, count, shift)?) } else { matrix };
        let factor = ScaledFactor::new(&matrix, units, definite)?;
        drop(matrix);
        Ok(Self { part, springs, sum, eliminated, condensation, unknowns: count, border, multipliers, factor })
    }

    /// `M^-1 r`.
    pub fn solve(&mut self, r: &[f64]) -> Result<Vec<f64>, EnforceError> {
        let n = self.part.dofs.len();
        let (forces, gaps) = r.split_at(n);
        let (mut rhs, constant) = self.condensed(forces, gaps)?;
        let moved = |row: usize| constant.as_ref().map_or(0.0, |constant| self.row_product(row, constant));
        rhs.extend(self.border.iter().map(|&row| gaps[row] - moved(row)));
        let x = self.factor.solve(&rhs)?;
        let (q, of_border) = x.split_at(self.unknowns);
        let u = self.condensation.as_ref().map_or_else(|| Ok(q.to_vec()), |condensation| condensation.expand(q))?;
        let lambda = self.multipliers(forces, gaps, &u, of_border)?;
        Ok([u, lambda].concat())
    }

    /// f_q, and u_0 if there is an elimination.
    fn condensed(&mut self, forces: &[f64], gaps: &[f64]) -> Result<(Vec<f64>, Option<Vec<f64>>), EnforceError> {
        let load = self.load_with_springs(forces, gaps);
        let Some(condensation) = &mut self.condensation else { return Ok((load, None)) };
        let of_eliminated: Vec<f64> = self.eliminated.iter().map(|&row| gaps[row]).collect();
        condensation.set(&of_eliminated)?;
        Ok((condensation.load(&self.sum, &load)?, Some(condensation.constant()?)))
    }

    /// `r + C_P^T D r_P`.
    fn load_with_springs(&self, forces: &[f64], gaps: &[f64]) -> Vec<f64> {
        let mut load = forces.to_vec();
        for (row, d) in self.springs_in_use() {
            self.part.system.matrix().row(row).for_each(|(j, v)| load[j] += v * d * gaps[row]);
        }
        load
    }

    fn multipliers(
        &self,
        forces: &[f64],
        gaps: &[f64],
        u: &[f64],
        of_border: &[f64],
    ) -> Result<Vec<f64>, EnforceError> {
        let mut lambda = vec![0.0; gaps.len()];
        self.border[..self.multipliers].iter().zip(of_border).for_each(|(&row, &value)| lambda[row] = value);
        self.springs_in_use().for_each(|(row, d)| lambda[row] = d * (self.row_product(row, u) - gaps[row]));
        let Some(condensation) = &self.condensation else { return Ok(lambda) };
        let stressed = times(&self.part.k, u);
        let mut rest: Vec<f64> = forces.iter().zip(stressed).map(|(force, stressed)| force - stressed).collect();
        for row in (0..gaps.len()).filter(|&row| lambda[row] != 0.0) {
            self.part.system.matrix().row(row).for_each(|(j, v)| rest[j] -= v * lambda[row]);
        }
        let carried = condensation.elimination.multipliers(&rest)?;
        self.eliminated.iter().zip(carried).for_each(|(&row, value)| lambda[row] = value);
        Ok(lambda)
    }

    fn springs_in_use(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.springs.iter().copied().enumerate().filter(|&(_, d)| d > 0.0)
    }

    /// `C_i u`.
    fn row_product(&self, row: usize, u: &[f64]) -> f64 {
        self.part.system.matrix().row(row).map(|(j, v)| v * u[j]).sum()
    }
}

/// `K + C_P^T D C_P`.
fn with_springs<'a>(part: &'a EnforcedPart<'a>, springs: &[f64]) -> Result<Cow<'a, SparseMatrix>, EnforceError> {
    if springs.iter().all(|d| *d == 0.0) {
        return Ok(Cow::Borrowed(&part.k));
    }
    let n = part.dofs.len();
    let of_row = |(row, &d): (usize, &f64)| {
        let row = part.system.matrix().row(row);
        row.clone().flat_map(move |(i, a)| row.clone().map(move |(j, b)| (i, j, d * a * b)))
    };
    let springs = springs.iter().enumerate().filter(|(_, d)| **d > 0.0).flat_map(of_row);
    from_triplets(n, n, entries(&part.k).chain(springs)).map(Cow::Owned)
}

/// Rows of C over the unknowns.
fn over_unknowns(
    part: &EnforcedPart,
    some: Option<&Condensation>,
    rows: &[usize],
) -> Result<SparseMatrix, EnforceError> {
    let mut triplets = Vec::new();
    for (i, &row) in rows.iter().enumerate() {
        let row = part.system.matrix().row(row);
        match some {
            None => triplets.extend(row.map(|(j, v)| (i, j, v))),
            Some(some) => {
                let (terms, _) = some.condensed.equation(&some.elimination, row, 0.0)?;
                triplets.extend(terms.into_iter().map(|(j, v)| (i, j, v)));
            }
        }
    }
    let unknowns = some.map_or(part.dofs.len(), |some| some.condensed.unknowns());
    from_triplets(rows.len(), unknowns, triplets)
}

/// `D_i = factor k_i / |C_i|^2` of each equation with a spring, zero for others. `k_i` is the largest diagonal entry of K on the free DOFs
/// of the equation, or the largest entry of the part if these have none. D has the units of the equation; the factor is dimensionless. If
/// the part has no stiffness at all, D is zero and the equation is satisfied exactly.
pub fn spring_stiffness(part: &EnforcedPart, methods: &[Method]) -> Result<Vec<f64>, EnforceError> {
    let mut diagonal = vec![0.0_f64; part.dofs.len()];
    entries(&part.k).filter(|&(i, j, _)| i == j).for_each(|(i, _, v)| diagonal[i] += v.abs());
    let largest = entries(&part.k).fold(0.0, |most: f64, (_, _, v)| most.max(v.abs()));
    let of_row = |(row, method): (usize, &Method)| {
        let Some(factor) = method.factor() else { return Ok(0.0) };
        let (mut near, mut square) = (0.0_f64, 0.0);
        for (j, v) in part.system.matrix().row(row) {
            near = near.max(diagonal[j]);
            square += v * v;
        }
        let spring = factor * if near > 0.0 { near } else { largest } / square;
        let is_usable = largest == 0.0 || (spring > 0.0 && spring.is_finite());
        if is_usable { Ok(spring) } else { Err(EnforceError::Factor(factor)) }
    };
    methods.iter().enumerate().map(of_row).collect()
}

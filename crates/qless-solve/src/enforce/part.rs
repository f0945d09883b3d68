//! One connected part of K and C: its free DOFs and its equations, in dimensionless numbers.
//!
//! ```text
//! K' = S K S    C' = R C S    u = 2^t S u'    lambda = 2^t R lambda'        S, R of super::scale; whole number t
//! ```
//!
//! Prescribed DOFs are moved to the right-hand side, `f - K u_p` and `b - C u_p`. Cost: two copies of K and C.

use qless::{ConstraintSystem, SystemBuilder};

use super::EnforceError;
use super::equations::{BALANCED, ROUNDING};
use super::matrix::{entries, from_triplets};
use super::problem::{Method, Problem, Solution};
use super::scale::{Entry, parts, power, scales, times_power};
use crate::common::SparseMatrix;

/// One connected part, dimensionless.
pub struct EnforcedPart<'a> {
    /// The constraint system of the whole model.
    whole: &'a ConstraintSystem,
    /// Free DOFs and then equations of the part in the numbering of the caller, ascending.
    pub dofs: Vec<usize>,
    pub rows: Vec<usize>,
    pub k: SparseMatrix,
    pub symmetric: bool,
    /// The equations C of the part; their right-hand sides are in `rhs`.
    pub system: ConstraintSystem,
    /// The right-hand sides `f - K u_p` and then `b - C u_p`, where u_p are prescribed values; and the sizes of their terms.
    pub rhs: (Vec<f64>, Vec<f64>),
    /// How each equation is enforced.
    pub methods: Vec<Method>,
    /// The relative error of u that penalties may cause.
    pub accuracy: f64,
    /// The largest residual of augmented equations, relative to their terms.
    pub tolerance: f64,
    /// Exponents of the scales of the DOFs, then of the equations.
    pub scale: Vec<i32>,
    /// Exponent t of the size of the solution: u and lambda of the caller are `2^t` times the scaled ones.
    size: i32,
}

impl EnforcedPart<'_> {
    /// The name of a row in messages.
    pub fn name(&self, row: usize) -> String {
        match row.checked_sub(self.dofs.len()) {
            None => format!("the forces on DOF {}", self.dofs[row]),
            Some(row) => self.whole.equation_label(self.rows[row]),
        }
    }

    /// All entries of the constraint matrix C of the part.
    pub fn equations(&self) -> impl Iterator<Item = Entry> + '_ {
        (0..self.rows.len()).flat_map(|i| self.system.matrix().row(i).map(move |(j, v)| (i, j, v)))
    }

    /// Writes u, lambda and `-C^T lambda` of the part in the caller's units. Forces are computed here, since lambda alone may leave the
    /// range of doubles.
    pub fn place(&self, x: &[f64], solution: &mut Solution) {
        let (n, mut forces) = (self.dofs.len(), vec![0.0; self.dofs.len()]);
        self.equations().for_each(|(i, j, v)| forces[j] -= v * x[n + i]);
        for (j, &dof) in self.dofs.iter().enumerate() {
            solution.u[dof] = times_power(x[j], self.scale[j] + self.size);
            solution.forces[dof] = times_power(forces[j], self.size - self.scale[j]);
        }
        let of_rows = self.rows.iter().zip(&x[n..]).zip(&self.scale[n..]);
        of_rows.for_each(|((&row, x), e)| solution.multipliers[row] = times_power(*x, e + self.size));
    }
}

/// Free DOFs and equations of a part, ascending, and their terms in the caller's units with indices within the part.
#[derive(Default)]
pub struct PartTerms {
    dofs: Vec<usize>,
    rows: Vec<usize>,
    k: Vec<Entry>,
    c: Vec<Entry>,
    /// Coefficients of prescribed DOFs with their values: `(row, coefficient, value)`; rows of C follow those of K.
    moved: Vec<(usize, f64, f64)>,
}

/// The connected parts of a problem, by nonzero entries of K and C, in the order of their first DOFs.
pub fn split(problem: &Problem) -> Vec<PartTerms> {
    let (system, n) = (problem.system, problem.system.dofs());
    let mut prescribed = vec![None; n];
    system.prescribed().iter().for_each(|&(j, value)| prescribed[j] = Some(value));
    let row = |&row: &usize| system.matrix().row(row).map(move |(j, v)| (n + row, j, v));
    let of_k = || entries(&problem.k).filter(|&(i, ..)| prescribed[i].is_none());
    let terms = || of_k().chain(problem.kept.iter().flat_map(row)).filter(|&(_, _, v)| v != 0.0);
    let joins = terms().filter(|&(_, j, _)| prescribed[j].is_none()).map(|(i, j, _)| (i, j));
    let names = parts(n + system.equations(), joins);
    let (mut part_of, mut place, mut all) = (vec![None; names.len()], vec![0; names.len()], Vec::<PartTerms>::new());
    let free = (0..n).filter(|&j| prescribed[j].is_none());
    for member in free.chain(problem.kept.iter().map(|row| n + row)) {
        let part = *part_of[names[member]].get_or_insert(all.len());
        if part == all.len() {
            all.push(PartTerms::default());
        }
        let members = if member < n { &mut all[part].dofs } else { &mut all[part].rows };
        place[member] = members.len();
        members.push(if member < n { member } else { member - n });
    }
    for (i, j, v) in terms() {
        let Some(part) = part_of[names[i]].map(|part: usize| &mut all[part]) else { continue };
        match prescribed[j] {
            Some(value) => part.moved.push((place[i] + if i < n { 0 } else { part.dofs.len() }, v, value)),
            None if i < n => part.k.push((place[i], place[j], v)),
            None => part.c.push((place[i], place[j], v)),
        }
    }
    all
}

impl PartTerms {
    /// Converts the part to dimensionless numbers.
    pub fn scaled<'a>(
        self,
        problem: &'a Problem,
        methods: &[Method],
        accuracy: f64,
    ) -> Result<EnforcedPart<'a>, EnforceError> {
        let Self { dofs, rows, k, c, moved } = self;
        let (n, m) = (dofs.len(), rows.len());
        let scale = scales(k.iter().copied(), c.iter().copied(), (n, m));
        let k = from_triplets(n, n, k.into_iter().map(|(i, j, v)| (i, j, times_power(v, scale[i] + scale[j]))))?;
        let mut equations = vec![Vec::new(); m];
        c.into_iter().for_each(|(i, j, v)| equations[i].push((j, times_power(v, scale[n + i] + scale[j]))));
        let mut builder = SystemBuilder::new(n);
        equations.into_iter().for_each(|terms| _ = builder.equation(terms, 0.0));
        let own = dofs.iter().map(|&j| problem.f[j]).chain(rows.iter().map(|&row| problem.system.rhs()[row]));
        let mut sums: Vec<f64> = own.zip(&scale).map(|(v, e)| times_power(v, *e)).collect();
        let mut sizes: Vec<f64> = sums.iter().map(|v| v.abs()).collect();
        for (i, v, value) in moved {
            let term = times_power(v, scale[i]) * value;
            (sums[i], sizes[i]) = (sums[i] - term, sizes[i] + term.abs());
        }
        if !sizes.iter().all(|v| v.is_finite()) {
            return Err(EnforceError::OutOfRange);
        }
        let size = middle(&sizes);
        sums.iter_mut().chain(&mut sizes).for_each(|v| *v = times_power(*v, -size));
        Ok(EnforcedPart {
            whole: problem.system,
            symmetric: problem.declared || is_symmetric(&k),
            k,
            system: builder.build()?,
            rhs: (sums, sizes),
            methods: rows.iter().map(|&row| methods[row]).collect(),
            dofs,
            rows,
            accuracy,
            tolerance: accuracy.min(BALANCED),
            scale,
            size,
        })
    }
}

/// Whether the scaled K is symmetric up to rounding. Each difference `K_ij - K_ji` is compared with the entry, or with 1, the size of the
/// scaled diagonal, if that is larger.
fn is_symmetric(k: &SparseMatrix) -> bool {
    let off = |i: usize, j: usize, v: f64| (v - k.get(j, i).copied().unwrap_or_default()).abs();
    entries(k).all(|(i, j, v)| off(i, j, v) <= ROUNDING * v.abs().max(1.0))
}

/// The exponent half way between those of the smallest and the largest nonzero number; 0 without any.
fn middle(values: &[f64]) -> i32 {
    let powers = || values.iter().filter(|v| **v != 0.0).map(|v| power(*v));
    powers().min().zip(powers().max()).map_or(0, |(least, most)| (least + most).div_euclid(2))
}

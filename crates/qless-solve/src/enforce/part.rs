//! One connected part of K and C: its free DOFs and its equations, in dimensionless numbers.
//!
//! ```text
//! K' = S K S    C' = R C S    u = 2^t S u'    lambda = 2^t R lambda'        S, R of super::scale; whole number t
//! ```
//!
//! Prescribed DOFs are moved to the right-hand side, `f - K u_p` and `b - C u_p`. Cost: one copy of K and C.

use qless::{ConstraintSystem, SystemBuilder};

use super::EnforceError;
use super::equations::{BALANCED, ROUNDING};
use super::matrix::{entries, from_triplets};
use super::problem::{Method, Problem, Solution};
use super::scale::{Entry, parts, power, scales, times_power};
use crate::common::SparseMatrix;

/// One connected part, dimensionless.
pub struct EnforcedPart<'a> {
    /// The constraint system that it is part of.
    whole: &'a ConstraintSystem,
    /// Its free DOFs and its equations in the numbering of the caller, ascending.
    pub dofs: Vec<usize>,
    pub rows: Vec<usize>,
    pub k: SparseMatrix,
    pub symmetric: bool,
    /// C of the part; its right-hand sides are in `rhs`.
    pub system: ConstraintSystem,
    /// `f - K u_p`, then `b - C u_p`; and the sizes of their terms.
    pub rhs: (Vec<f64>, Vec<f64>),
    /// How each equation is enforced.
    pub methods: Vec<Method>,
    /// The relative error of u that penalties may cause.
    pub accuracy: f64,
    /// The largest residual of augmented equations, relative to their terms.
    pub tolerance: f64,
    /// The exponents of S, then those of R.
    pub scale: Vec<i32>,
    /// t.
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

    /// All entries of C.
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

/// Splits a problem into its connected parts.
pub struct PartSplitter<'a> {
    problem: &'a Problem<'a>,
    /// Free DOFs and equations of each part, ascending; in the order of their first DOFs.
    members: Vec<(Vec<usize>, Vec<usize>)>,
    /// The index of each DOF within its part; none if it is prescribed.
    place: Vec<Option<u32>>,
    /// Values of prescribed DOFs; zero for others.
    prescribed: Vec<f64>,
    /// Entries of K in rows of free DOFs and columns of prescribed ones, ascending.
    prescribed_columns: Vec<Entry>,
}

impl<'a> PartSplitter<'a> {
    pub fn new(problem: &'a Problem<'a>) -> Self {
        let n = problem.system.dofs();
        let (mut prescribed, mut free) = (vec![0.0; n], vec![true; n]);
        problem.system.prescribed().iter().for_each(|&(j, value)| (prescribed[j], free[j]) = (value, false));
        let joins = |&(i, j, v): &Entry| v != 0.0 && free[i] && !free[j];
        let mut prescribed_columns: Vec<_> = entries(&problem.k).filter(joins).collect();
        prescribed_columns.sort_by_key(|&(i, j, _)| (i, j));
        let (members, mut place) = (members(problem, &free), vec![None; n]);
        for (dofs, _) in &members {
            dofs.iter().enumerate().for_each(|(at, &j)| place[j] = Some(at as u32));
        }
        Self { problem, members, place, prescribed, prescribed_columns }
    }

    /// All parts, one after the other.
    pub fn parts(
        &self,
        methods: &[Method],
        accuracy: f64,
    ) -> impl Iterator<Item = Result<EnforcedPart<'a>, EnforceError>> {
        self.members.iter().map(move |(dofs, rows)| self.part((dofs, rows), methods, accuracy))
    }

    fn part(
        &self,
        (dofs, rows): (&[usize], &[usize]),
        methods: &[Method],
        accuracy: f64,
    ) -> Result<EnforcedPart<'a>, EnforceError> {
        let (n, m) = (dofs.len(), rows.len());
        let own = || dofs.iter().flat_map(|&j| self.column(j));
        let of_rows = || rows.iter().enumerate().flat_map(|(i, &row)| self.row(row).map(move |(j, v)| (i, j, v)));
        let scale = scales(own(), of_rows(), (n, m));
        let k = from_triplets(n, n, own().map(|(i, j, v)| (i, j, times_power(v, scale[i] + scale[j]))))?;
        let mut builder = SystemBuilder::new(n);
        for (i, &row) in rows.iter().enumerate() {
            builder.equation(self.row(row).map(|(j, v)| (j, times_power(v, scale[n + i] + scale[j]))), 0.0);
        }
        let (mut sums, mut sizes) = self.right_hand_side(dofs, rows, &scale);
        if !sizes.iter().all(|v| v.is_finite()) {
            return Err(EnforceError::OutOfRange);
        }
        let size = middle(&sizes);
        sums.iter_mut().chain(&mut sizes).for_each(|v| *v = times_power(*v, -size));
        Ok(EnforcedPart {
            whole: self.problem.system,
            dofs: dofs.to_vec(),
            rows: rows.to_vec(),
            symmetric: self.problem.declared || is_symmetric(&k),
            k,
            system: builder.build()?,
            rhs: (sums, sizes),
            methods: rows.iter().map(|&row| methods[row]).collect(),
            accuracy,
            tolerance: accuracy.min(BALANCED),
            scale,
            size,
        })
    }

    /// `f - K u_p` and `b - C u_p`, and the sizes of their terms.
    fn right_hand_side(&self, dofs: &[usize], rows: &[usize], scale: &[i32]) -> (Vec<f64>, Vec<f64>) {
        let (of_dofs, of_rows) = scale.split_at(dofs.len());
        let moved = |(j, v, e): (usize, f64, i32)| times_power(-v, e) * self.prescribed[j];
        let sum = |start: f64, terms: &mut dyn Iterator<Item = f64>| {
            terms.fold((start, start.abs()), |(sum, size), v| (sum + v, size + v.abs()))
        };
        let forces = dofs.iter().zip(of_dofs).map(|(&i, &e)| {
            let first = self.prescribed_columns.partition_point(|&(row, _, _)| row < i);
            let of_row = self.prescribed_columns[first..].iter().take_while(|&&(row, _, _)| row == i);
            sum(times_power(self.problem.f[i], e), &mut of_row.map(|&(_, j, v)| moved((j, v, e))))
        });
        let equations = rows.iter().zip(of_rows).map(|(&row, &e)| {
            let whole = self.problem.system.matrix().row(row).filter(|&(j, _)| self.place[j].is_none());
            sum(times_power(self.problem.system.rhs()[row], e), &mut whole.map(|(j, v)| moved((j, v, e))))
        });
        forces.chain(equations).unzip()
    }

    /// A column of K on free DOFs, with indices within its part.
    fn column(&self, j: usize) -> impl Iterator<Item = Entry> + '_ {
        let (k, at): (&SparseMatrix, _) = (&self.problem.k, self.place[j]);
        let column = k.symbolic().row_idx_of_col(j).zip(k.val_of_col(j)).filter(|(_, v)| **v != 0.0);
        column.filter_map(move |(i, &v)| Some((self.place[i]? as usize, at? as usize, v)))
    }

    /// A row of C on free DOFs, with indices within its part.
    fn row(&self, row: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let row = self.problem.system.matrix().row(row).filter(|(_, v)| *v != 0.0);
        row.filter_map(|(j, v)| Some((self.place[j]? as usize, v)))
    }
}

/// Connected components of free DOFs and equations, by nonzero entries of K and C.
fn members(problem: &Problem, free: &[bool]) -> Vec<(Vec<usize>, Vec<usize>)> {
    let (n, m) = (problem.system.dofs(), problem.system.equations());
    let of_k = entries(&problem.k).filter(|&(i, j, v)| v != 0.0 && free[i] && free[j]).map(|(i, j, _)| (i, j));
    let row = |&row: &usize| problem.system.matrix().row(row).map(move |(j, v)| (n + row, j, v));
    let of_c = problem.kept.iter().flat_map(row).filter(|&(_, j, v)| v != 0.0 && free[j]).map(|(row, j, _)| (row, j));
    let names = parts(n + m, of_k.chain(of_c));
    let (mut index, mut members) = (vec![None; n + m], Vec::<(Vec<usize>, Vec<usize>)>::new());
    let dofs = (0..n).filter(|&j| free[j]);
    for member in dofs.chain(problem.kept.iter().map(|row| n + row)) {
        let part = *index[names[member]].get_or_insert(members.len());
        if part == members.len() {
            members.push(Default::default());
        }
        let (dofs, rows) = &mut members[part];
        if member < n { dofs.push(member) } else { rows.push(member - n) }
    }
    members
}

/// Whether `K_ij - K_ji` is rounding of the entry or of the diagonal, which is one.
fn is_symmetric(k: &SparseMatrix) -> bool {
    let off = |i: usize, j: usize, v: f64| (v - k.get(j, i).copied().unwrap_or_default()).abs();
    entries(k).all(|(i, j, v)| off(i, j, v) <= ROUNDING * v.abs().max(1.0))
}

/// The exponent half way between those of the smallest and the largest nonzero number; 0 without any.
fn middle(values: &[f64]) -> i32 {
    let powers = || values.iter().filter(|v| **v != 0.0).map(|v| power(*v));
    powers().min().zip(powers().max()).map_or(0, |(least, most)| (least + most).div_euclid(2))
}

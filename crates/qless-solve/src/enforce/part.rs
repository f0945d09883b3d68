//! One connected part of K and C: its free DOFs and its equations, scaled by powers of two.
//!
//! ```text
//! K' = K / 4^k    C_r' = C_r / 2^e_r    u' = u / 2^t    lambda_r' = lambda_r 2^e_r / (4^k 2^t)    whole numbers k, e_r, t
//! ```
//!
//! Prescribed DOFs are moved to the right-hand side, `f - K u_p` and `b - C u_p`. The powers of two bring the numbers of the part near one,
//! so that products do not leave the range of doubles; they change no digit. Cost: one copy of K and C.

use qless::{ConstraintSystem, SystemBuilder};

use super::matrix::{entries, from_triplets};
use super::problem::{Method, Problem, Solution};
use super::{EnforceError, stiffness, units};
use crate::common::SparseMatrix;

/// One connected part, in its own scale.
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
    /// Exponents of the powers of two that were divided out: of K, of each equation, of u.
    stiffness: i32,
    equations: Vec<i32>,
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

    /// Writes u, lambda and `-C^T lambda` of the part in the caller's scale. Forces are computed here, since lambda alone may leave the
    /// range of doubles.
    pub fn place(&self, x: &[f64], solution: &mut Solution) {
        let (of_dofs, of_rows) = x.split_at(self.dofs.len());
        self.dofs.iter().zip(of_dofs).for_each(|(&j, x)| solution.u[j] = times_power(*x, self.size));
        let force = self.stiffness + self.size;
        for ((&row, x), power) in self.rows.iter().zip(of_rows).zip(&self.equations) {
            solution.multipliers[row] = times_power(*x, force - power);
            let terms = self.whole.matrix().row(row).map(|(j, v)| (j, times_power(v, -power) * x));
            terms.for_each(|(j, v)| solution.forces[j] -= times_power(v, force));
        }
    }
}

/// Free DOFs and equations of a part, ascending.
type PartMembers = (Vec<usize>, Vec<usize>);

/// Splits a problem into its connected parts.
pub struct PartSplitter<'a> {
    problem: &'a Problem<'a>,
    /// In the order of their first DOFs.
    members: Vec<PartMembers>,
    /// The index of each DOF within its part; none if it is prescribed.
    place: Vec<Option<u32>>,
    /// Values of prescribed DOFs; zero for others.
    prescribed: Vec<f64>,
    /// Entries of K in rows of free DOFs and columns of prescribed ones: `(row, column, value)`, ascending.
    prescribed_columns: Vec<(usize, usize, f64)>,
}

impl<'a> PartSplitter<'a> {
    pub fn new(problem: &'a Problem<'a>) -> Self {
        let n = problem.system.dofs();
        let (mut prescribed, mut free) = (vec![0.0; n], vec![true; n]);
        problem.system.prescribed().iter().for_each(|&(j, value)| (prescribed[j], free[j]) = (value, false));
        let joins = |&(i, j, v): &(usize, usize, f64)| v != 0.0 && free[i] && !free[j];
        let mut prescribed_columns: Vec<_> = entries(&problem.k).filter(joins).collect();
        prescribed_columns.sort_by_key(|&(i, j, _)| (i, j));
        let (members, mut place) = (members(problem, &free), vec![None; n]);
        for (dofs, _) in &members {
            dofs.iter().enumerate().for_each(|(at, &j)| place[j] = Some(at as u32));
        }
        Self { problem, members, place, prescribed, prescribed_columns }
    }

    /// All parts, one after the other.
    pub fn parts(&self, methods: &[Method]) -> impl Iterator<Item = Result<EnforcedPart<'a>, EnforceError>> {
        self.members.iter().map(|(dofs, rows)| self.part(dofs, rows, methods))
    }

    fn part(&self, dofs: &[usize], rows: &[usize], methods: &[Method]) -> Result<EnforcedPart<'a>, EnforceError> {
        let own = || dofs.iter().flat_map(|&j| self.column(j));
        // An even exponent: the square root of the scale is a power of two as well, so that units keep their digits.
        let stiffness = 2 * middle(own().map(|(_, _, v)| v)).div_euclid(2);
        let scaled = own().map(|(i, j, v)| (i, j, times_power(v, -stiffness)));
        let k = from_triplets(dofs.len(), dofs.len(), scaled)?;
        let largest = |row: usize| self.row(row).fold(0.0, |most: f64, (_, v)| most.max(v.abs()));
        let equations: Vec<i32> = rows.iter().map(|&row| power(largest(row))).collect();
        let mut builder = SystemBuilder::new(dofs.len());
        for (&row, &power) in rows.iter().zip(&equations) {
            builder.equation(self.row(row).map(|(j, v)| (j, times_power(v, -power))), 0.0);
        }
        let (mut sums, mut sizes) = self.right_hand_side(dofs, rows, stiffness, &equations);
        if !sizes.iter().all(|v| v.is_finite()) {
            return Err(EnforceError::OutOfRange);
        }
        let size = middle(sizes.iter().copied());
        sums.iter_mut().chain(&mut sizes).for_each(|v| *v = times_power(*v, -size));
        let symmetric = self.problem.declared || stiffness::is_symmetric(&k);
        let methods = rows.iter().map(|&row| methods[row]).collect();
        let (dofs, rows, system) = (dofs.to_vec(), rows.to_vec(), builder.build()?);
        let whole = self.problem.system;
        Ok(EnforcedPart {
            whole,
            dofs,
            rows,
            k,
            symmetric,
            system,
            rhs: (sums, sizes),
            methods,
            stiffness,
            equations,
            size,
        })
    }

    /// `f - K u_p` and `b - C u_p`, and the sizes of their terms.
    fn right_hand_side(&self, dofs: &[usize], rows: &[usize], k: i32, equations: &[i32]) -> (Vec<f64>, Vec<f64>) {
        let (mut sums, mut sizes) = (Vec::new(), Vec::new());
        let mut add = |terms: &mut dyn Iterator<Item = f64>| {
            let (mut sum, mut size) = (0.0, 0.0);
            terms.for_each(|v| (sum, size) = (sum + v, size + v.abs()));
            sums.push(sum);
            sizes.push(size);
        };
        for &i in dofs {
            let first = self.prescribed_columns.partition_point(|&(row, _, _)| row < i);
            let of_row = self.prescribed_columns[first..].iter().take_while(|&&(row, _, _)| row == i);
            let prescribed = of_row.map(|&(_, j, v)| times_power(-v, -k) * self.prescribed[j]);
            add(&mut std::iter::once(times_power(self.problem.f[i], -k)).chain(prescribed));
        }
        for (&row, &power) in rows.iter().zip(equations) {
            let whole = self.problem.system.matrix().row(row).filter(|&(j, _)| self.place[j].is_none());
            let prescribed = whole.map(|(j, v)| times_power(-v, -power) * self.prescribed[j]);
            add(&mut std::iter::once(times_power(self.problem.system.rhs()[row], -power)).chain(prescribed));
        }
        (sums, sizes)
    }

    /// A column of K on free DOFs, with indices within its part.
    fn column(&self, j: usize) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
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
fn members(problem: &Problem, free: &[bool]) -> Vec<PartMembers> {
    let (n, m) = (problem.system.dofs(), problem.system.equations());
    let of_k = entries(&problem.k).filter(|&(i, j, v)| v != 0.0 && free[i] && free[j]).map(|(i, j, _)| (i, j));
    let row = |&row: &usize| problem.system.matrix().row(row).map(move |(j, v)| (n + row, j, v));
    let of_c = problem.kept.iter().flat_map(row).filter(|&(_, j, v)| v != 0.0 && free[j]).map(|(row, j, _)| (row, j));
    let names = units::parts(n + m, of_k.chain(of_c));
    let (mut index, mut members) = (vec![None; n + m], Vec::<PartMembers>::new());
    let dofs = (0..n).filter(|&j| free[j]);
    for member in dofs.chain(problem.kept.iter().map(|row| n + row)) {
        let part = *index[names[member]].get_or_insert(members.len());
        if part == members.len() {
            members.push(PartMembers::default());
        }
        let (dofs, rows) = &mut members[part];
        if member < n { dofs.push(member) } else { rows.push(member - n) }
    }
    members
}

/// The exponent half way between those of the smallest and the largest nonzero number; 0 without any.
pub fn middle(values: impl Iterator<Item = f64>) -> i32 {
    let powers = values.filter(|v| *v != 0.0).map(power);
    let ends = powers.fold(None, |ends: Option<(i32, i32)>, e| match ends {
        None => Some((e, e)),
        Some((least, most)) => Some((least.min(e), most.max(e))),
    });
    ends.map_or(0, |(least, most)| (least + most).div_euclid(2))
}

/// e with `2^e <= |v| < 2^(e + 1)`, except for rounding of log2; 0 for zero.
pub fn power(v: f64) -> i32 {
    if v == 0.0 { 0 } else { v.abs().log2().floor() as i32 }
}

/// `v 2^e`, in two steps, since 2^e may leave the range of doubles.
pub fn times_power(v: f64, e: i32) -> f64 {
    let half = e.div_euclid(2);
    v * f64::from(half).exp2() * f64::from(e - half).exp2()
}

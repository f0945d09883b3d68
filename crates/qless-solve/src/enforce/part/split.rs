//! The parts of a model: DOFs and equations that entries of K and C join.

use qless::SystemBuilder;

use super::Part;
use super::powers::{middle, power, times_power};
use crate::enforce::EnforceError;
use crate::enforce::matrix::{Matrix, entries, from_triplets};
use crate::enforce::method::Method;
use crate::enforce::problem::Problem;
use crate::enforce::{scale, stiffness};

/// DOFs and equations of a part, ascending.
type Members = (Vec<usize>, Vec<usize>);

/// The free DOFs and the equations of each part, and what is prescribed.
pub struct Split<'a> {
    problem: &'a Problem<'a>,
    /// By their first DOF.
    members: Vec<Members>,
    /// The place of each DOF in its part; none where it is prescribed.
    place: Vec<Option<u32>>,
    /// Values of prescribed DOFs; zero for others.
    given: Vec<f64>,
    /// K by the rows of free DOFs and the columns of prescribed ones: `(row, column, value)`, ascending.
    of_given: Vec<(usize, usize, f64)>,
}

impl<'a> Split<'a> {
    pub fn new(problem: &'a Problem<'a>) -> Self {
        let n = problem.system.dofs();
        let (mut given, mut free) = (vec![0.0; n], vec![true; n]);
        problem.system.prescribed().iter().for_each(|&(j, value)| (given[j], free[j]) = (value, false));
        let joins = |&(i, j, v): &(usize, usize, f64)| v != 0.0 && free[i] && !free[j];
        let mut of_given: Vec<_> = entries(&problem.k).filter(joins).collect();
        of_given.sort_by_key(|&(i, j, _)| (i, j));
        let (members, mut place) = (members(problem, &free), vec![None; n]);
        for (dofs, _) in &members {
            dofs.iter().enumerate().for_each(|(at, &j)| place[j] = Some(at as u32));
        }
        Self { problem, members, place, given, of_given }
    }

    /// The parts, one after the other.
    pub fn parts(&self, methods: &[Method]) -> impl Iterator<Item = Result<Part<'a>, EnforceError>> {
        self.members.iter().map(|(dofs, rows)| self.part(dofs, rows, methods))
    }

    fn part(&self, dofs: &[usize], rows: &[usize], methods: &[Method]) -> Result<Part<'a>, EnforceError> {
        let own = || dofs.iter().flat_map(|&j| self.column(j));
        // The root of a power of four is a power of two: units have the same digits.
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
        Ok(Part { whole, dofs, rows, k, symmetric, system, rhs: (sums, sizes), methods, stiffness, equations, size })
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
            let first = self.of_given.partition_point(|&(row, _, _)| row < i);
            let of_row = self.of_given[first..].iter().take_while(|&&(row, _, _)| row == i);
            let given = of_row.map(|&(_, j, v)| times_power(-v, -k) * self.given[j]);
            add(&mut std::iter::once(times_power(self.problem.f[i], -k)).chain(given));
        }
        for (&row, &power) in rows.iter().zip(equations) {
            let whole = self.problem.system.matrix().row(row).filter(|&(j, _)| self.place[j].is_none());
            let given = whole.map(|(j, v)| times_power(-v, -power) * self.given[j]);
            add(&mut std::iter::once(times_power(self.problem.system.rhs()[row], -power)).chain(given));
        }
        (sums, sizes)
    }

    /// A column of K on free DOFs, in places of its part.
    fn column(&self, j: usize) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
        let (k, at): (&Matrix, _) = (&self.problem.k, self.place[j]);
        let column = k.symbolic().row_idx_of_col(j).zip(k.val_of_col(j)).filter(|(_, v)| **v != 0.0);
        column.filter_map(move |(i, &v)| Some((self.place[i]? as usize, at? as usize, v)))
    }

    /// A row of C on free DOFs, in places of its part.
    fn row(&self, row: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let row = self.problem.system.matrix().row(row).filter(|(_, v)| *v != 0.0);
        row.filter_map(|(j, v)| Some((self.place[j]? as usize, v)))
    }
}

/// What entries that are not zero join: of K on free DOFs, and of equations.
fn members(problem: &Problem, free: &[bool]) -> Vec<Members> {
    let (n, m) = (problem.system.dofs(), problem.system.equations());
    let of_k = entries(&problem.k).filter(|&(i, j, v)| v != 0.0 && free[i] && free[j]).map(|(i, j, _)| (i, j));
    let row = |&row: &usize| problem.system.matrix().row(row).map(move |(j, v)| (n + row, j, v));
    let of_c = problem.kept.iter().flat_map(row).filter(|&(_, j, v)| v != 0.0 && free[j]).map(|(row, j, _)| (row, j));
    let names = scale::parts(n + m, of_k.chain(of_c));
    let (mut index, mut members) = (vec![None; n + m], Vec::<Members>::new());
    let dofs = (0..n).filter(|&j| free[j]);
    for member in dofs.chain(problem.kept.iter().map(|row| n + row)) {
        let part = *index[names[member]].get_or_insert(members.len());
        if part == members.len() {
            members.push(Members::default());
        }
        let (dofs, rows) = &mut members[part];
        if member < n { dofs.push(member) } else { rows.push(member - n) }
    }
    members
}

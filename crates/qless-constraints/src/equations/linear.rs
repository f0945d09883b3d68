//! All linear equations of a set, `c = G u - b`, in the order of their constraints: the rows of G, which do not depend on u, and b.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::ops::Range;

use crate::equations::dof_uses::bound;
use crate::equations::{EquationNames, EquationOwner, LinearRhs, TimeFunction};
use crate::scalar::Bounded;

/// Pairs `(DOF, coefficient)`, DOFs ascending.
pub type LinearTerms = Vec<(u32, f64)>;

/// A linear equation outside of the set: `sum a_j u_j = rhs`.
pub struct StagedEquation {
    pub name: Cow<'static, str>,
    pub terms: LinearTerms,
    pub rhs: LinearRhs,
}

/// Linear equations of all types.
pub struct LinearEquations {
    pub owners: Vec<EquationOwner>,
    /// b, at the time of the set.
    rhs: Vec<f64>,
    /// Index of the first entry of each row, and at the end the number of entries.
    pub start: Vec<usize>,
    pub col: Vec<u32>,
    pub val: Vec<f64>,
    /// Right-hand sides that are functions of time. Key: constraint, and index among its linear equations.
    driven: BTreeMap<(u32, u32), TimeFunction>,
}

impl Default for LinearEquations {
    fn default() -> Self {
        let (owners, rhs, driven) = (Vec::new(), Vec::new(), BTreeMap::new());
        Self { owners, rhs, start: vec![0], col: Vec::new(), val: Vec::new(), driven }
    }
}

impl LinearEquations {
    pub fn rows(&self) -> usize {
        self.owners.len()
    }

    /// Frees memory that was reserved for more equations.
    pub fn shrink(&mut self) {
        self.owners.shrink_to_fit();
        self.rhs.shrink_to_fit();
        self.start.shrink_to_fit();
        self.col.shrink_to_fit();
        self.val.shrink_to_fit();
    }

    /// The rows of a constraint.
    pub fn rows_of(&self, constraint: u32) -> Range<usize> {
        let first_from = |constraint| self.owners.partition_point(|owner| owner.constraint < constraint);
        first_from(constraint)..first_from(constraint + 1)
    }

    fn terms(&self, row: usize) -> impl Iterator<Item = (u32, f64)> + '_ {
        let entries = self.start[row]..self.start[row + 1];
        self.col[entries.clone()].iter().copied().zip(self.val[entries].iter().copied())
    }

    /// Adds the equations of a constraint that has none, and empties the list.
    pub fn put(&mut self, constraint: u32, equations: &mut Vec<StagedEquation>, names: &mut EquationNames, time: f64) {
        let row = self.rows_of(constraint).start;
        let (first, mut last) = (self.start[row], self.start[row]);
        let (mut col, mut val, mut ends, mut owners, mut rhs) =
            (Vec::new(), Vec::new(), Vec::new(), Vec::new(), Vec::new());
        for (k, equation) in (0..).zip(equations.drain(..)) {
            col.extend(equation.terms.iter().map(|&(j, _)| j));
            val.extend(equation.terms.iter().map(|&(_, v)| v));
            last += equation.terms.len();
            ends.push(last);
            owners.push(EquationOwner { constraint, name: names.place(equation.name) });
            rhs.push(equation.rhs.at(time));
            self.drive((constraint, k), equation.rhs);
        }
        self.start[row + 1..].iter_mut().for_each(|start| *start += last - first);
        let next = row + 1;
        self.start.splice(next..next, ends);
        self.col.splice(first..first, col);
        self.val.splice(first..first, val);
        self.owners.splice(row..row, owners);
        self.rhs.splice(row..row, rhs);
    }

    fn drive(&mut self, key: (u32, u32), rhs: LinearRhs) {
        if let LinearRhs::TimeFunction(function) = rhs {
            self.driven.insert(key, function);
        }
    }

    /// Removes and returns the equations of a constraint.
    pub fn take(&mut self, constraint: u32, names: &EquationNames) -> Vec<StagedEquation> {
        let rows = self.rows_of(constraint);
        let staged = |(k, row): (u32, usize)| {
            let function = self.driven.remove(&(constraint, k));
            let rhs = function.map_or(LinearRhs::Value(self.rhs[row]), LinearRhs::TimeFunction);
            StagedEquation { name: names.name(self.owners[row].name), terms: Vec::new(), rhs }
        };
        let mut all: Vec<_> = (0..).zip(rows.clone()).map(staged).collect();
        all.iter_mut().zip(rows.clone()).for_each(|(equation, row)| equation.terms = self.terms(row).collect());
        let entries = self.start[rows.start]..self.start[rows.end];
        self.start.drain(rows.start + 1..=rows.end);
        self.start[rows.start + 1..].iter_mut().for_each(|start| *start -= entries.len());
        self.col.drain(entries.clone());
        self.val.drain(entries);
        self.owners.drain(rows.clone());
        self.rhs.drain(rows);
        all
    }

    /// Replaces the equations of a constraint if the new ones have the same DOFs; returns whether they have.
    pub fn overwrite(
        &mut self,
        constraint: u32,
        equations: &mut Vec<StagedEquation>,
        names: &mut EquationNames,
        time: f64,
    ) -> bool {
        let rows = self.rows_of(constraint);
        let same =
            |(row, new): (usize, &StagedEquation)| self.terms(row).map(|(j, _)| j).eq(new.terms.iter().map(|t| t.0));
        if rows.len() != equations.len() || !rows.clone().zip(&*equations).all(same) {
            return false;
        }
        for ((k, row), equation) in (0..).zip(rows).zip(equations.drain(..)) {
            let entries = self.start[row]..self.start[row + 1];
            self.val[entries].iter_mut().zip(&equation.terms).for_each(|(v, term)| *v = term.1);
            self.rhs[row] = equation.rhs.at(time);
            self.owners[row].name = names.place(equation.name);
            self.driven.remove(&(constraint, k));
            self.drive((constraint, k), equation.rhs);
        }
        true
    }

    /// Rows whose right-hand sides are functions of time.
    pub fn driven(&self) -> impl Iterator<Item = (usize, &TimeFunction)> {
        self.driven.iter().map(|(&(constraint, k), function)| (self.rows_of(constraint).start + k as usize, function))
    }

    /// Sets constant right-hand sides; functions of time of this constraint are dropped.
    pub fn set_values(&mut self, constraint: u32, rhs: &[f64]) {
        for ((k, row), &rhs) in (0..).zip(self.rows_of(constraint)).zip(rhs) {
            self.driven.remove(&(constraint, k));
            self.rhs[row] = rhs;
        }
    }

    pub fn set_rhs(&mut self, row: usize, rhs: f64) {
        self.rhs[row] = rhs;
    }

    /// Writes c of some rows.
    pub fn evaluate(&self, rows: Range<usize>, u: &[f64], c: &mut [f64]) {
        for (row, c) in rows.zip(c) {
            *c = self.terms(row).fold(0.0, |sum, (j, v)| sum + v * u[j as usize]) - self.rhs[row];
        }
    }

    /// Writes bounds on the rounding errors of c of some rows.
    pub fn rounding(&self, rows: Range<usize>, u: &[f64], c: &mut [f64]) {
        for (row, c) in rows.zip(c) {
            let term = |(j, a): (u32, f64)| Bounded::from(a) * Bounded::from(u[j as usize]);
            let sum = self.terms(row).map(term).fold(Bounded::from(0.0), |sum, term| sum + term);
            *c = bound(sum - Bounded::from(self.rhs[row]));
        }
    }
}

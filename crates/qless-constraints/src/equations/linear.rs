//! All linear equations of a set, `c = G u - b`, in the order of their constraints: the rows of G, which do not depend on u, and b.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::ops::Range;

use crate::equations::dof_uses::bound;
use crate::equations::{EquationNames, EquationOwner, LinearRhs, TimeFunction};
use crate::scalar::Bounded;

/// Pairs `(DOF, coefficient)`, DOFs ascending.
pub type LinearTerms = Vec<(u32, f64)>;

/// A linear equation `sum a_j u_j = rhs` of a constraint that is new or inactive, so that the set does not evaluate it.
pub struct StagedEquation {
    pub name: Cow<'static, str>,
    pub terms: LinearTerms,
    pub rhs: LinearRhs,
}

/// The linear equations of all active constraints of a set, in compressed rows.
pub struct LinearEquations {
    pub owners: Vec<EquationOwner>,
    /// The right-hand sides b, at the time of the set.
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

    /// Replaces the equations of a constraint, and returns the old ones. Either list may be empty. If both have equally many rows and
    /// terms, no equation of another constraint moves.
    pub fn replace(
        &mut self,
        constraint: u32,
        equations: Vec<StagedEquation>,
        names: &mut EquationNames,
        time: f64,
    ) -> Vec<StagedEquation> {
        let rows = self.rows_of(constraint);
        let entries = self.start[rows.start]..self.start[rows.end];
        let old = (0..).zip(rows.clone()).map(|(k, row)| self.staged((constraint, k), row, names)).collect();
        let (mut col, mut val, mut ends) = (Vec::new(), Vec::new(), Vec::new());
        let (mut owners, mut rhs) = (Vec::new(), Vec::new());
        for (k, equation) in (0..).zip(equations) {
            col.extend(equation.terms.iter().map(|&(j, _)| j));
            val.extend(equation.terms.iter().map(|&(_, v)| v));
            ends.push(entries.start + col.len());
            owners.push(EquationOwner { constraint, name: names.place(equation.name) });
            rhs.push(equation.rhs.at(time));
            if let LinearRhs::TimeFunction(function) = equation.rhs {
                self.driven.insert((constraint, k), function);
            }
        }
        let moved = col.len().wrapping_sub(entries.len());
        if moved != 0 {
            self.start[rows.end + 1..].iter_mut().for_each(|start| *start = start.wrapping_add(moved));
        }
        self.start.splice(rows.start + 1..=rows.end, ends);
        self.col.splice(entries.clone(), col);
        self.val.splice(entries, val);
        self.owners.splice(rows.clone(), owners);
        self.rhs.splice(rows, rhs);
        old
    }

    /// Copies a row out of the set. If its right-hand side is a function of time, the function moves into the copy.
    fn staged(&mut self, key: (u32, u32), row: usize, names: &EquationNames) -> StagedEquation {
        let function = self.driven.remove(&key);
        let rhs = function.map_or(LinearRhs::Value(self.rhs[row]), LinearRhs::TimeFunction);
        StagedEquation { name: names.name(self.owners[row].name), terms: self.terms(row).collect(), rhs }
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

//! Explanations over equations and prescribed values, and repairs of conflicts.

use numpy::{IntoPyArray, PyArray1};
use pyo3::prelude::*;
use qless::explanation::{Change, Explanation, Member, Number, Repair};

use crate::system::places;

/// `(rows, coefficients)`, `(DOFs, coefficients, values)`, right-hand side, error and irreducibility of an
/// explanation.
pub type ExplanationArrays<'py> = (
    (Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<f64>>),
    (Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>),
    f64,
    f64,
    bool,
);

/// `(row, DOF, present value, new value)`; either the row or the DOF is given.
type ChangeNumbers = (Option<usize>, Option<usize>, f64, f64);

/// `(conflicting rows, ways, number of ways)`. A way is a list of changes that cures the conflicts. The number may exceed the length of the
/// list `ways`.
pub type RepairNumbers = (Vec<usize>, Vec<Vec<ChangeNumbers>>, usize);

/// An explanation as arrays.
pub fn arrays<'py>(py: Python<'py>, explanation: &Explanation) -> ExplanationArrays<'py> {
    let (mut rows, mut of_rows) = (Vec::new(), Vec::new());
    let (mut dofs, mut of_dofs, mut values) = (Vec::new(), Vec::new(), Vec::new());
    for &member in &explanation.members {
        let coefficient = member.coefficient();
        match member {
            Member::Equation { row, .. } => {
                rows.push(row);
                of_rows.push(coefficient);
            }
            Member::Prescribed { dof, value, .. } => {
                dofs.push(dof);
                of_dofs.push(coefficient);
                values.push(value);
            }
            _ => {}
        }
    }
    let equations = (places(py, &rows), of_rows.into_pyarray(py));
    let prescribed = (places(py, &dofs), of_dofs.into_pyarray(py), values.into_pyarray(py));
    (equations, prescribed, explanation.right_hand_side, explanation.error, explanation.is_irreducible)
}

/// A repair as numbers.
pub fn numbers(repair: &Repair) -> RepairNumbers {
    let change = |change: &Change| {
        let (row, dof) = match change.number {
            Number::RightHandSide(row) => (Some(row), None),
            Number::Prescribed(dof) => (None, Some(dof)),
            _ => (None, None),
        };
        (row, dof, change.from, change.to)
    };
    let ways = repair.ways.iter().map(|way| way.iter().map(change).collect()).collect();
    (repair.conflicts.clone(), ways, repair.count)
}

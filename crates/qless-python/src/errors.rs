//! Errors of the library as the exceptions of `qless._errors`, with row, DOF and their labels.

use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use qless::change::RefreshError;
use qless::elimination::EliminationError;
use qless::{AnalysisError, ArgumentError, ConstraintSystem, Place, ReductionError, SystemError};

/// Labels of rows and DOFs for messages; empty lists without labels.
#[derive(Clone, Copy)]
pub struct LabelNames<'a> {
    pub equations: &'a [String],
    pub dofs: &'a [String],
}

impl<'a> LabelNames<'a> {
    pub fn of(system: &'a ConstraintSystem) -> Self {
        Self { equations: system.equation_labels(), dofs: system.dof_labels() }
    }

    /// The message with the labels of the row and the DOF that it names by number.
    fn explain(self, message: &str, row: Option<usize>, dof: Option<usize>) -> String {
        let label = |what: &str, place: Option<usize>, labels: &[String]| {
            place.and_then(|place| Some(format!("{what} {place} is \"{}\"", labels.get(place)?)))
        };
        let labels = [label("row", row, self.equations), label("DOF", dof, self.dofs)];
        let said: Vec<String> = labels.into_iter().flatten().collect();
        if said.is_empty() { message.to_owned() } else { format!("{message} ({})", said.join(", ")) }
    }
}

/// An exception of `qless._errors` with a row and a DOF.
fn raise(class: &str, message: String, row: Option<usize>, dof: Option<usize>) -> PyErr {
    Python::attach(|py| {
        let fields = PyDict::new(py);
        let made = fields.set_item("row", row).and_then(|()| fields.set_item("dof", dof)).and_then(|()| {
            py.import("qless._errors")?.getattr(class)?.call((message.into_py_any(py)?,), Some(&fields))
        });
        made.map_or_else(|error| error, PyErr::from_value)
    })
}

/// An exception without a row and a DOF.
pub fn plain(class: &str, error: &dyn std::fmt::Display) -> PyErr {
    raise(class, error.to_string(), None, None)
}

pub fn system_error(error: &SystemError, names: LabelNames) -> PyErr {
    let (row, dof) = match *error {
        SystemError::NotFinite { what, .. } | SystemError::DofOutOfRange { what, .. } => match what {
            Place::Coefficient { row, dof } => (Some(row), Some(dof)),
            Place::RightHandSide { row } => (Some(row), None),
            Place::Prescribed { dof } => (None, Some(dof)),
        },
        SystemError::RowOutOfRange { row, .. } | SystemError::NotAscending { row, .. } => (Some(row), None),
        SystemError::PrescribedTwice { dof, .. } => (None, Some(dof)),
        _ => (None, None),
    };
    raise("InputError", names.explain(&error.to_string(), row, dof), row, dof)
}

pub fn analysis_error(error: &AnalysisError, names: LabelNames) -> PyErr {
    match *error {
        AnalysisError::Subnormal { row } | AnalysisError::Range { row } => {
            raise("InputError", names.explain(&error.to_string(), Some(row), None), Some(row), None)
        }
        AnalysisError::Option(_) => plain("InputError", error),
        _ => plain("FactorError", error),
    }
}

pub fn argument_error(error: &ArgumentError) -> PyErr {
    plain("InputError", error)
}

fn reduction_error(error: &ReductionError, names: LabelNames) -> PyErr {
    let (row, dof) = match *error {
        ReductionError::Residual { row, .. } => (Some(row), None),
        ReductionError::NotFinite { dof } => (None, Some(dof)),
        _ => (None, None),
    };
    raise("ReductionError", names.explain(&error.to_string(), row, dof), row, dof)
}

/// The exception `Conflict` carries only the conflicting rows; the Python package adds the explanations.
pub fn elimination_error(error: &EliminationError, names: LabelNames) -> PyErr {
    match error {
        EliminationError::Conflicting { rows, .. } => Python::attach(|py| {
            let class = py.import("qless._errors").and_then(|module| module.getattr("Conflict"));
            let made = class.and_then(|class| class.call1((error.to_string(), rows.clone())));
            made.map_or_else(|error| error, PyErr::from_value)
        }),
        EliminationError::Analysis(error) => analysis_error(error, names),
        EliminationError::Reduction(error) | EliminationError::Refresh(RefreshError::Reduction(error)) => {
            reduction_error(error, names)
        }
        EliminationError::Argument(error) | EliminationError::Refresh(RefreshError::Argument(error)) => {
            argument_error(error)
        }
        EliminationError::Matrix(error) => plain("InputError", error),
        _ => plain("FactorError", error),
    }
}

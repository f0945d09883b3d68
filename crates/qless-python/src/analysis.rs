//! The diagnosis: kinds, certificates, confidence, report.

use std::sync::Arc;

use numpy::{IntoPyArray, PyArray1};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use qless::{Analysis, Report, analyse as analyse_system};

use crate::elimination::{ConfidenceNumbers, PyElimination, TermArrays, confidence_numbers, fixed_dofs, numbers_of};
use crate::errors::{LabelNames, analysis_error, argument_error, plain};
use crate::explanation::{ExplanationArrays, RepairNumbers, arrays, numbers};
use crate::interrupt::run;
use crate::options::options;
use crate::system::{PySystem, places};

/// An analysis; it never changes.
#[pyclass(frozen, name = "Analysis", module = "qless._qless")]
#[derive(Debug)]
pub struct PyAnalysis(Arc<Analysis>);

/// `(row, DOF, coefficient)` of each coefficient.
type Coefficients = Vec<(usize, usize, f64)>;

/// Diagnoses a system with the options that are given.
#[pyfunction]
#[pyo3(signature = (system, **given))]
pub fn analyse(py: Python<'_>, system: &PySystem, given: Option<&Bound<'_, PyDict>>) -> PyResult<PyAnalysis> {
    let options = given.map_or_else(|| Ok(qless::Options::default()), options)?;
    let (own, size) = (system.0.clone(), system.0.matrix().nnz());
    let analysed = run(py, size, move || analyse_system(&own, &options))?;
    analysed
        .map(|analysis| PyAnalysis(Arc::new(analysis)))
        .map_err(|error| analysis_error(&error, LabelNames::of(&system.0)))
}

fn terms<'py>(py: Python<'py>, terms: &[qless::CertificateTerm]) -> TermArrays<'py> {
    let rows: Vec<usize> = terms.iter().map(|term| term.row).collect();
    let coefficients: Vec<f64> = terms.iter().map(|term| term.coefficient).collect();
    (places(py, &rows), coefficients.into_pyarray(py))
}

#[pymethods]
impl PyAnalysis {
    #[getter]
    fn rank(&self) -> usize {
        self.0.rank()
    }

    fn kinds<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u8>> {
        numbers_of(self.0.kinds()).into_pyarray(py)
    }

    /// `(row, mismatch)` of the dependent equations, as two arrays.
    fn mismatches<'py>(&self, py: Python<'py>) -> TermArrays<'py> {
        let rows: Vec<usize> = self.0.dependent().iter().map(|d| d.row).collect();
        let mismatches: Vec<f64> = self.0.dependent().iter().map(|d| d.mismatch).collect();
        (places(py, &rows), mismatches.into_pyarray(py))
    }

    /// Free DOFs that the equations fix, and their values.
    fn fixed<'py>(&self, py: Python<'py>) -> TermArrays<'py> {
        fixed_dofs(py, self.0.generated())
    }

    /// The certificate of a row, and its relative error. The error is 0 if it is at most the tolerance, or if it is not computed (quick
    /// effort).
    fn because<'py>(&self, py: Python<'py>, row: usize) -> PyResult<(TermArrays<'py>, f64)> {
        let found = py.detach(|| self.0.because(row).and_then(|found| Ok((found, self.0.because_error(row)?))));
        let (found, error) = found.map_err(|error| argument_error(&error))?;
        Ok((terms(py, &found), error))
    }

    /// Why a DOF is fixed: equations whose weighted sum determines it, as rows and coefficients.
    fn because_fixed<'py>(&self, py: Python<'py>, dof: usize) -> PyResult<TermArrays<'py>> {
        let found = py.detach(|| self.0.because_fixed(dof)).map_err(|error| plain("FactorError", &error))?;
        Ok(terms(py, &found))
    }

    /// Why a row is dependent, in few equations and prescribed values; `None` for an independent row.
    fn explain<'py>(&self, py: Python<'py>, row: usize) -> PyResult<Option<ExplanationArrays<'py>>> {
        let found = py.detach(|| self.0.explain(row)).map_err(|error| argument_error(&error))?;
        Ok(found.map(|found| arrays(py, &found)))
    }

    /// Why a DOF is fixed, in few equations and prescribed values; `None` for a DOF that the equations do not fix.
    fn explain_fixed<'py>(&self, py: Python<'py>, dof: usize) -> PyResult<Option<ExplanationArrays<'py>>> {
        let found = py.detach(|| self.0.explain_fixed(dof)).map_err(|error| plain("FactorError", &error))?;
        Ok(found.map(|found| arrays(py, &found)))
    }

    /// For each group of conflicts, sets of few changes that cure them.
    fn repairs(&self, py: Python<'_>) -> PyResult<Vec<RepairNumbers>> {
        let found = py.detach(|| self.0.repairs()).map_err(|error| plain("FactorError", &error))?;
        Ok(found.iter().map(numbers).collect())
    }

    /// The confidence: `(digits kept, digits dropped, ambiguous, doubt)`, as in `Confidence::digits_kept` and `Confidence::digits_dropped`.
    fn confidence(&self) -> ConfidenceNumbers {
        confidence_numbers(self.0.confidence())
    }

    /// The result if the listed coefficients, which may be rounding, are read the other way (as zero, or as given):
    /// `(as zero, rank, number of conflicting equations, [(row, DOF, coefficient)])`.
    fn other_reading(&self) -> Option<(bool, usize, usize, Coefficients)> {
        let other = self.0.other_reading()?;
        let terms = other.terms.iter().map(|term| (term.row, term.dof, term.coefficient)).collect();
        Some((other.as_zero, other.rank, other.conflicting, terms))
    }

    /// Coefficients that count as zero: `[(row, DOF, coefficient)]`.
    fn noise(&self) -> Coefficients {
        self.0.noise().iter().map(|term| (term.row, term.dof, term.coefficient)).collect()
    }

    /// The report as JSON, with repairs, and with explanations of at most `terms` members in total.
    #[pyo3(signature = (terms=Report::TERMS))]
    fn json(&self, py: Python<'_>, terms: usize) -> PyResult<String> {
        let report = py.detach(|| Report::new(&self.0, terms).with_repairs(&self.0));
        let report = report.map_err(|error| plain("FactorError", &error))?;
        py.detach(|| serde_json::to_string(&report)).map_err(|error| plain("Error", &error))
    }

    /// Chooses slaves and computes the reduced form.
    fn eliminate(&self, py: Python<'_>) -> PyResult<PyElimination> {
        PyElimination::new(py, &self.0)
    }
}

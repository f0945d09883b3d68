//! The reduced form and its uses: T, G, g, expand, restrict, condense, multipliers, refresh.

use std::sync::{Arc, Mutex, PoisonError, RwLock, RwLockReadGuard};

use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use qless::elimination::{CondensedPattern, EliminationError, PrescribedDofs, View};
use qless::{Analysis, ArgumentError, Confidence, ConstraintSystem, Elimination, Form, Kind};

use crate::errors::{LabelNames, argument_error, elimination_error};
use crate::interrupt::run;
use crate::system::{IndexArray, RowArrays, indices, places, row_arrays, starts};

type Doubles<'py> = PyReadonlyArray1<'py, f64>;

/// An elimination, `u = L u_q + u_0`. A thread releases the interpreter lock before it takes a lock of this type, so that no two threads
/// wait for each other.
#[pyclass(frozen, name = "Elimination", module = "qless._qless")]
#[derive(Debug)]
pub struct PyElimination {
    system: ConstraintSystem,
    elimination: RwLock<Elimination>,
    /// The pattern of the matrix that was condensed last: most codes condense one pattern many times.
    pattern: Mutex<Option<Arc<LastPattern>>>,
}

/// A condensed pattern, and the arrays that it was made from.
#[derive(Debug)]
struct LastPattern {
    starts: Vec<usize>,
    index: Vec<u32>,
    by_columns: bool,
    condensed: CondensedPattern,
}

impl PyElimination {
    pub fn new(py: Python<'_>, analysis: &Arc<Analysis>) -> PyResult<Self> {
        let (own, system) = (Arc::clone(analysis), analysis.system().clone());
        let made = run(py, system.matrix().nnz(), move || Elimination::from_analysis(own, Form::Explicit))?;
        let elimination = made.map_err(|error| elimination_error(&error, LabelNames::of(&system)))?;
        Ok(Self { system, elimination: RwLock::new(elimination), pattern: Mutex::new(None) })
    }

    /// Locks the elimination for reading. If an earlier call panicked while it held the lock, this is ignored: that call reported the
    /// panic.
    fn read(&self) -> RwLockReadGuard<'_, Elimination> {
        self.elimination.read().unwrap_or_else(PoisonError::into_inner)
    }

    fn with<R: Send>(&self, py: Python<'_>, work: impl FnOnce(&Elimination) -> R + Send) -> R {
        py.detach(|| work(&self.read()))
    }

    fn failed(&self) -> impl FnOnce(EliminationError) -> PyErr + '_ {
        |error| elimination_error(&error, LabelNames::of(&self.system))
    }

    /// Fills a new array of length `length`.
    fn fill<'py>(
        &self,
        py: Python<'py>,
        length: impl FnOnce(&Elimination) -> usize + Send,
        work: impl FnOnce(&Elimination, &mut [f64]) -> Result<(), ArgumentError> + Send,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let filled = self.with(py, |elimination| {
            let mut out = vec![0.0; length(elimination)];
            work(elimination, &mut out).map(|()| out)
        });
        Ok(filled.map_err(|error| argument_error(&error))?.into_pyarray(py))
    }

    fn dofs<'py>(&self, py: Python<'py>, list: fn(&Elimination) -> &[usize]) -> Bound<'py, PyArray1<i64>> {
        let list = self.with(py, |elimination| list(elimination).to_vec());
        places(py, &list)
    }

    /// The condensed pattern for a matrix K with these arrays. The last pattern is returned if it was made from the same arrays.
    fn pattern(
        &self,
        starts: Vec<usize>,
        index: Vec<u32>,
        by_columns: bool,
    ) -> Result<Arc<LastPattern>, EliminationError> {
        let mut known = self.pattern.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(last) = &*known
            && (last.by_columns, &last.starts, &last.index) == (by_columns, &starts, &index)
        {
            return Ok(Arc::clone(last));
        }
        let view = if by_columns { View::columns(&starts, &index) } else { View::rows(&starts, &index) };
        let condensed = self.read().condensed(view, PrescribedDofs::Eliminated)?;
        let made = Arc::new(LastPattern { starts, index, by_columns, condensed });
        *known = Some(Arc::clone(&made));
        Ok(made)
    }
}

/// An array of rows or DOFs, and an array with a number for each of them.
pub type TermArrays<'py> = (Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<f64>>);

/// DOFs and their values, as two arrays.
pub fn fixed_dofs<'py>(py: Python<'py>, fixed: &[(usize, f64)]) -> TermArrays<'py> {
    let (dofs, values): (Vec<usize>, Vec<f64>) = fixed.iter().copied().unzip();
    (places(py, &dofs), values.into_pyarray(py))
}

/// A confidence: `(digits kept, digits dropped, ambiguous, doubt)`.
pub type ConfidenceNumbers = (f64, f64, bool, Option<String>);

pub fn confidence_numbers(confidence: Confidence) -> ConfidenceNumbers {
    let doubt = confidence.doubt.map(|doubt| serde_json::to_string(&doubt).unwrap_or_default());
    let doubt = doubt.map(|word| word.trim_matches('"').to_owned());
    (confidence.digits_kept(), confidence.digits_dropped(), confidence.ambiguous, doubt)
}

/// The kinds as small numbers: 0 independent, 1 redundant, 2 conflicting.
pub fn numbers_of(kinds: &[Kind]) -> Vec<u8> {
    let number = |kind: &Kind| match kind {
        Kind::Independent => 0,
        Kind::Redundant => 1,
        Kind::Conflicting => 2,
    };
    kinds.iter().map(number).collect()
}

fn narrow(index: &IndexArray<'_>) -> Vec<u32> {
    // An index that does not fit into 32 bits becomes `u32::MAX`. This is out of range too, so that the library refuses it.
    let narrow = |k: i64| u32::try_from(k).unwrap_or(u32::MAX);
    match index {
        IndexArray::Narrow(index) => index.as_array().iter().map(|&k| narrow(k.into())).collect(),
        IndexArray::Wide(index) => index.as_array().iter().map(|&k| narrow(k)).collect(),
    }
}

#[pymethods]
impl PyElimination {
    fn slaves<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        self.dofs(py, Elimination::slaves)
    }

    fn masters<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        self.dofs(py, Elimination::masters)
    }

    fn prescribed<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        self.dofs(py, Elimination::prescribed)
    }

    fn prescribed_values<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.with(py, |elimination| elimination.prescribed_values().to_vec()).into_pyarray(py)
    }

    fn rhs<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.with(py, |elimination| elimination.rhs().to_vec()).into_pyarray(py)
    }

    fn kinds<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u8>> {
        self.with(py, |elimination| numbers_of(elimination.kinds())).into_pyarray(py)
    }

    /// DOFs that the equations fix, and their values, for the current b and u_p.
    fn fixed<'py>(&self, py: Python<'py>) -> TermArrays<'py> {
        fixed_dofs(py, &self.with(py, |elimination| elimination.generated().to_vec()))
    }

    /// The confidence for the current b and u_p, as of an analysis.
    fn confidence(&self, py: Python<'_>) -> PyResult<ConfidenceNumbers> {
        let found = self.with(py, |elimination| elimination.confidence().map(confidence_numbers));
        found.ok_or_else(|| self.failed()(EliminationError::NoEquations))
    }

    /// T of `u_s = T u_q + G u_p + g` as `(starts, columns, values)`, slaves x masters.
    fn t<'py>(&self, py: Python<'py>) -> RowArrays<'py> {
        row_arrays(py, &self.with(py, |elimination| elimination.reduction().t().clone()))
    }

    /// G of `u_s = T u_q + G u_p + g` as `(starts, columns, values)`, slaves x prescribed DOFs.
    fn g_matrix<'py>(&self, py: Python<'py>) -> RowArrays<'py> {
        row_arrays(py, &self.with(py, |elimination| elimination.reduction().g_matrix().clone()))
    }

    fn g<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.with(py, |elimination| elimination.reduction().g().to_vec()).into_pyarray(py)
    }

    #[getter]
    fn growth(&self, py: Python<'_>) -> f64 {
        self.with(py, |elimination| elimination.reduction().growth())
    }

    /// All DOFs `u = L u_q + u_0` from the masters `u_q`.
    fn expand<'py>(&self, py: Python<'py>, masters: Doubles<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let masters = masters.as_array().to_vec();
        self.fill(py, Elimination::dofs, |elimination, u| elimination.expand_into(&masters, u))
    }

    /// An increment `du = L du_q` of all DOFs from one of the masters.
    fn expand_increment<'py>(&self, py: Python<'py>, masters: Doubles<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let masters = masters.as_array().to_vec();
        self.fill(py, Elimination::dofs, |elimination, du| elimination.expand_increment_into(&masters, du))
    }

    /// Forces on the masters, `f_q = L^T f`, from forces f on all DOFs.
    fn restrict<'py>(&self, py: Python<'py>, forces: Doubles<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let forces = forces.as_array().to_vec();
        let masters = |elimination: &Elimination| elimination.masters().len();
        self.fill(py, masters, |elimination, out| elimination.restrict_into(&forces, out))
    }

    fn multipliers<'py>(&self, py: Python<'py>, residual: Doubles<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let residual = residual.as_array().to_vec();
        let found = self.with(py, |elimination| elimination.multipliers(&residual));
        Ok(found.map_err(self.failed())?.into_pyarray(py))
    }

    fn reactions<'py>(
        &self,
        py: Python<'py>,
        residual: Doubles<'py>,
        multipliers: Doubles<'py>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let (residual, multipliers) = (residual.as_array().to_vec(), multipliers.as_array().to_vec());
        let found = self.with(py, |elimination| elimination.reactions(&residual, &multipliers));
        Ok(found.map_err(self.failed())?.into_pyarray(py))
    }

    /// Sets new b and prescribed values; an error leaves everything as it was.
    fn update(&self, py: Python<'_>, rhs: Doubles<'_>, prescribed: Doubles<'_>) -> PyResult<()> {
        let (rhs, prescribed) = (rhs.as_array().to_vec(), prescribed.as_array().to_vec());
        let updated = py.detach(|| {
            let mut elimination = self.elimination.write().unwrap_or_else(PoisonError::into_inner);
            elimination.update(&rhs, &prescribed)
        });
        updated.map_err(self.failed())
    }

    /// `K_q = L^T K L` in compressed rows or columns, like K, and `f_q = L^T (f - K u_0)`.
    fn condense<'py>(
        &self,
        py: Python<'py>,
        k: (IndexArray<'py>, IndexArray<'py>, Doubles<'py>),
        by_columns: bool,
        f: Doubles<'py>,
    ) -> PyResult<(RowArrays<'py>, Bound<'py, PyArray1<f64>>)> {
        let (of_lines, index, values) = k;
        let values = values.as_array().to_vec();
        let (starts, index) = (starts(&of_lines, values.len())?, narrow(&index));
        let f = f.as_array().to_vec();
        let condensed = py.detach(|| {
            let known = self.pattern(starts, index, by_columns)?;
            let condensed = &known.condensed;
            let (mut k_q, mut f_q) = (vec![0.0; condensed.nnz()], vec![0.0; condensed.unknowns()]);
            condensed.condense_into(&self.read(), &values, &f, &mut k_q, &mut f_q)?;
            Ok((known, k_q, f_q))
        });
        let (known, k_q, f_q) = condensed.map_err(self.failed())?;
        let starts = known.condensed.starts().iter().map(|&start| start as usize);
        let index = known.condensed.index().iter().map(|&k| k as usize);
        Ok(((indices(py, starts), indices(py, index), k_q.into_pyarray(py)), f_q.into_pyarray(py)))
    }
}

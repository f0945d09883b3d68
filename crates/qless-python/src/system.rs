//! A constraint system from arrays: compressed rows or a dense matrix, with numbers of any width.

use numpy::ndarray::{ArrayView1, ArrayView2};
use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use qless::{ConstraintSystem, Csr, SystemBuilder, SystemError};

use crate::errors::{LabelNames, plain, system_error};

/// A validated system; it never changes.
#[pyclass(frozen, name = "System", module = "qless._qless")]
#[derive(Debug)]
pub struct PySystem(pub ConstraintSystem);

/// Indices of 32 or 64 bits.
#[derive(Debug, FromPyObject)]
pub enum IndexArray<'py> {
    Narrow(PyReadonlyArray1<'py, i32>),
    Wide(PyReadonlyArray1<'py, i64>),
}

/// Floats of 32 or 64 bits.
#[derive(Debug, FromPyObject)]
pub enum FloatArray<'py> {
    Double(PyReadonlyArray1<'py, f64>),
    Single(PyReadonlyArray1<'py, f32>),
}

#[derive(Debug, FromPyObject)]
pub enum Dense<'py> {
    Double(PyReadonlyArray2<'py, f64>),
    Single(PyReadonlyArray2<'py, f32>),
}

/// Prescribed DOFs and their values.
type PrescribedArrays<'py> = (PyReadonlyArray1<'py, i64>, PyReadonlyArray1<'py, f64>);

/// The data of a system `C u = b` apart from C: right-hand sides b, prescribed DOFs, labels of equations and of DOFs.
#[derive(FromPyObject)]
pub struct Sides<'py> {
    #[pyo3(item)]
    rhs: Option<PyReadonlyArray1<'py, f64>>,
    #[pyo3(item)]
    prescribed: Option<PrescribedArrays<'py>>,
    #[pyo3(item)]
    labels: Option<Vec<String>>,
    #[pyo3(item)]
    dof_labels: Option<Vec<String>>,
}

impl Sides<'_> {
    /// Builds the system without the interpreter's lock; `make` makes it from b and the prescribed values.
    fn build(
        self,
        py: Python<'_>,
        rows: usize,
        make: impl FnOnce(Vec<f64>, &[(usize, f64)]) -> Result<ConstraintSystem, SystemError> + Send,
    ) -> PyResult<PySystem> {
        let rhs = self.rhs.map_or_else(|| vec![0.0; rows], |rhs| rhs.as_array().to_vec());
        let prescribed = self.prescribed.map_or_else(|| Ok(Vec::new()), |given| pairs(&given))?;
        let (labels, dof_labels) = (self.labels.unwrap_or_default(), self.dof_labels.unwrap_or_default());
        let built = py.detach(|| {
            let (what, found) = ("the right-hand side", rhs.len());
            if found != rows {
                return Err(SystemError::WrongLength { what, found, expected: rows });
            }
            make(rhs, &prescribed)
        });
        let failed = |error| system_error(&error, LabelNames { equations: &labels, dofs: &dof_labels });
        let built = built.map_err(failed)?;
        built.with_labels(labels, dof_labels).map(PySystem).map_err(|error| plain("InputError", &error))
    }
}

/// Builds a system row by row, in any order of columns: `entries` returns a row.
fn from_entries<E: IntoIterator<Item = (usize, f64)>>(
    dofs: usize,
    (rhs, prescribed): (&[f64], &[(usize, f64)]),
    entries: impl Fn(usize) -> E,
) -> Result<ConstraintSystem, SystemError> {
    let mut builder = SystemBuilder::new(dofs);
    rhs.iter().enumerate().for_each(|(row, &rhs)| _ = builder.equation(entries(row), rhs));
    prescribed.iter().for_each(|&(dof, value)| builder.prescribe(dof, value));
    builder.build()
}

fn pairs((dofs, values): &PrescribedArrays<'_>) -> PyResult<Vec<(usize, f64)>> {
    let (dofs, values) = (dofs.as_array(), values.as_array());
    let what = "the list of prescribed values";
    let (found, expected) = (values.len(), dofs.len());
    if found != expected {
        return Err(plain("InputError", &SystemError::WrongLength { what, found, expected }));
    }
    let dof = |dof: i64| usize::try_from(dof).map_err(|_| negative("a prescribed DOF", dof));
    dofs.iter().zip(values).map(|(&j, &value)| Ok((dof(j)?, value))).collect()
}

fn negative(what: &str, value: i64) -> PyErr {
    plain("InputError", &format!("{what} is {value}; rows and DOFs count from 0"))
}

/// The starts of compressed rows; they must begin at 0, never decrease and end at `nnz` ([`SystemError::BadStarts`]).
pub fn starts(given: &IndexArray<'_>, nnz: usize) -> PyResult<Vec<usize>> {
    let checked = match given {
        IndexArray::Narrow(starts) => ascending(starts.as_array().iter().map(|&start| i64::from(start)), nnz),
        IndexArray::Wide(starts) => ascending(starts.as_array().iter().copied(), nnz),
    };
    checked.map_err(|error| plain("InputError", &error))
}

fn ascending(given: impl ExactSizeIterator<Item = i64>, nnz: usize) -> Result<Vec<usize>, SystemError> {
    let mut starts = Vec::with_capacity(given.len());
    let mut before = 0;
    for (index, start) in given.enumerate() {
        let is_first = index == 0;
        if start < before || (is_first && start != 0) || start as usize > nnz {
            return Err(SystemError::BadStarts { index, value: start.max(0) as usize });
        }
        before = start;
        starts.push(start as usize);
    }
    match starts.last() {
        Some(&last) if last == nnz => Ok(starts),
        last => {
            Err(SystemError::BadStarts { index: starts.len().saturating_sub(1), value: last.copied().unwrap_or(0) })
        }
    }
}

/// Refuses negative columns, because the indices of the library are unsigned.
fn refuse_negative(columns: &IndexArray<'_>) -> PyResult<()> {
    let first = match columns {
        IndexArray::Narrow(columns) => columns.as_array().iter().find(|&&j| j < 0).map(|&j| i64::from(j)),
        IndexArray::Wide(columns) => columns.as_array().iter().find(|&&j| j < 0).copied(),
    };
    first.map_or(Ok(()), |j| Err(negative("a column", j)))
}

/// Makes a system from compressed rows: entries `starts[i]..starts[i + 1]` belong to row i.
#[pyfunction]
pub fn system_from_rows(
    py: Python<'_>,
    dofs: usize,
    matrix: (IndexArray<'_>, IndexArray<'_>, FloatArray<'_>),
    sides: Sides<'_>,
) -> PyResult<PySystem> {
    let (given, columns, values) = matrix;
    refuse_negative(&columns)?;
    match (&columns, &values) {
        (IndexArray::Narrow(j), FloatArray::Double(v)) => {
            from_rows(py, dofs, &given, j.as_array(), v.as_array(), sides)
        }
        (IndexArray::Wide(j), FloatArray::Double(v)) => from_rows(py, dofs, &given, j.as_array(), v.as_array(), sides),
        (IndexArray::Narrow(j), FloatArray::Single(v)) => {
            from_rows(py, dofs, &given, j.as_array(), v.as_array(), sides)
        }
        (IndexArray::Wide(j), FloatArray::Single(v)) => from_rows(py, dofs, &given, j.as_array(), v.as_array(), sides),
    }
}

fn from_rows<I, V>(
    py: Python<'_>,
    dofs: usize,
    given: &IndexArray<'_>,
    columns: ArrayView1<'_, I>,
    values: ArrayView1<'_, V>,
    sides: Sides<'_>,
) -> PyResult<PySystem>
where
    I: Copy + Into<i64> + Sync + Send,
    V: Copy + Into<f64> + Sync + Send,
{
    let (what, found, expected) = ("the list of values", values.len(), columns.len());
    if found != expected {
        return Err(plain("InputError", &SystemError::WrongLength { what, found, expected }));
    }
    let starts = starts(given, found)?;
    let entry = |k: usize| (columns[k].into() as usize, values[k].into());
    sides.build(py, starts.len() - 1, |rhs, prescribed| {
        if !rows_ascend(dofs, &starts, columns) {
            let entries = |row: usize| (starts[row]..starts[row + 1]).map(entry);
            return from_entries(dofs, (&rhs, prescribed), entries);
        }
        let columns = columns.iter().map(|&j| j.into() as u32).collect();
        let matrix = Csr::from_parts(dofs, starts, columns, values.iter().map(|&v| v.into()).collect())?;
        ConstraintSystem::new(matrix, rhs, prescribed)
    })
}

/// Whether the columns of every row are in range and ascend, as in SciPy's canonical format: such rows need no sorting.
fn rows_ascend<I: Copy + Into<i64>>(dofs: usize, starts: &[usize], columns: ArrayView1<'_, I>) -> bool {
    let is_valid = |range: &[usize]| {
        let mut before = -1;
        let mut row = (range[0]..range[1]).map(|k| columns[k].into());
        row.all(|j| j > std::mem::replace(&mut before, j)) && before < dofs as i64
    };
    u32::try_from(dofs).is_ok() && starts.windows(2).all(is_valid)
}

/// Makes a system from a dense matrix, m x n; zeros are no coefficients.
#[pyfunction]
pub fn system_from_dense(py: Python<'_>, matrix: Dense<'_>, sides: Sides<'_>) -> PyResult<PySystem> {
    match &matrix {
        Dense::Double(matrix) => from_dense(py, matrix.as_array(), sides),
        Dense::Single(matrix) => from_dense(py, matrix.as_array(), sides),
    }
}

fn from_dense<V: Copy + Into<f64> + Sync + Send>(
    py: Python<'_>,
    matrix: ArrayView2<'_, V>,
    sides: Sides<'_>,
) -> PyResult<PySystem> {
    sides.build(py, matrix.nrows(), |rhs, prescribed| {
        from_entries(matrix.ncols(), (&rhs, prescribed), |row| nonzeros(matrix.row(row)))
    })
}

fn nonzeros<V: Copy + Into<f64>>(row: ArrayView1<'_, V>) -> impl Iterator<Item = (usize, f64)> + '_ {
    row.into_iter().map(|&v| v.into()).enumerate().filter(|&(_, v)| v != 0.0)
}

/// `(starts, columns, values)` of a sparse matrix. Starts and columns are [`indices`].
pub type RowArrays<'py> = (Bound<'py, PyAny>, Bound<'py, PyAny>, Bound<'py, PyArray1<f64>>);

/// The arrays of a matrix of the library.
pub fn row_arrays<'py>(py: Python<'py>, matrix: &qless::Csr) -> RowArrays<'py> {
    let columns = matrix.columns().iter().map(|&j| j as usize);
    (indices(py, matrix.starts().iter().copied()), indices(py, columns), PyArray1::from_slice(py, matrix.values()))
}

/// Indices as 32-bit integers if they fit, as SciPy has them.
pub fn indices(py: Python<'_>, list: impl Iterator<Item = usize> + Clone) -> Bound<'_, PyAny> {
    if list.clone().all(|k| i32::try_from(k).is_ok()) {
        list.map(|k| k as i32).collect::<Vec<_>>().into_pyarray(py).into_any()
    } else {
        list.map(|k| k as i64).collect::<Vec<_>>().into_pyarray(py).into_any()
    }
}

/// DOFs or rows as 64-bit integers, the index type of numpy.
pub fn places<'py>(py: Python<'py>, list: &[usize]) -> Bound<'py, PyArray1<i64>> {
    list.iter().map(|&k| k as i64).collect::<Vec<_>>().into_pyarray(py)
}

#[pymethods]
impl PySystem {
    /// Rows and columns of C.
    #[getter]
    fn shape(&self) -> (usize, usize) {
        (self.0.equations(), self.0.dofs())
    }

    /// C as `(starts, columns, values)`.
    fn matrix<'py>(&self, py: Python<'py>) -> RowArrays<'py> {
        row_arrays(py, self.0.matrix())
    }

    /// The right-hand sides b.
    fn rhs<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, self.0.rhs())
    }

    /// Prescribed DOFs and values.
    fn prescribed<'py>(&self, py: Python<'py>) -> (Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<f64>>) {
        let (dofs, values): (Vec<usize>, Vec<f64>) = self.0.prescribed().iter().copied().unzip();
        (places(py, &dofs), values.into_pyarray(py))
    }

    /// Labels of the equations; empty without labels.
    fn labels(&self) -> Vec<String> {
        self.0.equation_labels().to_vec()
    }

    /// Labels of the DOFs; empty without labels.
    fn dof_labels(&self) -> Vec<String> {
        self.0.dof_labels().to_vec()
    }
}

//! `C u = b` with some DOFs prescribed (Eq. 2 and 20 of the paper): the validated input of all other stages.
//!
//! All numbers of a [`ConstraintSystem`] are finite, all indices are in range, and a row has each DOF at most once. Coefficients given for
//! the same row and DOF are summed; a sum that cancels to rounding (a few units in the last place of its terms) is not stored.

mod builder;
mod convert;
mod csr;
mod error;
mod replace;

use std::sync::Arc;

pub use builder::SystemBuilder;
pub use csr::Csr;
pub use error::{Place, SystemError};

/// m equations `C u = b` on n DOFs, some of which are prescribed.
///
/// ```
/// use qless::SystemBuilder;
/// // u0 - u1 + 2 u2 = 1, with u2 = 0.5 prescribed.
/// let mut builder = SystemBuilder::new(3);
/// builder.labelled_equation("tie 7", [(0, 1.0), (1, -1.0), (2, 2.0)], 1.0);
/// builder.prescribe(2, 0.5);
/// let system = builder.build()?;
/// assert_eq!((system.equations(), system.dofs(), system.free()), (1, 3, 2));
/// assert_eq!(system.equation_label(0), "tie 7");
/// # Ok::<(), qless::SystemError>(())
/// ```
///
/// A system is immutable, and a clone shares its data: [`crate::Analysis`] keeps one.
#[derive(Clone, Debug, PartialEq)]
pub struct ConstraintSystem {
    numbers: Arc<Numbers>,
    labels: Arc<SystemLabels>,
}

#[derive(Clone, Debug, PartialEq)]
struct Numbers {
    matrix: Csr,
    rhs: Vec<f64>,
    prescribed: Vec<(usize, f64)>,
}

/// Labels of all equations and of all DOFs; each list may be empty.
#[derive(Debug, Default, PartialEq)]
struct SystemLabels {
    equations: Vec<String>,
    dofs: Vec<String>,
    /// Prescribed DOFs, ascending, each with the place in the input at which its value is prescribed.
    places: Vec<(usize, String)>,
}

impl ConstraintSystem {
    /// A system from triplets `(row, DOF, coefficient)`, which are summed if they repeat, and b of length `rows`.
    ///
    /// # Errors
    /// [`SystemError`] for an index out of range, a number that is not finite, or a wrong length.
    pub fn from_triplets(
        rows: usize,
        dofs: usize,
        triplets: &[(usize, usize, f64)],
        rhs: &[f64],
        prescribed: &[(usize, f64)],
    ) -> Result<Self, SystemError> {
        builder::from_triplets(rows, dofs, triplets, rhs, prescribed)
    }

    /// A system from compressed columns: entries `start[j]..start[j + 1]` belong to DOF j.
    ///
    /// # Errors
    /// As [`ConstraintSystem::from_triplets`], and [`SystemError::BadStarts`].
    pub fn from_csc(
        rows: usize,
        start: &[usize],
        row: &[usize],
        value: &[f64],
        rhs: &[f64],
        prescribed: &[(usize, f64)],
    ) -> Result<Self, SystemError> {
        builder::from_csc(rows, start, row, value, rhs, prescribed)
    }

    /// A system from compressed rows, such as those made from the matrices of `sprs` or `nalgebra-sparse` (features of these names).
    ///
    /// # Errors
    /// [`SystemError`], as for [`ConstraintSystem::from_triplets`].
    ///
    /// ```
    /// let mut matrix = qless::Csr::empty(2);
    /// matrix.push_row([(0, 1.0), (1, -1.0)])?;
    /// let system = qless::ConstraintSystem::from_csr(&matrix, &[0.5], &[])?;
    /// assert_eq!((system.equations(), system.matrix().nnz()), (1, 2));
    /// # Ok::<(), qless::SystemError>(())
    /// ```
    pub fn from_csr(matrix: &Csr, rhs: &[f64], prescribed: &[(usize, f64)]) -> Result<Self, SystemError> {
        Self::new(matrix.clone(), rhs.to_vec(), prescribed)
    }

    /// [`ConstraintSystem::from_csr`] without a copy.
    ///
    /// # Errors
    /// [`SystemError`], as for [`ConstraintSystem::from_triplets`].
    ///
    /// ```
    /// use qless::{ConstraintSystem, Csr};
    /// let matrix = Csr::from_parts(2, vec![0, 2], vec![0, 1], vec![1.0, -1.0])?;
    /// let system = ConstraintSystem::new(matrix, vec![0.5], &[(1, 0.0)])?;
    /// assert_eq!((system.equations(), system.free()), (1, 1));
    /// # Ok::<(), qless::SystemError>(())
    /// ```
    pub fn new(matrix: Csr, rhs: Vec<f64>, prescribed: &[(usize, f64)]) -> Result<Self, SystemError> {
        builder::from_csr(matrix, rhs, prescribed)
    }

    /// Labels the equations (one per row) and the DOFs. With an empty list, numbers serve as labels.
    ///
    /// # Errors
    /// [`SystemError::WrongLength`].
    pub fn with_labels(self, equations: Vec<String>, dofs: Vec<String>) -> Result<Self, SystemError> {
        for (what, found, expected) in [
            ("the list of equation labels", equations.len(), self.equations()),
            ("the list of DOF labels", dofs.len(), self.dofs()),
        ] {
            if found != 0 && found != expected {
                return Err(SystemError::WrongLength { what, found, expected });
            }
        }
        let places = self.labels.places.clone();
        Ok(Self { labels: Arc::new(SystemLabels { equations, dofs, places }), ..self })
    }

    /// Sets the places of prescribed values; the first place of a DOF counts.
    fn with_places(mut self, mut places: Vec<(usize, String)>) -> Self {
        places.sort_by_key(|&(dof, _)| dof);
        places.dedup_by_key(|&mut (dof, _)| dof);
        if let (false, Some(labels)) = (places.is_empty(), Arc::get_mut(&mut self.labels)) {
            labels.places = places;
        }
        self
    }

    /// A copy with the selected coefficients and right-hand sides; all others become zero. Labels are shared.
    pub(crate) fn only(&self, entry: impl Fn(usize, usize) -> bool, side: impl Fn(usize) -> bool) -> Self {
        let Numbers { matrix, rhs, prescribed } = &*self.numbers;
        let mut some = Csr::empty(matrix.cols);
        (0..matrix.rows()).for_each(|i| some.append(matrix.row(i).filter(|&(j, _)| entry(i, j))));
        let rhs = rhs.iter().enumerate().map(|(i, &b)| if side(i) { b } else { 0.0 }).collect();
        let numbers = Numbers { matrix: some, rhs, prescribed: prescribed.clone() };
        Self { numbers: Arc::new(numbers), labels: Arc::clone(&self.labels) }
    }

    /// The system with other right-hand sides and prescribed values, which must be finite.
    pub(crate) fn with_numbers(mut self, set: impl FnOnce(&mut [f64], &mut [(usize, f64)])) -> Self {
        let Numbers { rhs, prescribed, .. } = Arc::make_mut(&mut self.numbers);
        set(rhs, prescribed);
        self
    }

    /// Number of equations m.
    pub fn equations(&self) -> usize {
        self.numbers.matrix.rows()
    }

    /// Number of DOFs n, prescribed ones included.
    pub fn dofs(&self) -> usize {
        self.numbers.matrix.cols
    }

    /// Number of DOFs that are not prescribed.
    pub fn free(&self) -> usize {
        self.dofs() - self.numbers.prescribed.len()
    }

    /// The matrix C of the equations, m x n.
    pub fn matrix(&self) -> &Csr {
        &self.numbers.matrix
    }

    /// The right-hand sides b; length m.
    pub fn rhs(&self) -> &[f64] {
        &self.numbers.rhs
    }

    /// Prescribed `(DOF, value)`, ascending by DOF.
    pub fn prescribed(&self) -> &[(usize, f64)] {
        &self.numbers.prescribed
    }

    /// The prescribed value of a DOF.
    ///
    /// ```
    /// let mut builder = qless::SystemBuilder::new(2);
    /// builder.prescribe(1, 0.5);
    /// let system = builder.build()?;
    /// assert_eq!((system.prescribed_value(1), system.prescribed_value(0)), (Some(0.5), None));
    /// # Ok::<(), qless::SystemError>(())
    /// ```
    pub fn prescribed_value(&self, dof: usize) -> Option<f64> {
        let prescribed = self.prescribed();
        prescribed.binary_search_by_key(&dof, |&(j, _)| j).ok().map(|at| prescribed[at].1)
    }

    /// The place at which the value of a DOF is prescribed, if it is known: [`SystemBuilder::prescribe_at`].
    pub fn prescribed_place(&self, dof: usize) -> Option<&str> {
        let places = &self.labels.places;
        places.binary_search_by_key(&dof, |&(j, _)| j).ok().map(|at| places[at].1.as_str())
    }

    /// The labels of all equations, or an empty list.
    pub fn equation_labels(&self) -> &[String] {
        &self.labels.equations
    }

    /// The labels of all DOFs, or an empty list.
    pub fn dof_labels(&self) -> &[String] {
        &self.labels.dofs
    }

    /// The label of an equation, or `row` and its 1-based number.
    pub fn equation_label(&self, row: usize) -> String {
        self.labels.equations.get(row).map_or_else(|| format!("row {}", from_one(row)), Clone::clone)
    }

    /// The label of a DOF, or `DOF` and its 1-based number.
    pub fn dof_label(&self, dof: usize) -> String {
        self.labels.dofs.get(dof).map_or_else(|| format!("DOF {}", from_one(dof)), Clone::clone)
    }
}

/// `place + 1`, without overflow: a caller may ask for the label of any `usize`.
fn from_one(place: usize) -> u128 {
    place as u128 + 1
}

//! Builds a validated [`ConstraintSystem`] from single equations or from arrays.

use std::sync::Arc;

use rayon::prelude::*;

use super::csr::{check_starts, fits};
use super::{ConstraintSystem, Csr, Numbers, Place, SystemError};

/// Collects equations one by one; nothing is checked before [`SystemBuilder::build`].
#[derive(Clone, Debug, Default)]
pub struct SystemBuilder {
    dofs: usize,
    start: Vec<usize>,
    terms: Vec<(usize, f64)>,
    rhs: Vec<f64>,
    labels: Vec<String>,
    prescribed: Vec<(usize, f64)>,
    /// Prescribed DOFs, each with the place in the input at which its value is prescribed.
    places: Vec<(usize, String)>,
    dof_labels: Vec<String>,
}

impl SystemBuilder {
    /// A builder without equations, on DOFs `0..dofs`.
    pub fn new(dofs: usize) -> Self {
        Self { dofs, start: vec![0], ..Self::default() }
    }

    /// Adds `sum a_j u_j = rhs`; terms on the same DOF are summed. Returns the row.
    pub fn equation(&mut self, terms: impl IntoIterator<Item = (usize, f64)>, rhs: f64) -> usize {
        self.terms.extend(terms);
        self.start.push(self.terms.len());
        self.rhs.push(rhs);
        self.rhs.len() - 1
    }

    /// [`SystemBuilder::equation`] with a label that reports will use.
    pub fn labelled_equation(
        &mut self,
        label: impl Into<String>,
        terms: impl IntoIterator<Item = (usize, f64)>,
        rhs: f64,
    ) -> usize {
        let row = self.equation(terms, rhs);
        self.labels.resize_with(row, String::new);
        self.labels.push(label.into());
        row
    }

    /// Gives a DOF a prescribed value.
    pub fn prescribe(&mut self, dof: usize, value: f64) {
        self.prescribed.push((dof, value));
    }

    /// [`SystemBuilder::prescribe`] with the place of the value, such as `line 17 *BOUNDARY`, that reports will use.
    ///
    /// ```
    /// let mut builder = qless::SystemBuilder::new(2);
    /// builder.equation([(0, 1.0), (1, -1.0)], 0.0);
    /// builder.prescribe_at("line 17", 1, 0.5);
    /// let system = builder.build()?;
    /// assert_eq!((system.prescribed_place(1), system.prescribed_place(0)), (Some("line 17"), None));
    /// # Ok::<(), qless::SystemError>(())
    /// ```
    pub fn prescribe_at(&mut self, place: impl Into<String>, dof: usize, value: f64) {
        self.prescribe(dof, value);
        self.places.push((dof, place.into()));
    }

    /// Sets the labels of all DOFs, in order.
    pub fn dof_labels(&mut self, labels: Vec<String>) {
        self.dof_labels = labels;
    }

    /// Checks everything and sums repeated terms.
    ///
    /// # Errors
    /// [`SystemError`] with the row and the DOF.
    pub fn build(mut self) -> Result<ConstraintSystem, SystemError> {
        let mut matrix = Csr::empty(self.dofs);
        check_sizes(self.rhs.len(), self.dofs)?;
        let mut scratch = Vec::new();
        for (row, range) in self.start.windows(2).enumerate() {
            scratch.clear();
            scratch.extend_from_slice(&self.terms[range[0]..range[1]]);
            push_checked(&mut matrix, row, &mut scratch)?;
        }
        if !self.labels.is_empty() {
            self.labels.resize_with(self.rhs.len(), String::new);
            for (row, label) in self.labels.iter_mut().enumerate().filter(|(_, label)| label.is_empty()) {
                *label = format!("row {}", row + 1);
            }
        }
        let system = finish(matrix, self.rhs, &self.prescribed)?.with_labels(self.labels, self.dof_labels)?;
        Ok(system.with_places(self.places))
    }
}

pub(super) fn from_triplets(
    rows: usize,
    dofs: usize,
    triplets: &[(usize, usize, f64)],
    rhs: &[f64],
    prescribed: &[(usize, f64)],
) -> Result<ConstraintSystem, SystemError> {
    check_sizes(rows, dofs)?;
    // Check before allocating memory for this number of rows.
    check_rhs(rhs, rows)?;
    let mut start = vec![0; rows + 1];
    for (entry, &(row, _, _)) in triplets.iter().enumerate() {
        if row >= rows {
            return Err(SystemError::RowOutOfRange { entry, row, rows });
        }
        start[row + 1] += 1;
    }
    for i in 0..rows {
        start[i + 1] += start[i];
    }
    let mut next = start.clone();
    let mut terms = vec![(0, 0.0); triplets.len()];
    for &(row, dof, value) in triplets {
        terms[next[row]] = (dof, value);
        next[row] += 1;
    }
    let mut matrix = Csr::empty(dofs);
    for row in 0..rows {
        push_checked(&mut matrix, row, &mut terms[start[row]..start[row + 1]])?;
    }
    finish(matrix, rhs.to_vec(), prescribed)
}

pub(super) fn from_csr(
    mut matrix: Csr,
    rhs: Vec<f64>,
    prescribed: &[(usize, f64)],
) -> Result<ConstraintSystem, SystemError> {
    check_sizes(matrix.rows(), matrix.cols)?;
    check_rhs(&rhs, matrix.rows())?;
    if let Some(k) = matrix.val.par_iter().position_first(|v| !v.is_finite()) {
        let row = matrix.start.partition_point(|&start| start <= k) - 1;
        finite(matrix.val[k], Place::Coefficient { row, dof: matrix.col[k] as usize })?;
    }
    if matrix.val.par_iter().any(|&v| v == 0.0) {
        let mut nonzero = Csr::empty(matrix.cols);
        (0..matrix.rows()).for_each(|i| nonzero.append(matrix.row(i).filter(|&(_, v)| v != 0.0)));
        matrix = nonzero;
    }
    finish(matrix, rhs, prescribed)
}

pub(super) fn from_csc(
    rows: usize,
    start: &[usize],
    row: &[usize],
    value: &[f64],
    rhs: &[f64],
    prescribed: &[(usize, f64)],
) -> Result<ConstraintSystem, SystemError> {
    let nnz = row.len();
    check_starts(start, nnz, value.len())?;
    let mut triplets = Vec::with_capacity(nnz);
    for j in 0..start.len() - 1 {
        triplets.extend((start[j]..start[j + 1]).map(|k| (row[k], j, value[k])));
    }
    from_triplets(rows, start.len() - 1, &triplets, rhs, prescribed)
}

fn check_sizes(rows: usize, dofs: usize) -> Result<(), SystemError> {
    fits("the number of equations", rows)?;
    fits("the number of DOFs", dofs)?;
    if dofs == 0 { Err(SystemError::Empty { rows }) } else { Ok(()) }
}

/// Sorts the terms of one row, sums repeats, and drops sums that are zero or cancel to rounding.
fn push_checked(matrix: &mut Csr, row: usize, terms: &mut [(usize, f64)]) -> Result<(), SystemError> {
    for &(dof, value) in &*terms {
        let what = Place::Coefficient { row, dof };
        if dof >= matrix.cols {
            return Err(SystemError::DofOutOfRange { what, dof, dofs: matrix.cols });
        }
        finite(value, what)?;
    }
    if !terms.windows(2).all(|pair| pair[0].0 < pair[1].0) {
        terms.sort_by_key(|&(dof, _)| dof);
    }
    for repeats in terms.chunk_by(|a, b| a.0 == b.0) {
        let dof = repeats[0].0;
        let sum: f64 = repeats.iter().map(|&(_, v)| v).sum();
        finite(sum, Place::Coefficient { row, dof })?;
        let parts = repeats.iter().map(|&(_, v)| v.abs()).fold(0.0, f64::max);
        let cancelled = repeats.len() > 1 && sum.abs() <= 4.0 * f64::EPSILON * parts;
        if sum != 0.0 && !cancelled {
            matrix.col.push(dof as u32);
            matrix.val.push(sum);
        }
    }
    matrix.start.push(matrix.col.len());
    Ok(())
}

fn check_rhs(rhs: &[f64], expected: usize) -> Result<(), SystemError> {
    let found = rhs.len();
    if found == expected {
        Ok(())
    } else {
        Err(SystemError::WrongLength { what: "the right-hand side", found, expected })
    }
}

fn finish(matrix: Csr, rhs: Vec<f64>, prescribed: &[(usize, f64)]) -> Result<ConstraintSystem, SystemError> {
    check_rhs(&rhs, matrix.rows())?;
    for (row, &value) in rhs.iter().enumerate() {
        finite(value, Place::RightHandSide { row })?;
    }
    let prescribed = unique_prescribed(matrix.cols, prescribed)?;
    let numbers = Numbers { matrix, rhs, prescribed };
    Ok(ConstraintSystem { numbers: Arc::new(numbers), labels: Arc::default() })
}

/// Sorts by DOF. A DOF may be given the same value twice, but not two values.
fn unique_prescribed(dofs: usize, given: &[(usize, f64)]) -> Result<Vec<(usize, f64)>, SystemError> {
    for &(dof, value) in given {
        let what = Place::Prescribed { dof };
        if dof >= dofs {
            return Err(SystemError::DofOutOfRange { what, dof, dofs });
        }
        finite(value, what)?;
    }
    let mut sorted = given.to_vec();
    sorted.sort_by_key(|&(dof, _)| dof);
    for pair in sorted.windows(2) {
        if pair[0].0 == pair[1].0 && pair[0].1 != pair[1].1 {
            return Err(SystemError::PrescribedTwice { dof: pair[0].0, first: pair[0].1, second: pair[1].1 });
        }
    }
    sorted.dedup_by_key(|&mut (dof, _)| dof);
    Ok(sorted)
}

fn finite(value: f64, what: Place) -> Result<(), SystemError> {
    if value.is_finite() { Ok(()) } else { Err(SystemError::NotFinite { what, value }) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn repeats_are_summed_and_cancellation_leaves_no_coefficient() {
        let system =
            ConstraintSystem::from_triplets(1, 3, &[(0, 2, 1.0), (0, 0, 0.1), (0, 0, 0.2), (0, 0, -0.3)], &[0.0], &[])
                .expect("valid");
        assert_eq!(system.matrix().row(0).collect::<Vec<_>>(), [(2, 1.0)]);
    }

    #[test]
    fn csc_and_triplets_agree() {
        let a = ConstraintSystem::from_csc(2, &[0, 1, 3], &[1, 0, 1], &[4.0, 5.0, 6.0], &[1.0, 2.0], &[(1, 0.5)]);
        let b =
            ConstraintSystem::from_triplets(2, 2, &[(0, 1, 5.0), (1, 1, 6.0), (1, 0, 4.0)], &[1.0, 2.0], &[(1, 0.5)]);
        assert_eq!(a.expect("valid"), b.expect("valid"));
    }

    #[test]
    fn every_fault_is_named() {
        let build = |t: &[(usize, usize, f64)], b: &[f64], p: &[(usize, f64)]| {
            ConstraintSystem::from_triplets(2, 2, t, b, p).expect_err("invalid").to_string()
        };
        assert!(build(&[(0, 2, 1.0)], &[0.0; 2], &[]).contains("names DOF 2"));
        assert!(build(&[(2, 0, 1.0)], &[0.0; 2], &[]).contains("row 2"));
        assert!(build(&[(1, 0, f64::NAN)], &[0.0; 2], &[]).contains("row 1, DOF 0 is NaN"));
        assert!(build(&[], &[0.0, f64::INFINITY], &[]).contains("right-hand side of row 1 is inf"));
        assert!(build(&[], &[0.0; 3], &[]).contains("3 entries, expected 2"));
        assert!(build(&[], &[0.0; 2], &[(1, 1.0), (1, 2.0)]).contains("prescribed twice, as 1 and as 2"));
        assert!(build(&[], &[0.0; 2], &[(0, f64::NAN)]).contains("prescribed value of DOF 0 is NaN"));
        assert!(build(&[(0, 0, 1e308), (0, 0, 1e308)], &[0.0; 2], &[]).contains("is inf"));
        assert!(matches!(ConstraintSystem::from_triplets(0, 0, &[], &[], &[]), Err(SystemError::Empty { rows: 0 })));
        assert!(matches!(
            ConstraintSystem::from_csc(1, &[0, 2, 1], &[0], &[1.0], &[0.0], &[]),
            Err(SystemError::BadStarts { index: 1, value: 2 })
        ));
    }
}

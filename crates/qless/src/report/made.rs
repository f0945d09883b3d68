//! Reports of an analysis that was made elsewhere, such as on many ranks.

use super::{
    BackendUsed, Certificate, Counts, DependentEquation, GeneratedCondition, InputSizes, Milliseconds, Omitted, Report,
    Term, Unmet,
};
use crate::{Confidence, Kind};

impl Report {
    /// A report of an analysis that `ranks` ranks made together, without lists: its fields are public. What presolve did is not known.
    ///
    /// ```
    /// use qless::{Confidence, Kind, Report, Status};
    /// use qless::report::{BackendUsed, Certificate, Counts, DependentEquation, InputSizes, Term};
    /// let (input, counts) = (InputSizes::new(2, 3, 4, 0), Counts::new(1, 1, 0));
    /// let backend = BackendUsed::new("faer", 1, "faer 0.24".to_owned());
    /// let mut report = Report::of_ranks(2, input, counts, Confidence::of(1.0, 0.0, false), backend);
    /// let because = Certificate::of(vec![Term::new(1, "tie 7".to_owned(), 2.0)]);
    /// report.dependent.push(DependentEquation::new(2, "tie 8".to_owned(), Kind::Redundant, 0.0, because));
    /// assert_eq!((report.rank, report.status, report.ranks), (1, Status::Redundant, Some(2)));
    /// ```
    pub fn of_ranks(
        ranks: usize,
        input: InputSizes,
        counts: Counts,
        confidence: Confidence,
        backend: BackendUsed,
    ) -> Self {
        Self {
            schema: Self::SCHEMA,
            input,
            status: counts.status().into(),
            rank: counts.independent,
            counts,
            dependent: Vec::new(),
            generated_boundary_conditions: Vec::new(),
            confidence,
            incomplete: Vec::new(),
            exact_rank: None,
            meant: None,
            reduction: None,
            unmet_preferences: Unmet::default(),
            ignored_coefficients: Vec::new(),
            presolve: None,
            ranks: Some(ranks),
            backend,
            timings_ms: Milliseconds::default(),
        }
    }
}

impl InputSizes {
    /// Sizes of a system; DOFs that are not prescribed are free.
    pub fn new(rows: usize, dofs: usize, nnz: usize, prescribed: usize) -> Self {
        Self { rows, dofs, nnz, free: dofs - prescribed, prescribed }
    }
}

impl Counts {
    /// Equations of each kind.
    pub fn new(independent: usize, redundant: usize, conflicting: usize) -> Self {
        Self { independent, redundant, conflicting }
    }
}

impl BackendUsed {
    /// As [`backend::Backend`](crate::backend::Backend) tells them, and threads at work.
    pub fn new(name: &'static str, threads: usize, version: String) -> Self {
        Self { name, threads, version }
    }
}

impl DependentEquation {
    /// The row counts from 1.
    pub fn new(row: usize, label: String, kind: Kind, mismatch: f64, certificate: Certificate) -> Self {
        Self { row, label, kind, mismatch, certificate }
    }
}

impl GeneratedCondition {
    /// The DOF counts from 1.
    pub fn new(dof: usize, label: String, value: f64, certificate: Certificate) -> Self {
        Self { dof, label, value, certificate }
    }
}

impl Certificate {
    /// All of its terms.
    pub fn of(because: Vec<Term>) -> Self {
        Self { because, omitted: Omitted::Nothing }
    }

    /// One that is left out.
    pub fn left_out(omitted: Omitted) -> Self {
        Self { because: Vec::new(), omitted }
    }
}

impl Term {
    /// The row counts from 1.
    pub fn new(row: usize, label: String, coefficient: f64) -> Self {
        Self { row, label, coefficient }
    }
}

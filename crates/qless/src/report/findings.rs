//! The lists of a report: equations, generated boundary conditions and coefficients.

use crate::explanation::Member;
use crate::{CertificateTerm, ConstraintSystem, Kind};

/// The result if numbers that may be rounding are read the other way: [`crate::diagnosis::OtherReading`].
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct OtherReadingFinding {
    /// True if the coefficients count as zero in this reading, false if they count as given.
    pub as_zero: bool,
    /// The rank in this reading.
    pub rank: usize,
    /// Number of conflicting equations in this reading.
    pub conflicting: usize,
    /// The coefficients that are read differently.
    pub coefficients: Vec<NoiseCoefficient>,
}

impl OtherReadingFinding {
    pub(super) fn new(other: &crate::diagnosis::OtherReading) -> Self {
        let coefficients = other.terms.iter().map(NoiseCoefficient::new).collect();
        Self { as_zero: other.as_zero, rank: other.rank, conflicting: other.conflicting, coefficients }
    }
}

/// A coefficient that may be rounding of others: [`crate::diagnosis::NoiseTerm`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct NoiseCoefficient {
    /// The row of the coefficient, from 1.
    pub row: usize,
    /// The DOF of the coefficient, from 1.
    pub dof: usize,
    /// The value of the coefficient.
    pub coefficient: f64,
}

impl NoiseCoefficient {
    pub(super) fn new(term: &crate::diagnosis::NoiseTerm) -> Self {
        Self { row: term.row + 1, dof: term.dof + 1, coefficient: term.coefficient }
    }
}

/// A redundant or conflicting equation.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct DependentEquation {
    /// The row of the equation, from 1.
    pub row: usize,
    /// The label of the equation.
    pub label: String,
    /// Redundant or conflicting.
    pub kind: Kind,
    /// `b_k - sum c_i b_i` in the units of the equation, with prescribed DOFs moved into b.
    pub mismatch: f64,
    /// For a conflict, the sum of the members and the right-hand side of the equation, in words:
    /// [`Explanation::arithmetic`](crate::explanation::Explanation::arithmetic); the key is absent otherwise.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub arithmetic: Option<String>,
    /// The explanation of the equation. A serialized report has its keys in place of this field: `because` and, if they apply,
    /// `because_omitted`, `because_error` and `because_irreducible`.
    #[cfg_attr(feature = "serde", serde(flatten))]
    pub certificate: Certificate,
}

/// A free DOF that the equations fix.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct GeneratedCondition {
    /// The DOF, from 1.
    pub dof: usize,
    /// The label of the DOF.
    pub label: String,
    /// The only value of the DOF that the equations allow.
    pub value: f64,
    /// The explanation of the fixed DOF. A serialized report has its keys in place of this field: `because` and, if they apply,
    /// `because_omitted`, `because_error` and `because_irreducible`.
    #[cfg_attr(feature = "serde", serde(flatten))]
    pub certificate: Certificate,
}

/// An explanation or a certificate, or the reason why it is omitted.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Certificate {
    /// The terms, ascending. Empty if they are omitted, and for the equation `0 = b`, which is a combination of no equations.
    pub because: Vec<Term>,
    /// The number of omitted terms, if any.
    #[cfg_attr(feature = "serde", serde(rename = "because_omitted", skip_serializing_if = "Omitted::is_nothing"))]
    pub omitted: Omitted,
    /// Error of the coefficients, [`Analysis::because_error`](crate::Analysis::because_error); the key is absent if it is at most the
    /// tolerance.
    #[cfg_attr(feature = "serde", serde(rename = "because_error", skip_serializing_if = "Option::is_none"))]
    pub error: Option<f64>,
    /// [`Explanation::is_irreducible`](crate::explanation::Explanation::is_irreducible); the key is absent if it is true.
    #[cfg_attr(feature = "serde", serde(rename = "because_irreducible", skip_serializing_if = "bool::clone"))]
    pub is_irreducible: bool,
}

/// `coefficient` times an equation or a prescribed value.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(untagged))]
#[non_exhaustive]
pub enum Term {
    /// `coefficient` times an equation.
    Equation {
        /// The row of the equation, from 1.
        row: usize,
        /// The label of the equation.
        label: String,
        /// The factor of the equation.
        coefficient: f64,
    },
    /// `coefficient` times `u_dof = value`.
    Prescribed {
        /// The prescribed DOF, from 1.
        dof: usize,
        /// The label of the DOF.
        label: String,
        /// The prescribed value of the DOF.
        value: f64,
        /// The place in the input, such as `line 17 *BOUNDARY`; the key is absent if it is not known.
        #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
        place: Option<String>,
        /// The factor of the equation `u_dof = value`.
        coefficient: f64,
    },
}

/// The omitted part of a certificate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Omitted {
    /// Nothing is omitted: the JSON key is absent.
    Nothing,
    /// All terms are omitted; the number is how many.
    Terms(usize),
    /// The certificate was not computed; serializes as null.
    NotComputed,
}

impl Omitted {
    #[cfg(feature = "serde")]
    fn is_nothing(&self) -> bool {
        *self == Self::Nothing
    }
}

#[cfg(feature = "serde")]
impl serde::Serialize for Omitted {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match *self {
            Self::Terms(count) => serializer.serialize_u64(count as u64),
            Self::Nothing | Self::NotComputed => serializer.serialize_none(),
        }
    }
}

impl DependentEquation {
    /// A dependent equation with this certificate; `row` counts from 1.
    pub fn new(row: usize, label: String, kind: Kind, mismatch: f64, certificate: Certificate) -> Self {
        Self { row, label, kind, mismatch, arithmetic: None, certificate }
    }
}

impl GeneratedCondition {
    /// A generated boundary condition with this certificate; `dof` counts from 1.
    pub fn new(dof: usize, label: String, value: f64, certificate: Certificate) -> Self {
        Self { dof, label, value, certificate }
    }
}

impl Certificate {
    /// A certificate with all of its terms.
    pub fn complete(because: Vec<Term>) -> Self {
        Self { because, omitted: Omitted::Nothing, error: None, is_irreducible: true }
    }

    /// A complete certificate with the labels of a system.
    pub(super) fn labelled(system: &ConstraintSystem, because: &[CertificateTerm]) -> Self {
        let term = |t: &CertificateTerm| Term::equation(t.row + 1, system.equation_label(t.row), t.coefficient);
        Self::complete(because.iter().map(term).collect())
    }

    /// An explanation with the labels of its system.
    pub fn of_members(system: &ConstraintSystem, members: &[Member]) -> Self {
        let term = |&member: &Member| match member {
            Member::Equation { row, coefficient } => Term::equation(row + 1, system.equation_label(row), coefficient),
            Member::Prescribed { dof, value, coefficient } => Term::Prescribed {
                dof: dof + 1,
                label: system.dof_label(dof),
                value,
                place: system.prescribed_place(dof).map(str::to_owned),
                coefficient,
            },
        };
        Self::complete(members.iter().map(term).collect())
    }

    /// A certificate whose terms are omitted.
    pub fn left_out(omitted: Omitted) -> Self {
        Self { because: Vec::new(), omitted, error: None, is_irreducible: true }
    }
}

impl Term {
    /// Makes an equation a term of the sum that explains another one. `row` counts from 1; `coefficient` is the factor of the equation in
    /// this sum.
    pub fn equation(row: usize, label: String, coefficient: f64) -> Self {
        Self::Equation { row, label, coefficient }
    }

    /// The factor of the term.
    pub fn coefficient(&self) -> f64 {
        match self {
            Self::Equation { coefficient, .. } | Self::Prescribed { coefficient, .. } => *coefficient,
        }
    }
}

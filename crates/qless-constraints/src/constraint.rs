//! The trait of constraint types, and the [`EquationSink`] that receives their equations.
//!
//! | duty of a type | here |
//! | --- | --- |
//! | check the input, keep the parameters | [`Constraint::emit`] |
//! | list of DOFs, list of DOF pairs | the DOFs given to [`EquationSink`], [`Nonlinear::pairs`] |
//! | value `c_i`, Jacobian rows `G_i` | [`Nonlinear::value_and_jacobian`] |
//! | effective Hessian `sum_r w_r H_r` | [`Nonlinear::hessian`]; not needed by linear types |
//!
//! The constraint library of dockSIM (Boungard and Wackerfuß) divides a type into the same four functions. A new type needs one file. It
//! implements [`Constraint`] and, if it has nonlinear equations, [`Nonlinear`].

use std::borrow::Cow;
use std::sync::Arc;

use crate::equations::LinearRhs;
use crate::equations::contents::ConstraintContents;
use crate::equations::dof_uses::{DofStatement, NO_DOF};
use crate::equations::linear::{LinearTerms, StagedEquation};
use crate::equations::nonlinear::typed::StagedItem;
use crate::geometry::node::Node;
pub use crate::nonlinear::Nonlinear;
use crate::scalar::SUM_ROUNDING;

/// A constraint type. A value of this type is the input of one constraint, which [`Constraint::emit`] turns into equations.
///
/// ```
/// use qless_constraints::{Constraint, ConstraintSet, EquationSink};
/// /// `u_a = f u_b`: a gear.
/// struct Gear {
///     a: usize,
///     b: usize,
///     ratio: f64,
/// }
/// #[derive(Debug, thiserror::Error)]
/// #[error("the ratio of a gear is zero")]
/// struct NoRatio;
/// impl Constraint for Gear {
///     const NAME: &'static str = "gear";
///     type Error = NoRatio;
///     fn emit(self, sink: &mut EquationSink) -> Result<(), NoRatio> {
///         if self.ratio == 0.0 {
///             return Err(NoRatio);
///         }
///         sink.equation("", [(self.a, 1.0), (self.b, -self.ratio)], 0.0);
///         Ok(())
///     }
/// }
/// let mut builder = ConstraintSet::builder(2);
/// builder.add("gear 1", Gear { a: 0, b: 1, ratio: 2.0 })?;
/// let error = builder.add("gear 2", Gear { a: 0, b: 1, ratio: 0.0 }).unwrap_err();
/// assert_eq!(error.to_string(), "gear \"gear 2\": the ratio of a gear is zero");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait Constraint {
    /// Name of the type in messages.
    const NAME: &'static str;
    /// A fault of the input.
    type Error: std::error::Error + Send + Sync + 'static;

    /// Checks the input and emits its linear and nonlinear equations.
    ///
    /// # Errors
    /// A fault of the input; nothing is added then. The sink itself refuses DOFs out of range, repeated DOFs of nonlinear equations, and
    /// numbers that are not finite, in equations or in [`EquationSink::numbers`]. So a type need not check these.
    fn emit(self, sink: &mut EquationSink) -> Result<(), Self::Error>;
}

/// Largest coordinate or length that is accepted. Sixth powers of it and of its inverse, which occur in derivatives of normals and volumes,
/// are finite.
const LARGEST: f64 = 1e50;
/// Repetitions in a list of up to this many entries are found by comparing all entries; longer lists are sorted first. A new statement
/// about DOFs is compared with this many of the latest statements, to drop repetitions.
const FEW: usize = 16;

/// Receives the linear and nonlinear equations of the constraint that is being added.
pub struct EquationSink {
    dofs: usize,
    time: f64,
    pub(crate) contents: ConstraintContents,
    pub(crate) fault: Option<EquationError>,
}

impl std::fmt::Debug for EquationSink {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut text = f.debug_struct("EquationSink");
        text.field("dofs", &self.dofs).field("rows", &self.rows()).field("fault", &self.fault).finish_non_exhaustive()
    }
}

impl EquationSink {
    /// An empty sink for one constraint; `dofs` is the number of DOFs of the model.
    pub(crate) fn new(dofs: usize, time: f64) -> Self {
        Self { dofs, time, contents: ConstraintContents::default(), fault: None }
    }

    /// Number of equations so far.
    pub(crate) fn rows(&self) -> usize {
        self.contents.rows()
    }

    /// Number of DOFs of the model.
    pub fn dofs(&self) -> usize {
        self.dofs
    }

    /// Adds `sum a_j u_j = rhs`; terms on the same DOF are summed. `name` distinguishes the equations of one constraint.
    ///
    /// If the terms of a DOF cancel up to rounding, its coefficient is set to zero. Otherwise a residue of 1e-17 would count as a
    /// coefficient, and add to the rank.
    pub fn equation(
        &mut self,
        name: impl Into<Cow<'static, str>>,
        terms: impl IntoIterator<Item = (usize, f64)>,
        rhs: f64,
    ) {
        self.check_number(rhs);
        self.put(name.into(), terms, LinearRhs::Value(rhs));
    }

    /// Adds `sum a_j u_j = b(t)`, where t is the time of the set: 0, until [`crate::ConstraintSet::set_time`] changes it.
    pub fn equation_in_time(
        &mut self,
        name: impl Into<Cow<'static, str>>,
        terms: impl IntoIterator<Item = (usize, f64)>,
        rhs: impl Fn(f64) -> f64 + Send + Sync + 'static,
    ) {
        self.check_number(rhs(self.time));
        self.put(name.into(), terms, LinearRhs::TimeFunction(Arc::new(rhs)));
    }

    fn put(&mut self, name: Cow<'static, str>, terms: impl IntoIterator<Item = (usize, f64)>, rhs: LinearRhs) {
        let terms = terms.into_iter();
        let mut sorted = Vec::with_capacity(terms.size_hint().0);
        let mut ascends = true;
        for (dof, value) in terms {
            self.check_dof(dof);
            self.check_number(value);
            ascends &= sorted.last().is_none_or(|&(last, _)| last < dof as u32);
            sorted.push((dof as u32, value));
        }
        if !ascends {
            sorted = summed(sorted);
        }
        if self.fault.is_none() {
            self.contents.equations.push(StagedEquation { name, terms: sorted, rhs });
        }
    }

    /// Adds the nonlinear equations of `parameters` on these DOFs, which must differ.
    pub fn nonlinear<Q: Nonlinear>(&mut self, name: impl Into<Cow<'static, str>>, dofs: &[usize], mut parameters: Q) {
        if Q::DOFS != 0 && Q::DOFS != dofs.len() {
            self.fail(EquationError::DofCount { found: dofs.len(), expected: Q::DOFS });
        }
        if dofs.is_empty() {
            self.fail(EquationError::NothingMoves);
        }
        if let Some(&dof) = dofs.iter().find(|&&dof| dof >= self.dofs) {
            self.check_dof(dof);
        }
        if let Some(dof) = repeated(dofs) {
            self.fail(EquationError::RepeatedDof { dof });
        }
        if Q::DRIVEN
            && let Err(value) = parameters.at_time(self.time)
        {
            self.fail(EquationError::NotFinite { value });
        }
        if self.fault.is_none() {
            let all = &mut self.contents.dofs;
            let first = all.len();
            all.extend(dofs.iter().map(|&dof| dof as u32));
            let own = first..all.len();
            self.contents.pieces.push(Box::new(StagedItem { name: name.into(), dofs: own, parameters }));
        }
    }

    /// States that DOF u displaces a reference coordinate: `x = at + u`. The uncertainty of x is then at least the rounding error of `at`.
    ///
    /// A type whose parameters hold only differences of coordinates must state the coordinates, for [`crate::ConstraintSet::rounding`]. A
    /// DOF has one coordinate: a different one, from this or from another constraint, is refused.
    pub fn coordinate(&mut self, dof: usize, at: f64) {
        self.place(&[dof], &[at], true);
    }

    /// [`EquationSink::coordinate`] for all translations of a node.
    pub fn coordinates_of<const D: usize>(&mut self, node: &Node<D>) {
        self.place(&node.dofs, &node.at, true);
    }

    /// States that these DOFs displace a node or body from `at`. If `measured`, the equations hold only differences of coordinates; the
    /// rounding errors of `at` then count as errors of the DOFs.
    pub(crate) fn place(&mut self, dofs: &[usize], at: &[f64], measured: bool) {
        self.numbers(at.iter().copied());
        for (dofs, at) in dofs.chunks(3).zip(at.chunks(3)) {
            let mut of_chunk = [0.0; 3];
            of_chunk[..at.len()].copy_from_slice(at);
            let dofs = self.listed(dofs);
            self.state(DofStatement::Place { dofs, at: of_chunk, measured });
        }
    }

    /// States that these DOFs are the rotation of a body: the three components of a rotation vector, or `p - (1, 0, 0, 0)` of four Euler
    /// parameters p, which the set keeps at length one.
    ///
    /// The DOFs of a rotation have no other use. The set refuses a constraint that lists them in another order, or uses them as
    /// displacements.
    pub fn rotation(&mut self, dofs: &[usize]) {
        if !(3..=4).contains(&dofs.len()) {
            self.fail(EquationError::DofCount { found: dofs.len(), expected: 4 });
        }
        if let Some(dof) = repeated(dofs) {
            self.fail(EquationError::RepeatedDof { dof });
        }
        let dofs = self.listed(dofs);
        self.state(DofStatement::Rotation(dofs));
    }

    /// Checks the DOFs, and fills unused entries of the result with [`NO_DOF`].
    fn listed<const N: usize>(&mut self, dofs: &[usize]) -> [u32; N] {
        dofs.iter().for_each(|&dof| self.check_dof(dof));
        std::array::from_fn(|k| dofs.get(k).map_or(NO_DOF, |&dof| dof as u32))
    }

    fn state(&mut self, statement: DofStatement) {
        let all = &mut self.contents.statements;
        // A joint repeats the statements about its bodies for each of its equations. One copy is enough.
        let known = all.iter().rev().take(FEW).any(|other| *other == statement);
        if self.fault.is_none() && !known {
            all.push(statement);
        }
    }

    /// States that the parameters of nonlinear equations contain these numbers, such as coordinates. Each must be finite and at most 1e50
    /// in magnitude, so that powers of it are finite too.
    ///
    /// Linear equations need no such statement, since the sink sees all of their numbers.
    pub fn numbers(&mut self, numbers: impl IntoIterator<Item = f64>) {
        for value in numbers {
            // False for NaN.
            let fits = value.abs() <= LARGEST;
            if !fits {
                self.check_number(value);
                self.fail(EquationError::OutOfRange { value });
            }
        }
    }

    /// States that nonlinear equations contain powers of this length, also as divisors. It must lie between 1e-50 and 1e50.
    pub fn length(&mut self, value: f64) {
        self.numbers([value]);
        if value.abs() < 1.0 / LARGEST {
            self.fail(EquationError::OutOfRange { value });
        }
    }

    fn check_dof(&mut self, dof: usize) {
        if dof >= self.dofs {
            self.fail(EquationError::DofOutOfRange { dof, dofs: self.dofs });
        }
    }

    fn check_number(&mut self, value: f64) {
        if !value.is_finite() {
            self.fail(EquationError::NotFinite { value });
        }
    }

    /// Keeps the first fault, which is the one reported.
    fn fail(&mut self, fault: EquationError) {
        self.fault.get_or_insert(fault);
    }
}

/// Sorts terms by DOF, and sums those on the same DOF.
fn summed(mut terms: LinearTerms) -> LinearTerms {
    terms.sort_by_key(|&(dof, _)| dof);
    if terms.windows(2).any(|two| two[0].0 == two[1].0) {
        terms = terms.chunk_by(|a, b| a.0 == b.0).map(|same| (same[0].0, sum(same))).collect();
    }
    terms
}

/// The sum of the coefficients of one DOF; zero if only rounding is left of them.
fn sum(same: &[(u32, f64)]) -> f64 {
    let sum: f64 = same.iter().map(|&(_, v)| v).sum();
    let size: f64 = same.iter().map(|&(_, v)| v.abs()).sum();
    if same.len() > 1 && sum.abs() <= SUM_ROUNDING * size { 0.0 } else { sum }
}

/// The smallest DOF that occurs twice.
pub(crate) fn repeated(dofs: &[usize]) -> Option<usize> {
    if dofs.is_sorted_by(|a, b| a < b) {
        return None;
    }
    if dofs.len() <= FEW {
        let twice = |&(k, dof): &(usize, &usize)| dofs[..k].contains(dof);
        return dofs.iter().enumerate().filter(twice).map(|(_, &dof)| dof).min();
    }
    let mut sorted = dofs.to_vec();
    sorted.sort_unstable();
    sorted.windows(2).find(|pair| pair[0] == pair[1]).map(|pair| pair[0])
}

/// A fault that the equations of any type can have. DOFs are 0-based.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EquationError {
    /// A DOF number is not below the number of DOFs.
    #[error("it names DOF {dof}, but there are {dofs} DOFs (0 to {}); correct the number or the size", dofs.saturating_sub(1))]
    DofOutOfRange {
        /// The DOF.
        dof: usize,
        /// Number of DOFs.
        dofs: usize,
    },
    /// A nonlinear equation or a rotation names one DOF twice.
    #[error("it names DOF {dof} twice; each of its points and bodies needs DOFs of its own")]
    RepeatedDof {
        /// The DOF.
        dof: usize,
    },
    /// Two constraints give a node or body different coordinates.
    #[error(
        "it says that DOF {dof} displaces the coordinate {here}, but {other:?} says {there}; give each body one place, or its own DOFs"
    )]
    TwoPlaces {
        /// The DOF.
        dof: usize,
        /// The coordinate in this constraint.
        here: f64,
        /// Label of the other constraint.
        other: String,
        /// The coordinate in the other constraint.
        there: f64,
    },
    /// Two constraints state different rotations with one DOF: they differ in a DOF, in the order of DOFs, or in the parametrisation.
    #[error("DOF {dof} belongs to another rotation in {other:?}; name the rotation DOFs of a body in one way")]
    TwoRotations {
        /// The DOF.
        dof: usize,
        /// Label of the other constraint.
        other: String,
    },
    /// A DOF is a rotation in one constraint and a displacement in another.
    #[error(
        "DOF {dof} is a rotation in one constraint and a displacement in another, here and in {other:?}; correct its number"
    )]
    TwoUses {
        /// The DOF.
        dof: usize,
        /// Label of the other constraint.
        other: String,
    },
    /// A nonlinear equation has another number of DOFs than its type requires, or a rotation has neither three nor four DOFs.
    #[error("it names {found} DOFs, but its type has {expected}")]
    DofCount {
        /// Number of DOFs given.
        found: usize,
        /// Number of DOFs required; 4 for a rotation, although 3 are also allowed.
        expected: usize,
    },
    /// An inequality has no equation, or more than one.
    #[error("it has {found} equations; an inequality has one")]
    NotOne {
        /// Number of equations.
        found: usize,
    },
    /// A nonlinear equation has no DOFs, since all of its points belong to the ground.
    #[error("nothing in it can move; at least one of its points must belong to a node or to a body")]
    NothingMoves,
    /// A coefficient, a right-hand side or a coordinate is NaN or infinite.
    #[error("it contains the number {value}; every number must be finite")]
    NotFinite {
        /// The number.
        value: f64,
    },
    /// Powers of a coordinate or length of a nonlinear equation overflow or vanish.
    #[error(
        "it contains the coordinate or length {value}, so that powers of it overflow or vanish; choose a unit in which lengths lie \
         between 1e-50 and 1e50"
    )]
    OutOfRange {
        /// The number.
        value: f64,
    },
    /// More equations, DOFs or constraints than 32 bits can number.
    #[error("the set would have {found} {what}; the limit is 4294967294")]
    TooLarge {
        /// The quantity that exceeds the limit.
        what: &'static str,
        /// The number of equations, DOFs or constraints.
        found: usize,
    },
}

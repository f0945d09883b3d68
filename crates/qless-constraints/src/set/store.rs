//! Where a constraint type puts what it consists of, after it has checked its input.

use std::borrow::Cow;
use std::ops::Range;
use std::sync::Arc;

use super::StoreError;
use super::batch::Terms;
use super::block::{Blocks, Place};
use super::labels::{Owner, Parts};
use super::stated::Coordinate;
use super::time::Rhs;
use crate::constraint::Nonlinear;
use crate::geometry::node::Node;

/// Sixth powers of lengths between this and one over it are numbers: derivatives of normals and volumes have them.
const LARGEST: f64 = 1e50;
/// DOFs that are compared each with each; more are sorted.
const FEW: usize = 16;

/// The linear equations and nonlinear parts of the constraint that is being added.
#[derive(Default)]
pub struct Store {
    dofs: usize,
    time: f64,
    pub(super) contents: Box<Contents>,
    pub(super) fault: Option<StoreError>,
}

/// What one constraint consists of, as long as it is not among the equations of a set.
#[derive(Default)]
pub(super) struct Contents {
    pub equations: Vec<Equation>,
    pub pieces: Vec<Box<dyn Piece>>,
    /// The DOFs of all pieces.
    pub dofs: Vec<u32>,
    /// What DOFs add to.
    pub coordinates: Vec<Coordinate>,
}

/// Parts of a constraint whose room is kept for the next one.
const KEPT: usize = 256;

/// Sums of terms on one DOF below so many units in the last place of what was summed are what rounding left of a zero.
const CANCELLED: f64 = 8.0 * f64::EPSILON;

impl Contents {
    /// Gives its equations, as many, these right-hand sides.
    pub fn set_rhs(&mut self, rhs: &[f64]) {
        self.equations.iter_mut().zip(rhs).for_each(|(equation, &rhs)| equation.rhs = Rhs::Value(rhs));
    }

    /// Nothing, with the room that a constraint of usual size needs.
    pub fn emptied(mut self: Box<Self>) -> Option<Box<Self>> {
        let Self { equations, pieces, dofs, coordinates } = &mut *self;
        let room = equations.capacity() + pieces.capacity() + dofs.capacity() + coordinates.capacity();
        equations.clear();
        pieces.clear();
        dofs.clear();
        coordinates.clear();
        (room <= KEPT).then_some(self)
    }

    /// Takes the numbers of this time; as an error one that is not finite.
    pub fn at_time(&mut self, time: f64) -> Result<(), f64> {
        let values = self.equations.iter().map(|equation| equation.rhs.at(time));
        let bad = values.into_iter().find(|value| !value.is_finite());
        bad.map_or(Ok(()), Err)?;
        self.pieces.iter_mut().try_for_each(|piece| piece.at_time(time))
    }

    pub fn rows(&self) -> usize {
        self.equations.len() + self.pieces.iter().map(|piece| piece.rows()).sum::<usize>()
    }
}

impl std::fmt::Debug for Store {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut text = f.debug_struct("Store");
        text.field("equations", &self.contents.equations.len()).field("pieces", &self.contents.pieces.len());
        text.field("fault", &self.fault).finish_non_exhaustive()
    }
}

/// `sum a_j u_j = rhs`, DOFs ascending.
pub(super) struct Equation {
    pub part: Cow<'static, str>,
    pub terms: Terms,
    pub rhs: Rhs,
}

impl Store {
    /// With an empty room for what comes.
    pub(super) fn new(dofs: usize, time: f64, contents: Box<Contents>) -> Self {
        Self { dofs, time, contents, fault: None }
    }

    /// Number of DOFs of the model.
    pub fn dofs(&self) -> usize {
        self.dofs
    }

    /// Adds `sum a_j u_j = rhs`; terms on the same DOF are summed. `part` tells the equations of one constraint apart.
    ///
    /// Where terms cancel but for their rounding, the sum is zero: noise of 1e-17 would make a coefficient, and a rank.
    pub fn equation(
        &mut self,
        part: impl Into<Cow<'static, str>>,
        terms: impl IntoIterator<Item = (usize, f64)>,
        rhs: f64,
    ) {
        self.check_number(rhs);
        self.put(part.into(), terms, Rhs::Value(rhs));
    }

    /// Adds `sum a_j u_j = b(t)` for the time t of the set, 0 until [`crate::ConstraintSet::set_time`] says otherwise.
    pub fn equation_in_time(
        &mut self,
        part: impl Into<Cow<'static, str>>,
        terms: impl IntoIterator<Item = (usize, f64)>,
        rhs: impl Fn(f64) -> f64 + Send + Sync + 'static,
    ) {
        self.check_number(rhs(self.time));
        self.put(part.into(), terms, Rhs::Function(Arc::new(rhs)));
    }

    fn put(&mut self, part: Cow<'static, str>, terms: impl IntoIterator<Item = (usize, f64)>, rhs: Rhs) {
        let terms = terms.into_iter();
        let mut sorted: Terms = Vec::with_capacity(terms.size_hint().0);
        for (dof, value) in terms {
            self.check_dof(dof);
            self.check_number(value);
            sorted.push((dof as u32, value));
        }
        sorted.sort_by_key(|&(dof, _)| dof);
        if sorted.windows(2).any(|two| two[0].0 == two[1].0) {
            sorted = sorted.chunk_by(|a, b| a.0 == b.0).map(|same| (same[0].0, sum(same))).collect();
        }
        self.contents.equations.push(Equation { part, terms: sorted, rhs });
    }

    /// Adds the nonlinear equations of `parameters` on the DOFs listed, each of which must occur once.
    pub fn nonlinear<Q: Nonlinear>(&mut self, part: impl Into<Cow<'static, str>>, dofs: &[usize], mut parameters: Q) {
        if Q::DOFS != 0 && Q::DOFS != dofs.len() {
            self.fail(StoreError::DofCount { found: dofs.len(), expected: Q::DOFS });
        }
        if let Some(&dof) = dofs.iter().find(|&&dof| dof >= self.dofs) {
            self.check_dof(dof);
        }
        if let Some(dof) = repeated(dofs) {
            self.fail(StoreError::RepeatedDof { dof });
        }
        if Q::DRIVEN
            && let Err(value) = parameters.at_time(self.time)
        {
            self.fail(StoreError::NotFinite { value });
        }
        let first = self.contents.dofs.len();
        self.contents.dofs.extend(dofs.iter().map(|&dof| dof as u32));
        let dofs = first..self.contents.dofs.len();
        self.contents.pieces.push(Box::new(Staged { part: part.into(), dofs, parameters }));
    }

    /// States that a DOF moves what is at this coordinate for u = 0, `x = at + u`: of x no more is known than its last place.
    ///
    /// For types that keep differences of coordinates only, for [`crate::ConstraintSet::rounding`].
    pub fn coordinate(&mut self, dof: usize, at: f64) {
        self.numbers([at]);
        self.contents.coordinates.extend((at != 0.0).then(|| Coordinate::new(dof, at, at)));
    }

    /// [`Store::coordinate`] of all translations of a node.
    pub fn coordinates_of<const D: usize>(&mut self, node: &Node<D>) {
        let largest = node.at.iter().fold(0.0, |most: f64, at| most.max(at.abs()));
        self.numbers(node.at);
        let each = node.dofs.iter().zip(node.at).map(|(&dof, at)| Coordinate::new(dof, at, largest));
        self.contents.coordinates.extend(each.filter(|_| largest != 0.0));
    }

    /// States that the parameters of a nonlinear part hold these numbers, as coordinates: each must be finite, and no larger than 1e50, so
    /// that powers of it are finite too.
    ///
    /// Linear equations need no such statement: the store sees all of their numbers.
    pub fn numbers(&mut self, numbers: impl IntoIterator<Item = f64>) {
        for value in numbers {
            self.check_number(value);
            if value.abs() > LARGEST {
                self.fail(StoreError::OutOfRange { value });
            }
        }
    }

    /// States that a nonlinear part has powers of this length, also as divisors: it must lie between 1e-50 and 1e50.
    pub fn length(&mut self, value: f64) {
        self.numbers([value]);
        if value.abs() < 1.0 / LARGEST {
            self.fail(StoreError::OutOfRange { value });
        }
    }

    fn check_dof(&mut self, dof: usize) {
        if dof >= self.dofs {
            self.fail(StoreError::DofOutOfRange { dof, dofs: self.dofs });
        }
    }

    fn check_number(&mut self, value: f64) {
        if !value.is_finite() {
            self.fail(StoreError::NotFinite { value });
        }
    }

    /// The first fault is the one reported.
    fn fail(&mut self, fault: StoreError) {
        self.fault.get_or_insert(fault);
    }
}

/// The coefficient of a DOF, from its terms.
fn sum(same: &[(u32, f64)]) -> f64 {
    let sum: f64 = same.iter().map(|&(_, v)| v).sum();
    let size: f64 = same.iter().map(|&(_, v)| v.abs()).sum();
    if same.len() > 1 && sum.abs() <= CANCELLED * size { 0.0 } else { sum }
}

/// The smallest DOF that is there twice.
fn repeated(dofs: &[usize]) -> Option<usize> {
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

/// Nonlinear equations that are not among those of their type.
pub(super) trait Piece: Send + Sync {
    fn rows(&self) -> usize;
    /// Which type of the set it is of; none if the set has not met it.
    fn kind(&self, blocks: &Blocks) -> Option<u32>;
    /// Takes the parameters of this time; as an error the number of it that is not finite.
    fn at_time(&mut self, time: f64) -> Result<(), f64>;
    /// Puts it among those of its type; the DOFs of all pieces of its constraint and its parts are given.
    fn commit(self: Box<Self>, constraint: u32, dofs: &[u32], parts: &mut Parts, blocks: &mut Blocks);
    /// Whether it has the DOFs and pairs of an equation of its type, so that it can take its place.
    fn fits(&self, dofs: &[u32], place: Place, blocks: &Blocks) -> bool;
    /// Takes that place.
    fn overwrite(self: Box<Self>, constraint: u32, parts: &mut Parts, place: Place, blocks: &mut Blocks);
}

pub(super) struct Staged<Q> {
    pub part: Cow<'static, str>,
    /// Places among the DOFs of all pieces.
    pub dofs: Range<usize>,
    pub parameters: Q,
}

impl<Q: Nonlinear> Piece for Staged<Q> {
    fn rows(&self) -> usize {
        Q::PARTS.len()
    }

    fn kind(&self, blocks: &Blocks) -> Option<u32> {
        blocks.kind::<Q>()
    }

    fn at_time(&mut self, time: f64) -> Result<(), f64> {
        if Q::DRIVEN { self.parameters.at_time(time) } else { Ok(()) }
    }

    fn commit(self: Box<Self>, constraint: u32, dofs: &[u32], parts: &mut Parts, blocks: &mut Blocks) {
        let Self { part, dofs: own, parameters } = *self;
        blocks.insert(Owner { constraint, part: parts.place(part) }, &dofs[own], parameters);
    }

    fn fits(&self, dofs: &[u32], (block, item): Place, blocks: &Blocks) -> bool {
        let dofs = &dofs[self.dofs.clone()];
        blocks.of_type::<Q>(block).is_some_and(|block| block.alike(item, dofs, &self.parameters))
    }

    fn overwrite(self: Box<Self>, constraint: u32, parts: &mut Parts, (block, item): Place, blocks: &mut Blocks) {
        let owner = Owner { constraint, part: parts.place(self.part) };
        if let Some(block) = blocks.of_type_mut::<Q>(block) {
            block.overwrite(item, owner, self.parameters);
        }
    }
}

//! Where a constraint type puts what it consists of, after it has checked its input.

use std::borrow::Cow;
use std::sync::Arc;

use super::StoreError;
use super::block::Blocks;
use super::labels::Owner;
use super::time::Rhs;
use crate::constraint::Nonlinear;
use crate::geometry::node::Node;

/// The linear equations and nonlinear parts of the constraint that is being added.
#[derive(Default)]
pub struct Store {
    dofs: usize,
    pub(super) time: f64,
    pub(super) equations: Vec<Equation>,
    pub(super) pieces: Vec<Box<dyn Piece>>,
    /// DOFs, and the coordinates that they add to.
    pub(super) coordinates: Vec<(u32, f64)>,
    pub(super) fault: Option<StoreError>,
}

/// Sums of terms on one DOF below so many units in the last place of what was summed are what rounding left of a zero.
const CANCELLED: f64 = 8.0 * f64::EPSILON;

impl std::fmt::Debug for Store {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut text = f.debug_struct("Store");
        text.field("equations", &self.equations.len()).field("pieces", &self.pieces.len());
        text.field("fault", &self.fault).finish_non_exhaustive()
    }
}

/// `sum a_j u_j = rhs`, DOFs ascending.
pub(super) struct Equation {
    pub part: Cow<'static, str>,
    pub terms: Vec<(u32, f64)>,
    pub rhs: Rhs,
}

impl Store {
    pub(super) fn new(dofs: usize, time: f64) -> Self {
        Self { dofs, time, ..Self::default() }
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
        let mut sorted: Vec<(u32, f64)> = Vec::new();
        for (dof, value) in terms {
            self.check_dof(dof);
            self.check_number(value);
            sorted.push((dof as u32, value));
        }
        sorted.sort_by_key(|&(dof, _)| dof);
        let terms = sorted.chunk_by(|a, b| a.0 == b.0).map(|same| (same[0].0, sum(same))).collect();
        self.equations.push(Equation { part, terms, rhs });
    }

    /// Adds the nonlinear equations of `parameters` on the DOFs listed, each of which must occur once.
    pub fn nonlinear<Q: Nonlinear>(&mut self, part: impl Into<Cow<'static, str>>, dofs: &[usize], mut parameters: Q) {
        if Q::DOFS != 0 && Q::DOFS != dofs.len() {
            self.fail(StoreError::DofCount { found: dofs.len(), expected: Q::DOFS });
        }
        let mut sorted = dofs.to_vec();
        sorted.sort_unstable();
        sorted.iter().for_each(|&dof| self.check_dof(dof));
        for pair in sorted.windows(2).filter(|pair| pair[0] == pair[1]) {
            self.fail(StoreError::RepeatedDof { dof: pair[0] });
        }
        if Q::DRIVEN {
            parameters.at_time(self.time);
        }
        let dofs = dofs.iter().map(|&dof| dof as u32).collect();
        self.pieces.push(Box::new(Staged { part: part.into(), dofs, parameters }));
    }

    /// States that a DOF moves what is at this coordinate for u = 0, `x = at + u`: of x no more is known than its last place.
    ///
    /// For types that keep differences of coordinates only, for [`crate::ConstraintSet::rounding`].
    pub fn coordinate(&mut self, dof: usize, at: f64) {
        self.coordinates.push((dof as u32, at));
    }

    /// [`Store::coordinate`] of all translations of a node.
    pub fn coordinates_of<const D: usize>(&mut self, node: &Node<D>) {
        node.dofs.iter().zip(node.at).for_each(|(&dof, at)| self.coordinate(dof, at));
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

/// Nonlinear equations that have yet to be put among those of their type.
pub(super) trait Piece {
    fn commit(self: Box<Self>, constraint: u32, blocks: &mut Blocks);
}

struct Staged<Q> {
    part: Cow<'static, str>,
    dofs: Vec<u32>,
    parameters: Q,
}

impl<Q: Nonlinear> Piece for Staged<Q> {
    fn commit(self: Box<Self>, constraint: u32, blocks: &mut Blocks) {
        blocks.push(Owner { constraint, part: self.part }, &self.dofs, self.parameters);
    }
}

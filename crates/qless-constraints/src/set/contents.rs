//! What one constraint consists of, as long as it is not among the equations of a set.

use std::borrow::Cow;

use super::batch::Terms;
use super::piece::Piece;
use super::stated::Coordinate;
use super::time::Rhs;

/// Parts of a constraint whose room is kept for the next one.
const KEPT: usize = 256;

/// Linear equations, nonlinear parts, and what they state.
#[derive(Default)]
pub(super) struct Contents {
    pub equations: Vec<Equation>,
    pub pieces: Vec<Box<dyn Piece>>,
    /// The DOFs of all pieces.
    pub dofs: Vec<u32>,
    /// What DOFs add to.
    pub coordinates: Vec<Coordinate>,
}

/// `sum a_j u_j = rhs`, DOFs ascending.
pub(super) struct Equation {
    pub part: Cow<'static, str>,
    pub terms: Terms,
    pub rhs: Rhs,
}

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

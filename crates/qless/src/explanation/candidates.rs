//! Candidates for the explanation of an equation: prescribed values, and all equations that agree with the kept ones.

use crate::Kind;
use crate::input::incidence::Incidence;
use crate::input::numbering::LocalSystem;
use crate::input::scale::Scaling;

/// Candidates for members of the explanation of one equation or DOF.
pub(super) struct Candidates<'a> {
    pub system: LocalSystem<'a>,
    pub incidence: &'a Incidence,
    pub scaling: &'a Scaling,
    pub kinds: &'a [Kind],
    /// The equation to explain, which is not a candidate itself.
    pub row: Option<usize>,
}

impl<'a> Candidates<'a> {
    /// Conflicting equations are no candidates: in a cycle with two of them their mismatches can cancel, which would hide both conflicts.
    pub fn is_allowed(&self, row: u32) -> bool {
        let row = row as usize;
        self.kinds[row] != Kind::Conflicting && self.row != Some(row)
    }

    pub fn rows(&self, dof: u32) -> &'a [u32] {
        self.incidence.rows(dof)
    }

    /// All DOFs of an equation, prescribed ones too.
    pub fn dofs(&self, row: u32) -> &'a [u32] {
        self.system.parts(row as usize).0
    }

    pub fn is_free(&self, dof: u32) -> bool {
        self.system.free()[dof as usize]
    }

    /// The free DOFs of an equation with their coefficients.
    pub fn free(&self, row: u32) -> impl Iterator<Item = (u32, f64)> + '_ {
        let (dofs, values) = self.system.parts(row as usize);
        dofs.iter().copied().zip(values.iter().copied()).filter(|&(j, _)| self.is_free(j))
    }
}

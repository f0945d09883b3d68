//! What blocks of equations that presolve leaves become: plain data, which a factorization fills in.

use crate::Csr;
use crate::presolve::eliminated::Mismatch;

/// Kept equations that a change of one coefficient by less than this makes dependent are near dependence, whatever the tolerance.
pub(crate) const NEAR: f64 = 3e-6;

/// A dependent row of a block.
#[derive(Clone, Debug)]
pub(crate) struct BlockDependent {
    pub row: u32,
    /// `row = sum y_i row_i` over kept rows of the block (indices among those that went through presolve).
    pub because: Vec<(u32, f64)>,
    /// In units of the block, each y_i may be off by this many units in the last place of the largest.
    pub units: f64,
    /// What was left of the row, relative to its size.
    pub dropped: f64,
    /// `b - C_p u_p` minus the same of its certificate.
    pub mismatch: Mismatch,
}

/// The diagnosis of a block. No slave is chosen and no relation formed.
pub(crate) struct Diagnosed {
    pub kept: Vec<u32>,
    /// Indices of `kept` in an order in which they fill little.
    pub order: Vec<u32>,
    pub dependent: Vec<BlockDependent>,
    /// How near to dependence the kept rows are.
    pub nearness: Nearness,
    /// Over the DOFs of the block.
    pub vectors: Vectors,
}

/// The block solved for its slaves: `u_s = relation (u_q, u_p) + constant`.
#[derive(Clone, Debug)]
pub(crate) struct Solved {
    pub slaves: Vec<u32>,
    /// Columns of `relation`: masters, then prescribed DOFs.
    pub others: Vec<u32>,
    pub relation: Csr,
    pub constant: Vec<f64>,
}

/// Vectors over the DOFs of a block.
#[derive(Clone, Debug, Default)]
pub(crate) struct Vectors {
    /// Random vectors of the null space of the kept rows: how DOFs can move.
    pub moves: [Vec<f64>; 2],
    /// Shortest solution for the random right-hand side ...
    pub sample: Vec<f64>,
    /// ... and for `b - C_p u_p`.
    pub particular: Vec<f64>,
}

/// How near to dependence rows are that were kept, in units of the largest coefficient of each.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Nearness {
    /// Estimate of the smallest singular value.
    pub sigma: f64,
    /// Estimate of the smallest change of one coefficient that makes them dependent; at least sigma. Of a chain it does not fall
    /// with the length.
    pub distance: f64,
}

impl Nearness {
    /// Whether no doubt is due; what is no number is no distance.
    pub fn is_sound(self) -> bool {
        self.distance >= NEAR
    }
}

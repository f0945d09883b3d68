//! Results for the blocks of equations that remain after presolve: plain data, computed by a factorization.

use std::borrow::Cow;
use std::fmt::Debug;
use std::sync::Arc;

use super::resting;
use crate::Csr;
use crate::input::scale::ldexp;
use crate::presolve::eliminated::Mismatch;

/// Kept equations are nearly dependent if a change of one coefficient by less than this makes them dependent, whatever the tolerance is.
pub(crate) const NEAR: f64 = 3e-6;

/// Terms of `row = sum y_i row_i` over kept rows of a block. Rows are numbered as in `Eliminated::rows`.
#[derive(Clone, Debug)]
pub(crate) enum BlockCertificate {
    Known(Vec<(u32, f64)>),
    /// The terms are computed each time they are read. The number is the position of the row among those that the block dropped.
    Late(Arc<dyn LateTerms>, usize),
}

impl BlockCertificate {
    pub fn terms(&self) -> Cow<'_, [(u32, f64)]> {
        match self {
            Self::Known(terms) => Cow::Borrowed(terms),
            Self::Late(certificates, k) => Cow::Owned(certificates.terms(*k)),
        }
    }
}

/// Computes certificates of the rows that a block dropped.
pub(crate) trait LateTerms: Debug + Send + Sync {
    /// The terms of the certificate of the k-th dropped row, ascending.
    fn terms(&self, k: usize) -> Vec<(u32, f64)>;
}

/// A dependent row of a block.
#[derive(Clone, Debug)]
pub(crate) struct BlockDependent {
    pub row: u32,
    pub because: BlockCertificate,
    /// Bounds the error of each coefficient y_i of the certificate, in the units of the block: this number times the number of terms, in
    /// units in the last place of the largest y_i.
    pub units: f64,
    /// What remains of the row after its certificate is subtracted, relative to the size of the row.
    pub dropped: f64,
    /// The right-hand side of the row (without prescribed terms) minus that of its certificate. Blocks with the same matrix are diagnosed
    /// together; meanwhile there is one such mismatch for each of these blocks.
    pub mismatches: Vec<Mismatch>,
}

/// The diagnosis of a block, without slaves and without T.
pub(crate) struct Diagnosed {
    pub kept: Vec<u32>,
    /// Indices of `kept` in a fill-reducing order.
    pub order: Vec<u32>,
    pub dependent: Vec<BlockDependent>,
    /// Distance of the kept rows from dependence.
    pub nearness: Nearness,
    /// Vectors over the DOFs of the block.
    pub vectors: Vectors,
}

/// The slaves of a block: `u_s = relation (u_q, u_p) + constant`.
#[derive(Clone, Debug)]
pub(crate) struct Solved {
    pub slaves: Vec<u32>,
    /// Columns of `relation`: masters, then prescribed DOFs.
    pub others: Vec<u32>,
    pub relation: Csr,
    pub constant: Vec<f64>,
}

/// Two random motions of a block that its kept rows allow, and two minimum-norm solutions.
#[derive(Clone, Debug, Default)]
pub(crate) struct Vectors {
    /// Random vectors of the null space of the kept rows: admissible motions of the DOFs.
    pub moves: [Vec<f64>; 2],
    /// Minimum-norm solution of the kept rows for a random right-hand side.
    pub sample: Vec<f64>,
    /// Minimum-norm solution of the kept rows for the right-hand side `b - C_p u_p`.
    pub particular: Vec<f64>,
}

/// A DOF moves if its entry in a random vector of the null space is above `ZERO_UNITS eps / sigma`, limited to [`ZERO`]; sigma is the
/// smallest singular value of the kept rows.
const ZERO_UNITS: f64 = 8.0;
/// Lower and upper limit of the threshold `ZERO_UNITS eps / sigma`, for any smallest singular value sigma.
const ZERO: [f64; 2] = [1e-13, 1e-8];

impl Vectors {
    /// Number of DOFs that do not move in the first motion.
    pub fn resting(&self) -> usize {
        self.moves[0].iter().filter(|&&v| v == 0.0).count()
    }

    /// Sets entries of the motions below the threshold to zero, except where the kept rows of `matrix` need them.
    ///
    /// The threshold bounds the error of each entry. If the moving DOFs of a row miss it by more than their errors, DOFs that seem to rest
    /// move, too: their motions are small in these units and follow from the rows. Returns false if the motions violate a row: then the
    /// threshold bounds no errors.
    pub fn set_resting(&mut self, matrix: &Csr, kept: &[usize], sigma: f64) -> bool {
        let zero = (ZERO_UNITS * f64::EPSILON / sigma).clamp(ZERO[0], ZERO[1]);
        let mut hold = true;
        for moves in &mut self.moves {
            moves.iter_mut().filter(|v| v.abs() <= zero).for_each(|v| *v = 0.0);
            if moves.contains(&0.0) {
                hold &= resting::set_needed(matrix, kept, moves, zero);
            }
        }
        hold
    }

    /// Converts from balanced units to those of the rows.
    pub fn restore_units(&mut self, units: &[i32]) {
        let [first, second] = &mut self.moves;
        for vector in [first, second, &mut self.sample, &mut self.particular] {
            vector.iter_mut().zip(units).for_each(|(v, &unit)| *v = ldexp(*v, unit));
        }
    }
}

/// Distance of the kept rows from dependence, each row scaled to a largest coefficient of 1.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Nearness {
    /// Estimate of the smallest singular value of the kept rows.
    pub sigma: f64,
    /// Estimate of the smallest change of a single coefficient that makes the kept rows dependent. It is never below `sigma`. In a chain of
    /// equations, where each shares a DOF with the next, `sigma` falls with the number of equations; this estimate does not.
    pub distance: f64,
}

impl Nearness {
    /// Returns true if the rank is not in doubt; false if the distance is NaN.
    pub fn is_sound(self) -> bool {
        self.distance >= NEAR
    }
}

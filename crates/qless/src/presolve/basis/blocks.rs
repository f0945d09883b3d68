//! Results for the blocks of equations that remain after presolve: plain data, computed by a factorization.

use std::borrow::Cow;
use std::collections::VecDeque;
use std::fmt::Debug;
use std::sync::Arc;

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
    /// The threshold bounds the error of each entry. If the moving DOFs of a row miss it by more than their errors, a DOF that seems to rest
    /// moves, too: its motion is small in these units and follows from the row.
    pub fn set_resting(&mut self, matrix: &Csr, kept: &[usize], sigma: f64) {
        let zero = (ZERO_UNITS * f64::EPSILON / sigma).clamp(ZERO[0], ZERO[1]);
        for moves in &mut self.moves {
            moves.iter_mut().filter(|v| v.abs() <= zero).for_each(|v| *v = 0.0);
            if moves.contains(&0.0) && moves.iter().any(|&v| v != 0.0) {
                move_needed(matrix, kept, moves, zero);
            }
        }
    }

    /// Converts from balanced units to those of the rows.
    pub fn restore_units(&mut self, units: &[i32]) {
        let [first, second] = &mut self.moves;
        for vector in [first, second, &mut self.sample, &mut self.particular] {
            vector.iter_mut().zip(units).filter(|(_, unit)| **unit != 0).for_each(|(v, &unit)| *v = ldexp(*v, unit));
        }
    }
}

/// Gives a motion to DOFs that seem to rest, if the other DOFs of a row miss it by more than their errors, which are at most `error` each.
/// DOFs that rows fix come first, so that no other row gives them a motion. If the motions then miss a row, a DOF was given one that has
/// none: those of this row, and of all rows reached from it through such DOFs, are taken back.
fn move_needed(matrix: &Csr, kept: &[usize], moves: &mut [f64], error: f64) {
    let mut errors = vec![error; moves.len()];
    let mut is_fixed = vec![false; moves.len()];
    let rows_of_dofs = matrix.transposed();
    let mut is_kept = vec![false; matrix.rows()];
    kept.iter().for_each(|&i| is_kept[i] = true);
    let before = moves.to_vec();
    for may_move in [false, true] {
        let mut queue: VecDeque<usize> = kept.iter().copied().collect();
        while let Some(i) = queue.pop_front() {
            let changed = match Missed::by(matrix.row(i), moves, &errors, &is_fixed) {
                Missed { dof: Some((j, _)), is_alone: true, .. } => {
                    is_fixed[j] = true;
                    j
                }
                Missed { dof: Some((j, v)), sum, error, .. } if may_move && sum.abs() > error && sum / v != 0.0 => {
                    (moves[j], errors[j]) = (-sum / v, error / v.abs());
                    j
                }
                _ => continue,
            };
            queue.extend(rows_of_dofs.row(changed).map(|(i, _)| i).filter(|&i| is_kept[i]));
        }
    }
    let is_missed = |&i: &usize| {
        let Missed { sum, error, dof, .. } = Missed::by(matrix.row(i), moves, &errors, &is_fixed);
        dof.is_none() && sum.abs() > error
    };
    let mut queue: VecDeque<usize> = kept.iter().copied().filter(is_missed).collect();
    while let Some(i) = queue.pop_front() {
        for (j, _) in matrix.row(i).filter(|&(j, _)| before[j] == 0.0) {
            if std::mem::take(&mut moves[j]) != 0.0 {
                queue.extend(rows_of_dofs.row(j).map(|(i, _)| i).filter(|&i| is_kept[i]));
            }
        }
    }
}

/// By how much the moving DOFs of a row miss it.
struct Missed {
    sum: f64,
    /// Bound of the error of `sum`.
    error: f64,
    /// The DOF with the largest coefficient among those that seem to rest and may move, and this coefficient.
    dof: Option<(usize, f64)>,
    /// True if all other DOFs of the row are fixed.
    is_alone: bool,
}

impl Missed {
    fn by(row: impl Iterator<Item = (usize, f64)>, moves: &[f64], errors: &[f64], is_fixed: &[bool]) -> Self {
        let (mut dof, mut sum, mut error, mut count) = (None, 0.0, 0.0, 0);
        for (j, v) in row.filter(|&(j, v)| v != 0.0 && !is_fixed[j]) {
            count += 1;
            if moves[j] != 0.0 {
                (sum, error) = (sum + v * moves[j], error + v.abs() * errors[j]);
            } else if dof.is_none_or(|(_, most): (usize, f64)| v.abs() > most.abs()) {
                dof = Some((j, v));
            }
        }
        Self { sum, error, dof, is_alone: count == 1 && dof.is_some() }
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

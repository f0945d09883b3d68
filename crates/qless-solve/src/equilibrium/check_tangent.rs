//! Compares the stiffness of a model with differences of its forces: `K d = (f(u + t d) - f(u)) / t`.
//!
//! One direction d moves all DOFs by random fractions of their sizes, so that a wrong entry shows in its row after a few evaluations.
//! Halving the moved DOFs then finds its column.

use super::EquilibriumError;
use super::model::{Assembly, Model};
use super::state::{ULPS, fault, model_error};
use crate::common::random;

/// Lengths t of differences, the best first. The error of a difference is about `t` from curvature and `eps / t` from rounding. If DOFs
/// have their expected sizes, both are equal at the square root of eps. The other lengths serve DOFs of other sizes, and models that refuse
/// a configuration.
const LENGTHS: [f64; 4] = [1e-7, 1e-10, 1e-5, 1e-13];
/// A row is wrong if it is off by more than this share of its terms. A smaller error explains no failure: with a tangent that is off by a
/// share e, iterations converge like `e^k`, and the default of 25 iterations reaches 1e-10 for e below 0.4.
const SHARE: f64 = 0.01;
/// K is wrong only if it differs from the slope by more than this factor times the error bound of the slopes. If the slopes change
/// monotonically with the length of the difference, their limit lies within twice their spread.
const TRUSTED: f64 = 4.0;

/// An entry of K that differs from the slope of the force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WrongEntry {
    row: usize,
    column: usize,
    given: f64,
    difference: f64,
}

/// Compares K of a model at u with differences of its forces.
///
/// [`super::solve`] does so by itself when it finds no equilibrium. Cost: some evaluations, and about twelve for each halving of the DOFs
/// if an entry is wrong.
///
/// ```
/// use qless_solve::equilibrium::{Assembly, EquilibriumError, Model, check_tangent};
/// /// A spring `f = 2 u + u^3` that forgets the factor 3 of its stiffness.
/// struct Spring;
/// impl Model for Spring {
///     fn dofs(&self) -> usize {
///         1
///     }
///     fn pattern(&self, entry: &mut dyn FnMut(usize, usize)) {
///         entry(0, 0);
///     }
///     fn assemble(&mut self, u: &[f64], out: &mut Assembly) -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
///         out.force(0, 2.0 * u[0] + u[0].powi(3));
///         out.stiffness(0, 0, 2.0 + u[0] * u[0]);
///         Ok(())
///     }
/// }
/// // It does not show at rest.
/// check_tangent(&mut Spring, &[0.0])?;
/// let wrong = check_tangent(&mut Spring, &[1.0]);
/// assert!(matches!(wrong, Err(EquilibriumError::Tangent { row: 0, column: 0, given, .. }) if given == 3.0));
/// # Ok::<(), EquilibriumError>(())
/// ```
///
/// # Errors
/// [`EquilibriumError::Tangent`] names an entry that is wrong by more than a hundredth of the terms of its row. Another error is returned
/// if the model refuses u.
pub fn check_tangent(model: &mut impl Model, u: &[f64]) -> Result<(), EquilibriumError> {
    let (found, expected) = (u.len(), model.dofs());
    if found != expected {
        return Err(EquilibriumError::Size { what: "values of u", found, expected });
    }
    let wrong = TangentCheck::new(model, u)?.wrong_entry();
    wrong.map_or(Ok(()), |wrong| Err(wrong.into_error()))
}

impl WrongEntry {
    pub(super) fn into_error(self) -> EquilibriumError {
        let Self { row, column, given, difference } = self;
        EquilibriumError::Tangent { factor: 0.0, row, column, given, difference }
    }
}

/// The model at u, and a direction in which its DOFs are moved.
pub(super) struct TangentCheck<'a, M> {
    model: &'a mut M,
    u: &'a [f64],
    here: Assembly,
    /// The direction d, a random fraction of the size of each DOF.
    direction: Vec<f64>,
}

/// For each row, the slope of the force along a direction, and a bound on its error.
struct Slopes {
    value: Vec<f64>,
    error: Vec<f64>,
}

impl<'a, M: Model> TangentCheck<'a, M> {
    pub fn new(model: &'a mut M, u: &'a [f64]) -> Result<Self, EquilibriumError> {
        let mut here = Assembly::new(model);
        model.assemble(u, &mut here).map_err(model_error)?;
        fault(&here)?;
        let own: Vec<f64> = (0..u.len()).map(|j| u[j].abs().max(model.coordinate(j).abs())).collect();
        let most = own.iter().copied().fold(0.0, f64::max);
        let size = |own: f64| {
            if own > 0.0 {
                own
            } else if most > 0.0 {
                most
            } else {
                1.0
            }
        };
        let direction = (0..).zip(own).map(|(k, own)| random(k) * size(own)).collect();
        Ok(Self { model, u, here, direction })
    }

    /// Finds an entry that differs from the slope of its force; `None` if there is no such entry, or if the forces are too rough to tell.
    pub fn wrong_entry(&mut self) -> Option<WrongEntry> {
        let all = 0..self.u.len();
        LENGTHS.into_iter().find_map(|length| {
            let slopes = self.slopes(&all, length)?;
            let row = all.clone().find(|&row| self.is_wrong(row, &all, &slopes))?;
            self.column(row, all.clone(), length)
        })
    }

    /// Finds the wrong entry of a row: halves the moved DOFs until one is left.
    fn column(&mut self, row: usize, mut moved: std::ops::Range<usize>, length: f64) -> Option<WrongEntry> {
        loop {
            let slopes = self.slopes(&moved, length)?;
            if !self.is_wrong(row, &moved, &slopes) {
                return None;
            }
            if moved.len() == 1 {
                let column = moved.start;
                let given = self.here.row(row).find(|&(j, _)| j == column).map_or(0.0, |(_, v)| v);
                let difference = slopes.value[row] / self.direction[column];
                return Some(WrongEntry { row, column, given, difference });
            }
            let middle = moved.start.midpoint(moved.end);
            let first = moved.start..middle;
            let half = self.slopes(&first, length)?;
            moved = if self.is_wrong(row, &first, &half) { first } else { middle..moved.end };
        }
    }

    fn is_wrong(&self, row: usize, moved: &std::ops::Range<usize>, slopes: &Slopes) -> bool {
        let terms = self.here.row(row).filter(|(j, _)| moved.contains(j)).map(|(j, v)| v * self.direction[j]);
        let (sum, size) = terms.fold((0.0, 0.0), |(sum, size), term: f64| (sum + term, size + term.abs()));
        let (slope, error) = (slopes.value[row], slopes.error[row]);
        let off = (slope - sum).abs();
        off > TRUSTED * error && off > SHARE * f64::max(size, slope.abs())
    }

    /// Slopes of the forces by forward and backward differences of three lengths, and their spread. The spread bounds the error: a
    /// nonlinear force, or the rounding of a short difference, makes the slopes differ. `None` if the model refuses a configuration.
    fn slopes(&mut self, moved: &std::ops::Range<usize>, length: f64) -> Option<Slopes> {
        let mut all = Vec::new();
        for length in [length, length / 3.0, length / 9.0, -length, -length / 3.0, -length / 9.0] {
            all.push((length, self.at(moved, length)?));
        }
        let (mut value, mut error) = (Vec::new(), Vec::new());
        for (i, here) in self.here.force.iter().enumerate() {
            let slopes = all.iter().map(|(length, there)| (there.force[i] - here) / length);
            let (least, most) = slopes.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
            value.push(f64::midpoint(least, most));
            error.push(most - least + 9.0 * ULPS * all[0].1.terms[i] / length);
        }
        Some(Slopes { value, error })
    }

    fn at(&mut self, moved: &std::ops::Range<usize>, length: f64) -> Option<Assembly> {
        let mut there = self.here.clone();
        there.clear(false);
        let mut u = self.u.to_vec();
        moved.clone().for_each(|j| u[j] += length * self.direction[j]);
        self.model.assemble(&u, &mut there).ok()?;
        Some(there).filter(|there| there.force.iter().all(|f| f.is_finite()))
    }
}

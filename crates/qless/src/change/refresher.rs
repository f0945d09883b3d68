//! Computes g and the kinds of equations for new b and u_p and the same C, without a new factorization. Any u with `C u = b` and `u_p = 0`
//! gives `g = u_s - T u_q`.
//!
//! ```text
//! analyse, reduction  ->  T, G     once
//! Refresher::new      ->  factors of the square matrix of each block's slaves     once
//! Refresher::refresh  ->  g, redundant or conflicting, fixed values     for each b and u_p, O(nnz)
//! ```
//!
//! A refresh takes longer if right-hand sides are in doubt, as an analysis does: their certificates are then computed. It also takes longer
//! if a part has large residuals, as a reduction does: the columns of its slaves are then factored.
//!
//! T, G, the slaves and the independent equations depend on C only and do not change.

use std::sync::Arc;

use super::replay::{BlockSolver, Replay};
use crate::common::argument::numbers;
use crate::diagnosis::certificate::History;
use crate::diagnosis::classify::{Dependent, Kind, MismatchRule, Source};
use crate::diagnosis::confidence::{Confidence, Doubt, are_sides_in_doubt};
use crate::diagnosis::hidden_conflicts;
use crate::diagnosis::nullspace_probe::RandomKeys;
use crate::diagnosis::proof::are_sides_contradicted;
use crate::diagnosis::refined::SolveKept;
use crate::factor::backend::BackendError;
use crate::factor::backend::many::Slab;
use crate::input::noise::of_right_hand_sides;
use crate::input::numbering::LocalSystem;
use crate::input::scale::ldexp;
use crate::presolve::basis::Basis;
use crate::presolve::eliminated::Mismatch;
use crate::reduction::retry::{self, CheckedTerms};
use crate::{Analysis, ArgumentError, ConstraintSystem, Effort, Reduction, ReductionError};

/// A sum below this, relative to its largest term, is rounding.
const NOISE: f64 = 1e-14;

/// Computes g and the kinds of the equations for new right-hand sides.
///
/// It shares ownership of its analysis and borrows nothing, so a program can store it or send it to other threads.
pub struct Refresher {
    analysis: Arc<Analysis>,
    /// The coefficient of the slave in each peeled equation.
    pivots: Vec<f64>,
    solvers: Vec<BlockSolver>,
    /// For each row that went through elimination, the exponent of the power of two by which its block scales the row; 0 outside blocks.
    exponents: Vec<i32>,
}

impl std::fmt::Debug for Refresher {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Refresher").field("analysis", &self.analysis).finish_non_exhaustive()
    }
}

/// The results of a refresh except g, which is written into the reduction.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Refreshed {
    /// Kind of each equation; length m. The independent equations are always the same.
    pub kinds: Vec<Kind>,
    /// For each dependent equation ([`Analysis::dependent`]): `b_k - sum c_i b_i` in the units of the equation, where b is the right-hand
    /// side minus the terms of prescribed DOFs.
    pub mismatches: Vec<f64>,
    /// Free DOFs that the equations fix, and their values; ascending.
    pub generated: Vec<(usize, f64)>,
    /// The certainty of these verdicts. Its distance and error are those of the analysis, because they depend on C only. A doubt about
    /// right-hand sides is that of the new ones. [`crate::Effort::Proved`] and [`crate::Effort::Exact`] prove nothing about new ones, and any
    /// doubt that they raised stays.
    pub confidence: Confidence,
}

/// Errors of a refresh; the reduction is then unchanged.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RefreshError {
    /// A list of the wrong length, a number that is not finite, or a reduction of another analysis.
    #[error(transparent)]
    Argument(#[from] ArgumentError),
    /// The new g does not satisfy the equations, or exceeds the range of doubles.
    #[error(transparent)]
    Reduction(#[from] ReductionError),
}

impl Refresher {
    /// Prepares an analysis (or a shared `Arc` of one) for new right-hand sides and prescribed values.
    ///
    /// ```
    /// use qless::{Kind, Options, SystemBuilder, analyse};
    /// use qless::change::Refresher;
    /// let mut builder = SystemBuilder::new(2);
    /// builder.equation([(0, 1.0), (1, -1.0)], 0.0);
    /// builder.equation([(0, 2.0), (1, -2.0)], 0.0);
    /// let system = builder.build()?;
    /// let analysis = analyse(&system, &Options::default())?;
    /// let mut reduction = analysis.reduction()?;
    /// let refresher = Refresher::new(analysis)?;
    /// // A gap of 0.5 in one equation contradicts the other ...
    /// let refreshed = refresher.refresh(&[0.5, 0.0], &[], &mut reduction)?;
    /// assert!(refreshed.kinds.contains(&Kind::Conflicting));
    /// // ... and in both it does not.
    /// let refreshed = refresher.refresh(&[0.5, 1.0], &[], &mut reduction)?;
    /// assert!(!refreshed.kinds.contains(&Kind::Conflicting));
    /// let u = reduction.expand(&[2.0], &[])?;
    /// assert!((u[0] - u[1] - 0.5).abs() < 1e-15);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`BackendError`] if a block needs more memory than [`crate::Options::memory`] allows.
    pub fn new(analysis: impl Into<Arc<Analysis>>) -> Result<Self, BackendError> {
        let analysis = analysis.into();
        let Analysis { basis, blocks, scaling, history, options, .. } = &*analysis;
        let local = analysis.local();
        let peeled = basis.peeled.iter().zip(basis.slaves());
        let pivots = peeled.map(|(&row, &slave)| local.coefficient(row as usize, slave)).collect();
        let solver = |(block, kept)| BlockSolver::new(block, kept, scaling, options.memory);
        let solvers = blocks.iter().zip(&basis.blocks).map(solver).collect::<Result<_, _>>()?;
        let mut exponents = vec![0; history.rows.len()];
        for block in blocks {
            block.rows.iter().zip(&block.exponents).for_each(|(&row, &shift)| exponents[row as usize] = shift);
        }
        Ok(Self { analysis, pivots, solvers, exponents })
    }

    /// The analysis that was given to [`Refresher::new`].
    pub fn analysis(&self) -> &Arc<Analysis> {
        &self.analysis
    }

    /// Writes g for b = `rhs` (length m) into a reduction of the same analysis; `prescribed` are the values of u_p, in the order
    /// of [`ConstraintSystem::prescribed`].
    ///
    /// # Errors
    /// [`RefreshError`].
    pub fn refresh(
        &self,
        rhs: &[f64],
        prescribed: &[f64],
        reduction: &mut Reduction,
    ) -> Result<Refreshed, RefreshError> {
        numbers("the right-hand side", rhs, self.system().equations())?;
        numbers("the list of prescribed values", prescribed, self.system().prescribed().len())?;
        if reduction.of != self.analysis.identity {
            return Err(ArgumentError::Foreign { what: "the reduction" }.into());
        }
        let Analysis { dependent, distances, numbering, scaling, options, .. } = &*self.analysis;
        let values: Vec<_> = self.local().prescribed_places().map(|(l, place)| (l, prescribed[place])).collect();
        let local = numbering.view(self.system(), rhs).with_prescribed(&values);
        let noise = of_right_hand_sides(local, &scaling.row, &options.noise);
        let replay = Replay::with_noise(&self.analysis, rhs, prescribed, noise.as_deref());
        let rule = MismatchRule::new(local, scaling, options);
        let mut found: Vec<Dependent> = dependent.iter().map(|d| self.classify(d, &replay, &rule)).collect();
        if noise.is_none() && !options.tolerance.is_absolute() {
            let distances = options.effort.checks().then_some(&distances[..]);
            hidden_conflicts::find(&mut found, &mut RandomKeys::default(), self, distances, &rule);
        }
        let confidence = self.confidence(&found, &rule);
        self.write(&replay, reduction)?;
        let mut kinds = vec![Kind::Independent; rhs.len()];
        found.iter().for_each(|d| kinds[d.row] = d.kind);
        let mismatches = found.iter().map(|d| d.mismatch).collect();
        Ok(Refreshed { kinds, mismatches, generated: self.generated(&replay, prescribed), confidence })
    }

    fn system(&self) -> &ConstraintSystem {
        &self.analysis.system
    }

    fn local(&self) -> LocalSystem<'_> {
        self.analysis.local()
    }

    fn confidence(&self, dependent: &[Dependent], rule: &MismatchRule) -> Confidence {
        let Analysis { history, options, confidence, .. } = &*self.analysis;
        // A proof may have had a doubt about C that the one about the right-hand sides has hidden.
        let is_of_sides = !matches!(options.effort, Effort::Proved | Effort::Exact);
        let doubt = confidence.doubt.filter(|&doubt| !(is_of_sides && doubt == Doubt::Mismatch));
        let of_c = Confidence { doubt, ambiguous: doubt.is_some(), ..*confidence };
        if of_c.ambiguous {
            return of_c;
        }
        let is_in_doubt = are_sides_in_doubt(dependent, history, rule, options.tolerance)
            || options.effort.checks() && are_sides_contradicted(&self.analysis, dependent, rule.system);
        if is_in_doubt { of_c.or(Doubt::Mismatch) } else { of_c }
    }

    /// Classifies a dependent equation by its new mismatch.
    fn classify(&self, d: &Dependent, replay: &Replay, rule: &MismatchRule) -> Dependent {
        let rest = match &d.source {
            Source::Traced(row, because, units) => {
                self.traced(*row, &because.terms(), *units, replay).scaled(-self.analysis.scaling.row[d.row])
            }
            Source::Given(because) => {
                let mut rest: Mismatch = replay.of_user(d.row);
                because.iter().for_each(|term| rest.subtract(term.coefficient, replay.of_user(term.row)));
                rest
            }
        };
        Dependent::new(d.row, rest, d.dropped, d.source.clone(), rule)
    }

    /// The mismatch `b_k - sum_i y_i b_i` of row k, and a bound of its error; y is the certificate of row k over rows of a block. Each
    /// `y_i` is wrong by at most `units` times the number of terms, in units in the last place of the largest `y_i`. This holds in the
    /// units of the block.
    fn traced(&self, k: u32, because: &[(u32, f64)], units: f64, replay: &Replay) -> Mismatch {
        let shift = |i: u32| self.exponents[k as usize] - self.exponents[i as usize];
        let largest = because.iter().fold(0.0, |most: f64, &(i, y)| most.max(ldexp(y.abs(), shift(i))));
        let mut rest = replay.row(k).effective;
        for &(i, y) in because {
            let other = replay.row(i).effective;
            rest.subtract(y, other);
            rest.error += ldexp(units * because.len() as f64 * f64::EPSILON * largest, -shift(i)) * other.size;
        }
        rest
    }

    /// For each peeled or eliminated row, the value of its slave if all other DOFs of the row are zero.
    fn constants(&self, replay: &Replay) -> Vec<f64> {
        let (basis, scaling) = (&self.analysis.basis, &self.analysis.scaling);
        let peeled = basis.peeled.iter().zip(&self.pivots).map(|(&row, pivot)| replay.rhs[row as usize] / pivot);
        let mut constants: Vec<f64> = peeled.collect();
        for (s, step) in replay.steps.iter().enumerate() {
            let t = basis.peeled.len() + s;
            constants.push(ldexp(step.rhs / basis.pivot_of_step(s), scaling.col(basis.slave(t) as usize)));
        }
        constants
    }

    /// Computes u in local numbers. Masters are zero; prescribed DOFs are zero or have the given values.
    fn complete(&self, replay: &Replay, prescribed: Option<&[f64]>) -> Vec<f64> {
        let (basis, local) = (&self.analysis.basis, self.local());
        let mut u = vec![0.0; local.dofs()];
        if let Some(values) = prescribed {
            local.prescribed_places().for_each(|(l, place)| u[l] = values[place]);
        }
        for (solver, kept) in self.solvers.iter().zip(&basis.blocks) {
            let side = |&row: &u32| {
                let side = replay.row(row);
                if prescribed.is_some() { side.effective.value } else { side.rhs }
            };
            solver.solve(kept.rows.iter().map(side).collect(), &mut u);
        }
        basis.complete_with(local, &self.constants(replay), &mut u);
        u
    }

    /// Writes `g = u_s - T u_q`, checked as in a new reduction; restores the old g if the residuals stay too large.
    fn write(&self, replay: &Replay, reduction: &mut Reduction) -> Result<(), RefreshError> {
        let new = self.explicit(replay, reduction);
        let old = std::mem::replace(&mut reduction.g, new);
        let sides = self.write_factored(replay, reduction);
        let local = self.analysis.numbering.view(self.system(), replay.rhs);
        let independent = self.analysis.independent();
        retry::checked(reduction, local, CheckedTerms::Constants, &self.analysis.rules(&independent)).inspect_err(
            |_| {
                reduction.g = old;
                reduction.factored.iter_mut().zip(sides).for_each(|(block, side)| block.rhs = side);
            },
        )?;
        Ok(())
    }

    /// The residuals `b - C u` of the independent equations for these values of the local DOFs; 0 for other equations.
    fn rest(&self, rhs: &[f64], independent: &[bool], u: impl Fn(usize) -> f64) -> Vec<f64> {
        let local = self.local();
        let left = |i: usize| local.row(i).fold(rhs[i], |left, (j, v)| left - v * u(j));
        (0..rhs.len()).map(|i| if independent[i] { left(i) } else { 0.0 }).collect()
    }

    /// `u_s - T u_q` for each slave; 0 for slaves of factored blocks.
    fn explicit(&self, replay: &Replay, reduction: &Reduction) -> Vec<f64> {
        let mut u = vec![0.0; self.system().dofs()];
        let local = self.complete(replay, None);
        local.iter().zip(&self.analysis.numbering.dofs).for_each(|(&v, &j)| u[j as usize] = v);
        let of_slave = |(i, &slave): (usize, &usize)| {
            let (mut sum, mut size) = (u[slave], u[slave].abs());
            for (q, v) in reduction.t.row(i) {
                let part = v * u[reduction.masters[q]];
                sum -= part;
                size = size.max(part.abs());
            }
            if sum.abs() > NOISE * size { sum } else { 0.0 }
        };
        let mut g: Vec<f64> = reduction.slaves.iter().enumerate().map(of_slave).collect();
        for slave in reduction.factored.iter().flat_map(|block| &block.slaves) {
            reduction.slaves.binary_search(slave).into_iter().for_each(|place| g[place] = 0.0);
        }
        g
    }

    /// Writes g of the factored blocks; returns their old right-hand sides.
    fn write_factored(&self, replay: &Replay, reduction: &mut Reduction) -> Vec<Vec<f64>> {
        let mut old = Vec::new();
        for block in &mut reduction.factored {
            old.push(block.set_rhs(replay.rhs, &self.analysis.scaling.row));
            for (slave, g) in block.slaves.iter().zip(block.constants()) {
                let place = reduction.slaves.binary_search(slave);
                place.into_iter().for_each(|place| reduction.g[place] = g);
            }
        }
        old
    }

    fn generated(&self, replay: &Replay, prescribed: &[f64]) -> Vec<(usize, f64)> {
        let fixed = &self.analysis.fixed;
        if fixed.is_empty() {
            return Vec::new();
        }
        let mut u = self.complete(replay, Some(prescribed));
        let rest = self.rest(replay.rhs, &self.analysis.independent(), |l| u[l]);
        let correction = self.complete(&Replay::new(&self.analysis, &rest, &[]), None);
        u.iter_mut().zip(correction).for_each(|(u, c)| *u += c);
        let named = self.analysis.generated.iter().zip(fixed);
        named.map(|(&(dof, _), &l)| (dof, u[l as usize])).collect()
    }
}

impl SolveKept for Refresher {
    fn parts(&self) -> (LocalSystem<'_>, &Basis, &History) {
        (self.local(), &self.analysis.basis, &self.analysis.history)
    }

    fn correction<const W: usize>(&self, left: impl Fn(usize) -> [f64; W]) -> Slab<W> {
        // Other rows than those of the basis are not read.
        let sides: Slab<W> = (0..self.system().equations()).map(left).collect();
        let mut x = vec![[0.0; W]; self.local().dofs()];
        for w in 0..W {
            let side: Vec<f64> = sides.iter().map(|side| side[w]).collect();
            let solution = self.complete(&Replay::new(&self.analysis, &side, &[]), None);
            x.iter_mut().zip(solution).for_each(|(x, value)| x[w] = value);
        }
        x
    }
}

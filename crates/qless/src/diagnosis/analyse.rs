//! The way of the data, top to bottom: equations, scaling, presolve, blocks, backend, classification.
//!
//! ```text
//! Numbering -> Scaling -> Pipeline::run_verified -> keep_preferred -> generated -> Analysis
//!
//! run_verified   run_stages with presolve, probe what it kept
//!                doubts?  run_stages again, the doubtful components held back from presolve
//!                no nearer to dependence than the tolerance?  run_stages a third time, presolve for these components again
//!
//! run_stages     peel -> gather -> eliminate -> Block::new -> diagnose -> classify
//! ```
//!
//! Each stage is a plain function from one owned value to the next.

use std::collections::HashSet;
use std::time::Instant;

use rayon::prelude::*;

use super::certificate::History;
use super::classify::classify;
use super::confidence::Confidence;
use super::distance::KeptRows;
use super::nullspace_probe::{InverseEstimate, NullspaceProbe, ProbeSample, RandomKeys, is_far, probe, random_sides};
use super::pass_result::{PassResult, groups, statistics};
use super::preferred_equations::keep_preferred;
use super::{Analysis, AnalysisError, confidence, generated, sensitivity};
use crate::factor::backend::BackendError;
use crate::factor::block::triangle::Triangle;
use crate::factor::block::{self, Block, FactorContext};
use crate::input::components::Labels;
use crate::input::numbering::{Column, Exponents, LocalSystem, Numbering};
use crate::input::preferences::SlavePreferences;
use crate::input::rounding;
use crate::input::scale::{Scaling, Spread, Spreads, balanced, by_rows};
use crate::presolve::basis::Diagnosed;
use crate::presolve::eliminate::eliminate;
use crate::presolve::eliminated::Eliminated;
use crate::presolve::gather::gather;
use crate::presolve::peel::peel;
use crate::{ConstraintSystem, Options, Tolerance};

/// Diagnoses `C u = b`: rank, dependent equations, generated boundary conditions.
///
/// ```
/// use qless::{Kind, Options, SystemBuilder, analyse};
/// // Three equations that tie three DOFs in a ring: the last follows from the others.
/// let mut builder = SystemBuilder::new(3);
/// builder.equation([(0, 1.0), (1, -1.0)], 0.0);
/// builder.equation([(1, 1.0), (2, -1.0)], 0.0);
/// builder.equation([(0, 1.0), (2, -1.0)], 0.0);
/// let system = builder.build()?;
/// let analysis = analyse(&system, &Options::default())?;
/// assert_eq!((analysis.rank(), analysis.kinds()[2]), (2, Kind::Redundant));
/// let because = analysis.because(2)?;
/// assert_eq!(because.iter().map(|term| (term.row, term.coefficient)).collect::<Vec<_>>(), [(0, 1.0), (1, 1.0)]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`AnalysisError`] if a setting is out of range, a block does not fit into memory, or numbers leave the range of
/// doubles. No input that is a valid [`ConstraintSystem`] makes it panic.
pub fn analyse(system: &ConstraintSystem, options: &Options) -> Result<Analysis, AnalysisError> {
    options.validate()?;
    options.preferences.validate(system)?;
    let started = Instant::now();
    let (numbering, columns, exponents) = Numbering::new(system);
    if let Some(row) = exponents.iter().position(|of_row| of_row.is_subnormal()) {
        return Err(AnalysisError::Subnormal { row });
    }
    let backend = options.backend.get(options.memory)?;
    let tolerance = options.tolerance.value();
    let local = numbering.view(system, system.rhs());
    let is_relative = matches!(options.tolerance, Tolerance::Relative(_));
    let ignored = if is_relative { rounding::find(local, &exponents) } else { Vec::new() };
    let uncertain = rounding::places(&ignored, local);
    let preferences = SlavePreferences::new(&options.preferences, &numbering, system.dofs());
    let (rows, spreads) = scale(local, &columns, &exponents, &uncertain, options.tolerance);
    let pipeline = Pipeline {
        local,
        columns: &columns,
        scaling: &rows,
        preferences: &preferences,
        uncertain: &uncertain,
        is_absolute: options.tolerance.is_absolute(),
        context: FactorContext::new(backend.as_ref(), options.tolerance.value(), options.check, options.memory),
        started,
    };
    let run_verified = |scaling: &Scaling| Pipeline { scaling, ..pipeline }.run_verified(options.presolve);
    let (scaling, verified) = match spreads.filter(|_| options.balance) {
        None => (rows.clone(), run_verified(&rows)?),
        Some(spreads) => {
            run_in_best_scaling(&rows, &spreads, run_verified, |which| balanced(local, &exponents, &rows, which))?
        }
    };
    let VerifiedPass { mut pass, held_back, confidence, .. } = verified;
    let preferred = &options.preferences.equations;
    let kept = keep_preferred(preferred, &mut pass.dependent, &pass.history, &scaling, tolerance);
    let mut rhs = system.rhs().to_vec();
    if !kept.overruled.is_empty() {
        // The constants of the basis come from equations that were given up: run again with a b that agrees with the preferred ones.
        kept.overruled.iter().for_each(|&(i, excess)| rhs[i] -= excess);
        let agreeing = Pipeline { scaling: &scaling, local: numbering.view(system, &rhs), ..pipeline };
        let agreeing = agreeing.run_stages(&held_back)?;
        (pass.basis, pass.blocks) = (agreeing.basis, agreeing.blocks);
        let (sample, bound) = (ProbeSample::First, InverseEstimate::Bound);
        pass.probe = probe(local, &pass.basis, &agreeing.history, &scaling, &pass.keys, sample, bound);
    }
    let immobile = std::mem::take(&mut pass.probe.immobile);
    let generated = generated::find(immobile, local, &pass.basis, &pass.history, &scaling, &pass.keys);
    let analysis = pass.into_analysis(
        system.clone(),
        numbering,
        scaling,
        rhs,
        options.clone(),
        generated,
        confidence,
        kept.unmet,
        backend.as_ref(),
    );
    Ok(Analysis { ignored, ..analysis })
}

/// The scaling of the rows, and how far apart the units of each component are; no scaling for the tolerance of the paper.
fn scale(
    system: LocalSystem,
    columns: &[Column],
    exponents: &[Exponents],
    uncertain: &HashSet<(u32, u32)>,
    tolerance: Tolerance,
) -> (Scaling, Option<Spreads>) {
    match tolerance {
        Tolerance::Relative(_) => by_rows(system, columns, exponents, uncertain),
        Tolerance::Paper => (Scaling::none(system.equations()), None),
    }
}

/// The input of every run of the stages.
#[derive(Clone, Copy)]
struct Pipeline<'a> {
    local: LocalSystem<'a>,
    columns: &'a [Column],
    scaling: &'a Scaling,
    preferences: &'a SlavePreferences,
    /// (row, DOF) of coefficients that are rounding.
    uncertain: &'a HashSet<(u32, u32)>,
    is_absolute: bool,
    context: FactorContext<'a>,
    started: Instant,
}

/// The result of the last run, with presolve's decisions verified.
struct VerifiedPass {
    pass: PassResult,
    /// Rows held back from presolve.
    held_back: Vec<bool>,
    confidence: Confidence,
    /// Equations of the components whose rank or verdict is in doubt.
    doubted: Vec<usize>,
}

impl VerifiedPass {
    /// Whether the rank or a verdict is in doubt, by component.
    fn is_doubted(&self, labels: &Labels) -> Vec<bool> {
        let mut is_doubted = vec![false; labels.count];
        self.doubted.iter().for_each(|&i| is_doubted[labels.of_row[i] as usize] = true);
        is_doubted
    }
}

/// Runs the stages with columns balanced in the components that mix units, and in no others.
///
/// Components whose rank is then in doubt are run a second time, balanced if they were not and the reverse. The surer scaling of each
/// component wins; a third run combines the winners. The confidence keeps the doubt of all runs.
fn run_in_best_scaling(
    rows: &Scaling,
    spreads: &Spreads,
    run_verified: impl Fn(&Scaling) -> Result<VerifiedPass, AnalysisError>,
    balanced: impl Fn(&[bool]) -> Scaling,
) -> Result<(Scaling, VerifiedPass), AnalysisError> {
    let labels = &spreads.labels;
    let mixes_units = |k: usize| spreads.of[k] == Spread::UnitsMix;
    let scaled = |which: &dyn Fn(usize) -> bool| {
        if (0..spreads.of.len()).any(which) { balanced(&spreads.equations(which)) } else { rows.clone() }
    };
    let first_scaling = scaled(&mixes_units);
    let first = run_verified(&first_scaling)?;
    let first_doubted = first.is_doubted(labels);
    let is_tried = |k: usize| spreads.of[k] != Spread::Even && first_doubted[k];
    if !(0..spreads.of.len()).any(is_tried) {
        return Ok((first_scaling, first));
    }
    let second_scaling = scaled(&|k| mixes_units(k) != is_tried(k));
    let second = run_verified(&second_scaling)?;
    let second_doubted = second.is_doubted(labels);
    let sigma = [&first, &second].map(|verified| verified.pass.sigma_by_component(labels));
    let dependent = [&first, &second].map(|verified| verified.pass.dependent_by_component(labels));
    // Rows that are independent in one scaling are independent. So where units mix, fewer dependent rows speak for the second scaling.
    // Where they do not, it may have made small columns out of zeros, and the singular values decide.
    let is_worse = |k: usize| {
        if mixes_units(k) { dependent[1][k] >= dependent[0][k] } else { second_doubted[k] && sigma[0][k] > sigma[1][k] }
    };
    let goes_back = |k: usize| is_tried(k) && is_worse(k);
    let confidence = first.confidence.or_less(second.confidence);
    let (scaling, verified) = if (0..spreads.of.len()).any(goes_back) {
        let third_scaling = scaled(&|k| mixes_units(k) != (is_tried(k) && !goes_back(k)));
        let third = run_verified(&third_scaling)?;
        (third_scaling, third)
    } else {
        (second_scaling, second)
    };
    Ok((scaling, VerifiedPass { confidence, ..verified }))
}

impl Pipeline<'_> {
    /// Runs the stages until presolve's decisions are verified: once, twice or three times.
    ///
    /// The second run gives the components on which presolve should not have decided to the backend. The third run returns those to
    /// presolve that it had not lost digits on.
    fn run_verified(&self, presolve: bool) -> Result<VerifiedPass, AnalysisError> {
        let mut held_back = vec![!presolve; self.local.equations()];
        let first = self.run_and_probe(&held_back)?;
        if !presolve {
            let doubted = self.contradicted_by_presolve(&first)?;
            return self.with_confidence(first, held_back, doubted);
        }
        let doubtful = if self.context.check { first.doubtful_rows() } else { Vec::new() };
        if doubtful.is_empty() {
            return self.with_confidence(first, held_back, Vec::new());
        }
        let labels = Labels::of(self.local);
        labels.mark(&doubtful, &mut held_back);
        let second = match self.run_and_probe(&held_back) {
            Err(AnalysisError::Backend(BackendError::OverLimit { .. } | BackendError::OutOfMemory { .. })) => {
                // The components are too large for the backend: presolve's result, in doubt.
                held_back.fill(false);
                return self.with_confidence(first, held_back, doubtful);
            }
            second => second?,
        };
        // Where presolve, which follows each number, finds fewer dependent equations than the backend, they are not quite dependent.
        let counts = [first.dependent_by_component(&labels), second.dependent_by_component(&labels)];
        let disputed: Vec<bool> = (0..labels.count).map(|k| counts[0][k] < counts[1][k]).collect();
        let in_disputed = doubtful.iter().copied().filter(|&i| disputed[labels.of_row[i] as usize]);
        let remainders = first.dependent.iter().filter(|d| d.dropped > 0.0 && held_back[d.row]).map(|d| d.row);
        let doubted = in_disputed.chain(remainders).collect();
        let lost = first.lost_digits_by_component(&labels, self.context.tolerance);
        let returned: Vec<bool> = (0..labels.count).map(|k| disputed[k] && !lost[k]).collect();
        if !returned.contains(&true) {
            return self.with_confidence(second, held_back, doubted);
        }
        // As far as presolve can tell, these are no nearer to dependence than the tolerance: its rank holds.
        held_back.iter_mut().zip(&labels.of_row).for_each(|(held, &label)| *held &= !returned[label as usize]);
        let third = self.run_and_probe(&held_back)?;
        self.with_confidence(third, held_back, doubted)
    }

    /// For a run without presolve: its dependent equations in components where presolve finds fewer, and the equations that presolve
    /// itself doubts.
    fn contradicted_by_presolve(&self, backend_only: &PassResult) -> Result<Vec<usize>, AnalysisError> {
        if !self.context.check || backend_only.dependent.is_empty() {
            return Ok(Vec::new());
        }
        let labels = Labels::of(self.local);
        let presolved = self.run_verified(true)?;
        let counts = [backend_only, &presolved.pass].map(|pass| pass.dependent_by_component(&labels));
        let label = |i: usize| labels.of_row[i] as usize;
        let dependent = backend_only.dependent.iter().map(|d| d.row);
        let contradicted = dependent.filter(|&i| counts[1][label(i)] < counts[0][label(i)]);
        let doubted = presolved.doubted.iter().copied().filter(|&i| counts[0][label(i)] > 0);
        Ok(contradicted.chain(doubted).collect())
    }

    /// A run, and a probe of the rows that it kept; the probe is sharper where its first estimate is not harmless.
    fn run_and_probe(&self, held_back: &[bool]) -> Result<PassResult, AnalysisError> {
        let mut pass = self.run_stages(held_back)?;
        let probe_with = |pass: &PassResult, inverse| {
            let PassResult { basis, history, keys, .. } = pass;
            probe(self.local, basis, history, self.scaling, keys, ProbeSample::First, inverse)
        };
        pass.probe = probe_with(&pass, InverseEstimate::Bound);
        if !pass.probe.is_harmless() {
            if !pass.keys.are_within_components() {
                pass.keys = RandomKeys::within_components(&Labels::of(self.local), self.local);
            }
            let bound_of_inverse = std::mem::take(&mut pass.probe.bound_of_inverse);
            pass.probe = probe_with(&pass, InverseEstimate::Sample);
            pass.probe.bound_of_inverse = bound_of_inverse;
        }
        Ok(pass)
    }

    /// Adds the confidence. `doubted` are equations on which two runs disagree.
    fn with_confidence(
        &self,
        mut pass: PassResult,
        held_back: Vec<bool>,
        mut doubted: Vec<usize>,
    ) -> Result<VerifiedPass, AnalysisError> {
        let PassResult { basis, history, dependent, probe, .. } = &pass;
        let row = |t: usize| pass.users_row(t);
        let kept = sensitivity::KeptRows { system: self.local, basis, history, scaling: self.scaling };
        let sigma = if self.context.check { kept.sigma(probe, dependent, row, self.context.memory())? } else { 1.0 };
        doubted.extend(confidence::doubted(dependent, self.local.system()));
        let near = basis.blocks.iter().filter(|block| !block.nearness.is_sound());
        doubted.extend(near.filter_map(|block| block.rows.first()).map(|&row| history.rows[row as usize] as usize));
        let mut distance = 1.0;
        if self.context.check {
            let PassResult { blocks, triangles, .. } = &pass;
            let kept = KeptRows { system: self.local, basis, history, scaling: self.scaling, blocks, triangles };
            distance = kept.distance();
        }
        let confidence = Confidence::new(&basis.blocks, sigma, dependent, &doubted).with_distance(distance);
        pass.triangles = Vec::new();
        Ok(VerifiedPass { pass, held_back, confidence, doubted })
    }

    /// One run of the stages. Rows held back skip presolve and go to the backend.
    fn run_stages(&self, held_back: &[bool]) -> Result<PassResult, AnalysisError> {
        let Self { local, columns, scaling, preferences, uncertain, is_absolute, context, started } = *self;
        let least = if is_absolute { context.tolerance } else { 0.0 };
        let peeled = peel(local, columns, scaling, preferences, held_back, least);
        let remaining = (0..local.equations() as u32).filter(|&i| peeled.remaining[i as usize]).collect();
        let presolve_group = |names: Vec<u32>| {
            gather(local, names, scaling, uncertain)
                .map(|gathered| eliminate(gathered, context.tolerance, is_absolute, held_back))
        };
        let groups: Result<Vec<Eliminated>, _> = groups(local, remaining).into_par_iter().map(presolve_group).collect();
        let eliminated = Eliminated::join(groups.map_err(|row| AnalysisError::Range { row: row.0 })?);
        let presolved = Instant::now();
        let parts = eliminated.components(local.free());
        let keys = if parts.is_empty() {
            RandomKeys::default()
        } else {
            RandomKeys::within_components(&Labels::of(local), local)
        };
        let random = if parts.is_empty() { Vec::new() } else { random_sides(&eliminated, &keys) };
        let gather = |rows: &Vec<u32>| Block::new(&eliminated.rows, rows, local.free(), &random, !is_absolute);
        let blocks: Vec<Block> = parts.iter().map(gather).collect();
        // Blocks are independent, so they run in parallel in the caller's pool; their order does not depend on the threads.
        let diagnose = |block: &Block| block::diagnose(block, context);
        let diagnosed: Result<Vec<(Diagnosed, Triangle)>, _> = match blocks.as_slice() {
            few @ ([] | [_]) => few.iter().map(diagnose).collect(),
            many => many.par_iter().map(diagnose).collect(),
        };
        let (diagnosed, triangles): (Vec<Diagnosed>, Vec<Triangle>) = diagnosed?.into_iter().unzip();
        let factored = Instant::now();
        let presolve = statistics(&peeled, &eliminated, &blocks);
        let dependent = classify(&eliminated, &diagnosed, scaling, context.tolerance);
        let far_dependent = eliminated.dead.iter().filter(|dead| is_far(dead.reach)).map(|dead| dead.row).collect();
        let steps = eliminated.steps.iter().map(|step| step.row).collect();
        let (rows, factors) = (eliminated.names, eliminated.factors);
        let history = History { rows, factors, steps, exponents: scaling.row.clone() };
        let mut basis = peeled.basis;
        let dofs = blocks.iter().map(|block| block.dofs.clone());
        basis.extend(eliminated.steps, dofs.zip(diagnosed), scaling);
        Ok(PassResult {
            basis,
            blocks,
            triangles,
            history,
            dependent,
            far_dependent,
            keys,
            probe: NullspaceProbe::default(),
            presolve,
            started,
            presolved,
            factored,
        })
    }
}

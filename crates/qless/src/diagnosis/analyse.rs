//! The stages in order: equations, scaling, presolve, blocks, backend, classification.
//!
//! ```text
//! Numbering -> Scaling -> Pipeline::run_verified -> generated -> Analysis
//!
//! run_verified   run_stages, probe the kept rows
//!                doubtful components?  run_stages again; these components go to the backend instead of presolve, or the other way round
//!                presolve keeps more rows of a component than the backend?  presolve's rank is used
//!                other equations should be kept?  run_verified again without those that they replace
//!
//! run_stages     peel -> gather -> eliminate -> Block::gather -> diagnose -> classify
//! ```
//!
//! Each stage is a plain function from one owned value to the next.

use std::collections::{BTreeMap, BTreeSet};
use std::time::Instant;

use rayon::prelude::*;

use super::certificate::History;
use super::classify::{Dependent, MismatchRule, classify};
use super::confidence::{Confidence, Doubt};
use super::consistent::{as_combinations, is_worse, to_give_up};
use super::distance::CoreDistance;
use super::nullspace_probe::{InverseEstimate, NullspaceProbe, RandomKeys, is_far, probe, random_sides};
use super::pass_result::{PassResult, groups, statistics};
use super::preferred_equations::{exchanged, has_another_rank};
use super::{Analysis, AnalysisError, confidence, generated, hidden_conflicts};
use crate::factor::backend::BackendError;
use crate::factor::block::triangle::Triangle;
use crate::factor::block::{self, Block, FactorContext};
use crate::input::components::Labels;
use crate::input::noise::{of_right_hand_sides, relative_floors};
use crate::input::numbering::{Column, Exponents, LocalSystem, Numbering};
use crate::input::preferences::SlavePreferences;
use crate::input::scale::{Scaling, balanced};
use crate::presolve::basis::{Diagnosed, NEAR};
use crate::presolve::eliminate::eliminate;
use crate::presolve::eliminated::Eliminated;
use crate::presolve::gather::gather;
use crate::presolve::peel::peel;
use crate::{ConstraintSystem, Options, Tolerance};

/// The result of [`Numbering::new`].
pub(super) type Numbered = (Numbering, Vec<Column>, Vec<Exponents>);

/// Diagnoses a system in one reading of its numbers.
pub(super) fn read(
    system: ConstraintSystem,
    (numbering, columns, exponents): Numbered,
    options: &Options,
) -> Result<Analysis, AnalysisError> {
    let started = Instant::now();
    if let Some(row) = exponents.iter().position(|of_row| of_row.is_subnormal()) {
        return Err(AnalysisError::Subnormal { row });
    }
    let backend = options.backend.get(options.memory)?;
    let local = numbering.view(&system, system.rhs());
    let preferences = SlavePreferences::new(&options.preferences, &numbering, system.dofs());
    let scaling = match options.tolerance {
        Tolerance::Relative(_) => balanced(local, &exponents),
        Tolerance::Paper => Scaling::none(system.equations()),
    };
    let noise = of_right_hand_sides(local, &scaling.row, &options.noise);
    let floors = relative_floors(local, &options.noise);
    let rule = MismatchRule::new(local, &scaling, options);
    let pipeline = Pipeline {
        local,
        columns: &columns,
        scaling: &scaling,
        preferences: &preferences,
        noise: noise.as_deref(),
        floors: floors.as_deref(),
        rule: &rule,
        tolerance: options.tolerance,
        absent: &BTreeSet::new(),
        context: FactorContext {
            is_scaled: !options.tolerance.is_absolute() && floors.is_none(),
            ..FactorContext::new(backend.as_ref(), rule.tolerance, options.effort.checks(), options.memory)
        },
        started,
    };
    let first = pipeline.run_verified(options.presolve)?;
    let wanted = &options.preferences.equations;
    let given_up = to_give_up(&first.pass, &rule, wanted);
    let remainders = first.remainders(local);
    let list = |gone: &BTreeSet<usize>, pass: &PassResult| as_combinations(gone, pass, &rule, backend.as_ref());
    let (mut verified, given_up) = pipeline.without(given_up, first, options.presolve, list, is_worse)?;
    let pipeline = Pipeline { absent: &given_up, ..pipeline };
    verified.keep_remainders(&pipeline, remainders);
    let exchanged = exchanged(wanted, &verified.pass, &rule);
    let list = |gone: &BTreeSet<usize>, _: &PassResult| Ok(gone.iter().map(|row| exchanged[row].clone()).collect());
    let rows = exchanged.keys().copied().collect();
    let is_worse = |before: &_, after: &_, labels: &_, _: &_| has_another_rank(before, after, labels);
    let error = verified.confidence.error;
    let (mut verified, absent) = pipeline.without(rows, verified, options.presolve, list, is_worse)?;
    if absent.len() > given_up.len() {
        verified.confidence = pipeline.with_exchanged(&verified, exchanged, error);
    }
    let VerifiedPass { mut pass, confidence } = verified;
    let generated = generated::evaluate(std::mem::take(&mut pass.fixed), local, &pass.particular);
    Ok(pass.into_analysis(system, numbering, scaling, options.clone(), generated, confidence, backend.as_ref()))
}

/// The input of every run of the stages.
#[derive(Clone, Copy)]
struct Pipeline<'a> {
    local: LocalSystem<'a>,
    columns: &'a [Column],
    scaling: &'a Scaling,
    preferences: &'a SlavePreferences,
    /// Errors of right-hand sides, in scaled rows.
    noise: Option<&'a [f64]>,
    /// Errors of coefficients, relative to the largest of their equation.
    floors: Option<&'a [f64]>,
    rule: &'a MismatchRule<'a>,
    tolerance: Tolerance,
    /// Equations that are left out in favour of others.
    absent: &'a BTreeSet<usize>,
    context: FactorContext<'a>,
    started: Instant,
}

/// The result of the last run, with presolve's decisions verified.
struct VerifiedPass {
    pass: PassResult,
    confidence: Confidence,
}

impl VerifiedPass {
    /// The largest remainder of all dropped equations, and of those of each component; none if all are rounding.
    fn remainders(&self, local: LocalSystem) -> Option<(f64, Labels, Vec<f64>)> {
        let labels = (self.confidence.error > 0.0).then(|| Labels::of(local))?;
        let mut largest = vec![0.0_f64; labels.count];
        for d in &self.pass.dependent {
            let of_component = &mut largest[labels.of_row[d.row] as usize];
            *of_component = of_component.max(d.dropped);
        }
        Some((self.confidence.error, labels, largest))
    }

    /// Equations that were given up for dropped ones have their remainders: another choice of equations removes no doubt.
    fn keep_remainders(&mut self, pipeline: &Pipeline, remainders: Option<(f64, Labels, Vec<f64>)>) {
        let Some((error, labels, largest)) = remainders.filter(|_| !pipeline.absent.is_empty()) else { return };
        for d in self.pass.dependent.iter_mut().filter(|d| pipeline.absent.contains(&d.row)) {
            d.dropped = d.dropped.max(largest[labels.of_row[d.row] as usize]);
        }
        let Confidence { distance, doubt, .. } = self.confidence;
        self.confidence = Confidence::of(distance, self.confidence.error.max(error), pipeline.tolerance, doubt);
    }
}

impl Pipeline<'_> {
    /// Runs the stages until presolve's decisions are verified: once, twice or three times.
    ///
    /// With presolve, the second run sends the components in which presolve is doubtful to the backend. Without presolve, it sends the
    /// components with dependent equations to presolve. If presolve finds fewer dependent equations in a component than the backend,
    /// presolve's rank is used: no pivot of presolve has lost more than three digits, so the equations that presolve keeps are independent.
    fn run_verified(&self, presolve: bool) -> Result<VerifiedPass, AnalysisError> {
        let held_back = vec![!presolve; self.local.equations()];
        let first = self.run_and_probe(&held_back)?;
        let (mut known, mut labels) = (None, None);
        let doubtful: Vec<usize> = match presolve {
            _ if !self.context.check => Vec::new(),
            // A row of `steep_rows` is only a hint: it is doubtful if its component is nearly dependent. Rows of `lost_rows` and `far_rows`
            // have lost more than five digits, so they are doubtful at any distance from dependence.
            true if !first.probe.doubtful.is_empty() => {
                let distances = known.insert(self.distances(&first));
                let labels = labels.insert(Labels::of(self.local));
                let near = distances.iter().filter(|core| core.distance.is_nan() || core.distance < NEAR);
                let near: BTreeSet<u32> = near.map(|core| labels.of_row[core.row as usize]).collect();
                let is_near = |&row: &usize| near.contains(&labels.of_row[row]);
                first.steep_rows().filter(is_near).chain(first.lost_rows()).chain(first.far_rows()).collect()
            }
            true => first.far_rows().collect(),
            false => first.dependent.iter().map(|d| d.row).collect(),
        };
        if doubtful.is_empty() {
            return Ok(self.with_confidence(first, (0.0, false), known));
        }
        let labels = labels.unwrap_or_else(|| Labels::of(self.local));
        let mut is_tried = vec![false; held_back.len()];
        labels.mark(&doubtful, &mut is_tried);
        let other: Vec<bool> = held_back.iter().zip(&is_tried).map(|(&held, &tried)| held != tried).collect();
        let second = match self.run_and_probe(&other) {
            Err(AnalysisError::Backend(BackendError::OverLimit { .. } | BackendError::OutOfMemory { .. })) => {
                // The components are too large for the backend: return the first result, in doubt.
                return Ok(self.with_confidence(first, (0.0, presolve), None));
            }
            second => second?,
        };
        let (by_presolve, by_backend) = if presolve { (&first, &second) } else { (&second, &first) };
        let counts = [by_presolve, by_backend].map(|pass| pass.counts_by_component(&labels));
        let goes_to_presolve = |i: usize| {
            let label = labels.of_row[i] as usize;
            counts[0][label].0 < counts[1][label].0
        };
        let decided: Vec<bool> =
            (0..held_back.len()).map(|i| if is_tried[i] { !goes_to_presolve(i) } else { held_back[i] }).collect();
        let dropped = by_presolve.dependent.iter().filter(|d| is_tried[d.row]).map(|d| d.dropped).fold(0.0, f64::max);
        let pass = match &decided {
            decided if *decided == other => second,
            decided if *decided == held_back => first,
            decided => self.run_and_probe(decided)?,
        };
        Ok(self.with_confidence(pass, (dropped, false), None))
    }

    /// Runs without the equations in `gone`, too, which then are dependent as `list` says. They are taken back in the components for which
    /// `is_worse`, given the results before and after, is true. Returns the result and all equations left out.
    fn without(
        &self,
        mut gone: BTreeSet<usize>,
        first: VerifiedPass,
        presolve: bool,
        list: impl Fn(&BTreeSet<usize>, &PassResult) -> Result<Vec<Dependent>, AnalysisError>,
        is_worse: impl Fn(&PassResult, &PassResult, &Labels, &BTreeSet<usize>) -> Vec<bool>,
    ) -> Result<(VerifiedPass, BTreeSet<usize>), AnalysisError> {
        if gone.is_empty() {
            return Ok((first, self.absent.clone()));
        }
        let labels = Labels::of(self.local);
        while !gone.is_empty() {
            let absent = self.absent | &gone;
            let mut other = Pipeline { absent: &absent, ..*self }.run_verified(presolve)?;
            let listed = list(&gone, &other.pass)?;
            let is_before = |d: &&Dependent| self.absent.contains(&d.row) && !gone.contains(&d.row);
            other.pass.dependent.extend(first.pass.dependent.iter().filter(is_before).cloned().chain(listed));
            other.pass.dependent.sort_unstable_by_key(|d| d.row);
            let is_worse = is_worse(&first.pass, &other.pass, &labels, &gone);
            let count = gone.len();
            gone.retain(|&row| !is_worse[labels.of_row[row] as usize]);
            if gone.len() == count {
                return Ok((other, absent));
            }
        }
        Ok((first, self.absent.clone()))
    }

    /// The confidence of a run on preferred equations: another choice of equations, before which the error was `error`, removes no doubt.
    fn with_exchanged(&self, run: &VerifiedPass, exchanged: BTreeMap<usize, Dependent>, error: f64) -> Confidence {
        let VerifiedPass { pass, confidence } = run;
        let exchanged: Vec<Dependent> = exchanged.into_values().collect();
        let differ = confidence::are_sides_in_doubt(&exchanged, &pass.history, self.rule, self.tolerance);
        let doubt = confidence.doubt.or(differ.then_some(Doubt::Mismatch));
        Confidence::of(confidence.distance, confidence.error.max(error), self.tolerance, doubt)
    }

    /// Runs the stages and probes the kept rows. If a result of this probe is near or above its limit, a second probe replaces it. Its
    /// random numbers depend on the component alone, and it samples the inverse instead of bounding it.
    fn run_and_probe(&self, held_back: &[bool]) -> Result<PassResult, AnalysisError> {
        let mut pass = self.run_stages(held_back)?;
        let probe_with = |pass: &PassResult, inverse| {
            let PassResult { basis, history, keys, .. } = pass;
            probe(self.local, basis, history, self.scaling, keys, inverse)
        };
        pass.probe = probe_with(&pass, InverseEstimate::Bound);
        if !pass.probe.is_harmless() {
            if !pass.keys.are_within_components() {
                pass.keys = RandomKeys::within_components(&Labels::of(self.local), self.local);
            }
            pass.probe = probe_with(&pass, InverseEstimate::Sample);
        }
        Ok(pass)
    }

    /// Distances of the cores of the kept equations from dependence; empty without checks.
    fn distances(&self, pass: &PassResult) -> Vec<CoreDistance> {
        if self.context.check { pass.kept(self.local, self.scaling).distances() } else { Vec::new() }
    }

    /// Adds the confidence. `dropped` is the largest remainder that presolve dropped in components that were run twice. `is_unverified` is
    /// true if memory did not suffice to verify presolve. `known` are the distances, if they are computed already.
    fn with_confidence(
        &self,
        mut pass: PassResult,
        (dropped, is_unverified): (f64, bool),
        known: Option<Vec<CoreDistance>>,
    ) -> VerifiedPass {
        let distances = known.unwrap_or_else(|| self.distances(&pass));
        let distance = distances.iter().fold(1.0, |least: f64, core| least.min(core.distance));
        let is_typed = distances.iter().any(|core| core.is_typed);
        pass.distances = distances.iter().map(|core| (core.row, core.distance)).collect();
        if self.noise.is_none() && !self.tolerance.is_absolute() {
            self.find_hidden_conflicts(&mut pass);
        }
        let dependent = &pass.dependent;
        let reads_digits = self.rule.reads_digits() && self.tolerance.stated().is_none();
        let typed = (is_typed && reads_digits).then_some(Doubt::Near);
        let error = dependent.iter().map(|d| self.beyond_floors(d, &pass.history)).fold(dropped, f64::max);
        let elimination = is_unverified.then_some(Doubt::Elimination);
        let differ = confidence::are_sides_in_doubt(dependent, &pass.history, self.rule, self.tolerance);
        let other = typed.or(elimination).or(differ.then_some(Doubt::Mismatch));
        let confidence = Confidence::of(distance, error, self.tolerance, other);
        let kept = pass.kept(self.local, self.scaling);
        (pass.fixed, pass.particular) = generated::find(&kept, &pass.probe.slow, &pass.keys);
        pass.triangles = Vec::new();
        pass.blocks.iter_mut().for_each(Block::restore_units);
        VerifiedPass { pass, confidence }
    }

    /// Remainder of a dependent equation beyond rounding; 0 if it is within the stated errors of the coefficients of this equation or of
    /// the equations of its certificate.
    fn beyond_floors(&self, d: &Dependent, history: &History) -> f64 {
        let Some(floors) = self.floors.filter(|_| d.dropped > 0.0) else { return d.dropped };
        let members = d.source.explain(history).into_iter().map(|term| term.row).chain([d.row]);
        let floor = members.map(|row| floors[row]).fold(0.0, f64::max);
        if d.dropped > floor { d.dropped } else { 0.0 }
    }

    fn find_hidden_conflicts(&self, pass: &mut PassResult) {
        let (mut dependent, mut keys) = (std::mem::take(&mut pass.dependent), std::mem::take(&mut pass.keys));
        let kept = pass.kept(self.local, self.scaling);
        let distances = self.context.check.then_some(&pass.distances[..]);
        hidden_conflicts::find(&mut dependent, &mut keys, &kept, distances, self.rule);
        (pass.dependent, pass.keys) = (dependent, keys);
    }

    /// One run of the stages. Rows held back skip presolve and go to the backend.
    fn run_stages(&self, held_back: &[bool]) -> Result<PassResult, AnalysisError> {
        let Self { local, columns, scaling, preferences, noise, rule, tolerance, absent, context, started, .. } = *self;
        let is_absolute = tolerance.is_absolute();
        let least = if is_absolute { context.tolerance } else { 0.0 };
        let peeled = peel(local, columns, scaling, preferences, (held_back, absent), least);
        let remaining = (0..local.equations() as u32).filter(|&i| peeled.remaining[i as usize]).collect();
        let presolve_group = |names: Vec<u32>| {
            gather(local, names, scaling, noise)
                .map(|gathered| eliminate(gathered, context.tolerance, is_absolute, held_back))
        };
        let groups: Result<Vec<Eliminated>, _> = groups(local, remaining).into_par_iter().map(presolve_group).collect();
        let eliminated = Eliminated::join(groups.map_err(|row| AnalysisError::Range { row: row.0 })?);
        let parts = eliminated.components(local.free());
        let presolved = Instant::now();
        let draw = || {
            let keys = RandomKeys::within_components(&Labels::of(local), local);
            let random = random_sides(&eliminated, &keys);
            (keys, random)
        };
        let gather = || Block::gather(&eliminated.rows, &parts, local.free(), !is_absolute);
        let ((keys, random), mut blocks) =
            if parts.is_empty() { Default::default() } else { rayon::join(draw, gather) };
        blocks.iter_mut().for_each(|block| block.set_random(&random));
        // The order of the results does not depend on the threads.
        let diagnosed = block::diagnose_all(&mut blocks, context)?;
        let (diagnosed, triangles): (Vec<Diagnosed>, Vec<Triangle>) = diagnosed.into_iter().unzip();
        let factored = Instant::now();
        let presolve = statistics(&peeled, &eliminated, &blocks);
        let dependent = classify(&eliminated, &diagnosed, rule);
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
            fixed: Vec::new(),
            particular: Vec::new(),
            distances: Vec::new(),
            presolve,
            started,
            presolved,
            factored,
        })
    }
}

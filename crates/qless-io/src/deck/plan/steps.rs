//! Plans the changes of a deck whose load cases follow each other, as steps do.

use qless::common::DisjointSets;
use qless::{Kind, Options, Preferences, analyse};
use rustc_hash::{FxHashMap, FxHashSet};

use super::card_edits::text_of;
use super::layers::KeptEquations;
use super::{Cases, CleanError, Ended, Plan, PlanOptions, Reason, Removed, solved};
use crate::deck::faults::EquationFault;
use crate::deck::{Deck, LoadCase, Model};

/// Whether a format can remove an equation in a later load case.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum LateRemoval {
    Possible,
    Impossible,
}

/// Makes the plan for all load cases of a deck.
pub fn plan(deck: &Deck, options: PlanOptions, late_removal: LateRemoval) -> Result<Plan, CleanError> {
    let model = &deck.model;
    let plan = plan_for(deck, &model.cases, options)?;
    let says_more = || !plan.ended.is_empty() || plan.written.iter().any(|written| written.cases != Cases::All);
    if late_removal == LateRemoval::Impossible
        && (says_more() || !plan.is_empty() && model.cases.iter().any(|c| !c.removed.is_empty()))
    {
        return Err(CleanError::Apart { case: model.cases[model.cases.len() - 1].name.clone() });
    }
    Ok(plan)
}

/// Makes the plan for these load cases, which follow each other. All other load cases are ignored.
pub fn plan_for(deck: &Deck, cases: &[LoadCase], options: PlanOptions) -> Result<Plan, CleanError> {
    let kept = KeptEquations::choose(deck, cases, options)?;
    check_cases(&kept, cases)?;
    kept.plan()
}

impl KeptEquations<'_> {
    /// Decides which equations are removed, which are written, and which end early.
    fn plan(&self) -> Result<Plan, CleanError> {
        let count = self.model.equations();
        let before = self.faults(|i, k| self.end[i] >= Some(self.layers[k].last));
        let fault_of: FxHashMap<usize, EquationFault> =
            before.iter().rev().map(|fault| (fault.equation, *fault)).collect();
        // The earliest load cases prescribe the fewest DOFs, so their connected components are the largest.
        let first = &self.layers[self.layers.len() - 1].prescribed;
        let part_of = parts(self.model, |j| first.contains_key(&j));
        let mut is_rewritten = vec![false; part_of.iter().max().map_or(0, |last| last + 1)];
        let after = self.faults(|i, k| self.holds(i, k));
        after.iter().for_each(|fault| is_rewritten[part_of[fault.equation]] = true);
        self.split_lines().for_each(|i| is_rewritten[part_of[i]] = true);
        let is_removed = |i: &usize| self.end[*i].is_some() && self.layer_of[*i].is_none() || is_rewritten[part_of[*i]];
        let removed = (0..count).filter(is_removed).map(|i| Removed { equation: i, reason: self.reason(i, &fault_of) });
        let (removed, stays) = (removed.collect(), |i: &usize| !is_removed(i));
        let ended = (0..count).filter(stays).filter_map(|i| {
            let last = self.layers[self.layer_of[i]?].last;
            (Some(last) < self.end[i]).then_some(Ended { equation: i, last })
        });
        let ended = ended.collect();
        let written = solved::written(self, &|i| is_rewritten[part_of[i]])?;
        Ok(Plan { removed, written, ended })
    }

    fn reason(&self, i: usize, fault_of: &FxHashMap<usize, EquationFault>) -> Reason {
        match self.because.get(&i).filter(|_| self.layer_of[i].is_none()) {
            Some(because) => Reason::Redundant(because.clone()),
            None => fault_of.get(&i).map_or(Reason::Connected, |fault| Reason::Fault(*fault)),
        }
    }

    /// The equations that share an edit (a text line or a slave node) with an equation that ends in another load case, or that is dropped
    /// altogether. The edit cannot be made, because it drops all of its equations at once.
    fn split_lines(&self) -> impl Iterator<Item = usize> + '_ {
        let mut kept: FxHashMap<_, Option<usize>> = FxHashMap::default();
        let mut split = FxHashSet::default();
        for i in 0..self.model.equations() {
            if *kept.entry(self.edit_of(i)).or_insert(self.layer_of[i]) != self.layer_of[i] {
                split.insert(self.edit_of(i));
            }
        }
        (0..self.model.equations()).filter(move |&i| split.contains(&self.edit_of(i)))
    }
}

/// Checks that no load case has conflicting equations, and that the kept equations have the rank of the load case's own equations.
fn check_cases(kept: &KeptEquations, cases: &[LoadCase]) -> Result<(), CleanError> {
    for (k, case) in cases.iter().enumerate() {
        if k > 0 && case.constrains_as(&cases[k - 1]) {
            continue;
        }
        if conflicts(kept.model, case, kept.options)? {
            return Err(CleanError::Conflicting { case: case.name.clone() });
        }
        let analysis = analyse(&kept.model.system(case)?, &unpreferred(kept.options))?;
        let holds = |layer: &Option<usize>| layer.is_some_and(|layer| kept.layers[layer].last >= k);
        let (found, common) = (analysis.rank(), kept.layer_of.iter().filter(|layer| holds(layer)).count());
        if found != common {
            return Err(CleanError::CasesDiffer { case: case.name.clone(), found, common });
        }
    }
    Ok(())
}

/// Whether a load case has no solution. If its prescribed values have several time histories, the values of each history alone must have a
/// solution too.
pub fn conflicts(model: &Model, case: &LoadCase, options: &Options) -> Result<bool, CleanError> {
    let histories = model.histories_of(case);
    let mut systems = vec![model.system(case)?];
    for &history in histories.iter().filter(|_| histories.len() > 1) {
        systems.push(model.system_of_history(case, history)?);
    }
    for system in systems {
        let analysis = analyse(&system, &unpreferred(options))?;
        if analysis.dependent().iter().any(|one| one.kind == Kind::Conflicting) {
            return Ok(true);
        }
    }
    Ok(false)
}

/// The options without preferences: these number the equations of the whole deck, of which a load case may have fewer.
fn unpreferred(options: &Options) -> Options {
    Options { preferences: Preferences::default(), ..options.clone() }
}

/// For each equation, the number of its connected component. Components are numbered in the order of their first equations. Equations that
/// share a text line are connected too.
pub fn parts(model: &Model, is_prescribed: impl Fn(u32) -> bool) -> Vec<usize> {
    let mut sets = DisjointSets::new(model.equations());
    let mut by_column: FxHashMap<u32, usize> = FxHashMap::default();
    let mut by_text: FxHashMap<(u32, u32), usize> = FxHashMap::default();
    for i in 0..model.equations() {
        let equation = model.nth(i);
        let free =
            equation.columns.iter().zip(equation.coefficients).filter(|(j, a)| **a != 0.0 && !is_prescribed(**j));
        free.for_each(|(&j, _)| sets.join(*by_column.entry(j).or_insert(i), i));
        sets.join(*by_text.entry(text_of(model, equation.origin)).or_insert(i), i);
    }
    sets.numbered().0.into_iter().map(|number| number as usize).collect()
}

//! Plans the changes of a deck whose load cases are independent, as subcases are: each selects its own equations.
//!
//! If one plan cannot serve all load cases, each group of load cases that constrain alike gets its own plan. An equation that any group
//! removes is removed from the text, and rewritten for the groups that keep it.

use std::collections::BTreeMap;
use std::sync::Arc;

use rustc_hash::FxHashSet;

use super::card_edits::edit_of;
use super::steps::{LateRemoval, plan as common_plan, plan_for};
use super::{Cases, CleanError, Plan, PlanOptions, Reason, Removed, Written};
use crate::deck::{Deck, Model};

/// Makes one plan for all subcases, or else one for each group of subcases that constrain alike.
pub fn plan(deck: &Deck, options: PlanOptions) -> Result<Plan, CleanError> {
    match common_plan(deck, options, LateRemoval::Impossible) {
        Err(CleanError::CasesDiffer { .. } | CleanError::Apart { .. }) => plan_groups(deck, options),
        plan => plan,
    }
}

/// Groups of load cases that constrain alike, each given by the indices of its load cases.
fn groups(model: &Model) -> Vec<Vec<usize>> {
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for k in 0..model.cases.len() {
        let alike = |group: &&mut Vec<usize>| model.cases[group[0]].constrains_as(&model.cases[k]);
        match groups.iter_mut().find(alike) {
            Some(group) => group.push(k),
            None => groups.push(vec![k]),
        }
    }
    groups
}

fn plan_groups(deck: &Deck, options: PlanOptions) -> Result<Plan, CleanError> {
    let model = &deck.model;
    let groups = groups(model);
    let mut plans = Vec::with_capacity(groups.len());
    for group in &groups {
        let case = &model.cases[group[0]];
        let mut plan = plan_for(deck, std::slice::from_ref(case), options)?;
        // The plan of a case does not touch equations outside of it.
        plan.removed.retain(|removed| case.removed.binary_search(&(removed.equation as u32)).is_err());
        plans.push(plan);
    }
    let mut reasons: BTreeMap<usize, Reason> = BTreeMap::new();
    for removed in plans.iter().flat_map(|plan| &plan.removed) {
        reasons.entry(removed.equation).or_insert_with(|| removed.reason.clone());
    }
    let edit = |i: usize| edit_of(model, i, options.edits_cards);
    let edits: FxHashSet<_> = reasons.keys().map(|&i| edit(i)).collect();
    for i in (0..model.equations()).filter(|&i| edits.contains(&edit(i))) {
        reasons.entry(i).or_insert(Reason::Connected);
    }
    let mut written = Vec::new();
    for (group, plan) in groups.into_iter().zip(plans) {
        let (case, cases) = (&model.cases[group[0]], Cases::Only(Arc::from(group)));
        let gone: FxHashSet<usize> = plan.removed.iter().map(|removed| removed.equation).collect();
        let stays = model.in_force(case).filter(|i| reasons.contains_key(i) && !gone.contains(i));
        let solved = plan.written.into_iter();
        written.extend(
            stays.map(|i| normalised(model, i)).chain(solved).map(|one| Written { cases: cases.clone(), ..one }),
        );
    }
    let removed = reasons.into_iter().map(|(equation, reason)| Removed { equation, reason }).collect();
    Ok(Plan { removed, written, ended: Vec::new() })
}

/// Equation `i` of the deck, divided by the coefficient of its slave.
fn normalised(model: &Model, i: usize) -> Written {
    let equation = model.nth(i);
    let own = equation.coefficients.first().copied().unwrap_or(1.0);
    let term = |(&j, &a): (&u32, &f64)| (model.dofs[j as usize], a / own);
    let terms = equation.columns.iter().zip(equation.coefficients).skip(1).map(term).filter(|term| term.1 != 0.0);
    let slave = model.dofs[equation.columns.first().copied().unwrap_or(0) as usize];
    Written { slave, terms: terms.collect(), rhs: equation.rhs / own, cases: Cases::All }
}

//! Chooses the set of the new `MPC` cards of each group of load cases, and the new selection of every load case.
//!
//! If some set is selected by exactly the load cases of the group, the new cards join it. Otherwise they get a new set. A load case that
//! also needs cards of its old sets selects a new union of the old sets and the new one.

use std::collections::{BTreeMap, BTreeSet};

use crate::deck::clean::{CleanError, Removed, Written};
use crate::deck::nastran::cards::sets::members;
use crate::deck::nastran::control::selected::selections;
use crate::deck::nastran::reader::NastranContent;
use crate::deck::{Deck, Model};

/// A group: load cases, by their index in the model, and the new equations that hold in exactly these load cases.
pub type EquationGroup = (Vec<usize>, Vec<Written>);

/// The sets of the new cards, and which sets the load cases select.
pub struct MpcTargets<'a> {
    /// For each group with new equations: the number of its set, and the equations.
    pub cards: Vec<(u32, &'a [Written])>,
    /// The number of each new union, by the sets that it unites.
    pub unions: BTreeMap<Vec<u32>, u32>,
    /// For each load case, the MPC set that it selects before the change and after it.
    pub selected: Vec<(Option<u32>, Option<u32>)>,
    /// Sets that have lost all their cards, and unions that contain only such sets.
    pub dead: BTreeSet<u32>,
}

impl<'a> MpcTargets<'a> {
    pub fn new(
        content: &NastranContent,
        deck: &Deck,
        removed: &[Removed],
        groups: &'a [EquationGroup],
    ) -> Result<Self, CleanError> {
        let before = SelectedSets::new(content);
        let written = || groups.iter().filter(|(_, written)| !written.is_empty());
        let refused = |why| CleanError::Place { path: deck.model.files[0].clone(), line: 1, why };
        if written().any(|(_, written)| written.iter().any(|written| written.rhs != 0.0)) {
            return Err(refused("an equation has a right-hand side, which MPC cards cannot have; change it by hand"));
        }
        let mut unused = last_set(content);
        let mut next = || {
            unused = unused.saturating_add(1);
            unused
        };
        let sets: Vec<(&EquationGroup, u32, bool)> = written()
            .map(|group| before.own_set(&group.0).map_or_else(|| (group, next(), true), |set| (group, set, false)))
            .collect();
        if content.control.is_none() && sets.iter().any(|&(_, set, is_new)| is_new && set > 1) {
            return Err(refused("the deck has no case control to select an MPC set with; add one with `MPC = n`"));
        }
        let kept = kept(content, deck, removed).chain(sets.iter().map(|(_, set, _)| *set)).collect();
        let mut targets = Self {
            cards: sets.iter().map(|(group, set, _)| (*set, group.1.as_slice())).collect(),
            unions: BTreeMap::new(),
            selected: before.sets.iter().map(|&set| (set, set)).collect(),
            dead: dead(content, &kept),
        };
        for (group, set, _) in sets.iter().filter(|(.., is_new)| *is_new) {
            for &case in group.0.iter().filter(|&&case| case < before.sets.len()) {
                let mut parts: Vec<u32> = before.members[case].intersection(&kept).copied().collect();
                parts.push(*set);
                let whole =
                    if parts.len() == 1 { *set } else { *targets.unions.entry(parts).or_insert_with(&mut next) };
                targets.selected[case].1 = Some(whole);
            }
        }
        for (_, after) in &mut targets.selected {
            *after = after.filter(|set| !targets.dead.contains(set));
        }
        Ok(targets)
    }

    /// The new set that all load cases select; `None` if they select different ones, or if some load case selected a set before.
    pub fn common(&self) -> Option<u32> {
        let (_, first) = *self.selected.first()?;
        first.filter(|_| self.selected.iter().all(|&(before, after)| before.is_none() && after == first))
    }
}

/// The MPC set that each load case selects, and the elementary sets in it.
struct SelectedSets {
    sets: Vec<Option<u32>>,
    members: Vec<BTreeSet<u32>>,
}

impl SelectedSets {
    fn new(content: &NastranContent) -> Self {
        let mut unused = Model::new(Vec::new());
        let chosen = selections(content.control.as_ref(), &content.bulk, &mut unused);
        let sets: Vec<Option<u32>> = chosen.iter().map(|(_, choice)| choice.mpc.map(|choice| choice.set)).collect();
        // There is no error here: the model could be built, so no union contains itself.
        let members_of = |set: &Option<u32>| set.map(|set| members(set, &content.bulk.mpc_unions).unwrap_or_default());
        let members = sets.iter().map(|set| members_of(set).unwrap_or_default()).collect();
        Self { sets, members }
    }

    /// A set that belongs to all of these load cases and to no other one.
    fn own_set(&self, cases: &[usize]) -> Option<u32> {
        let (inside, outside): (Vec<usize>, Vec<usize>) =
            (0..self.members.len()).partition(|case| cases.contains(case));
        let first = inside.first()?;
        let is_own = |set: &&u32| {
            inside.iter().all(|&case| self.members[case].contains(set))
                && !outside.iter().any(|&case| self.members[case].contains(set))
        };
        self.members[*first].iter().find(is_own).copied()
    }
}

/// The sets of the `MPC` cards that are not removed.
fn kept(content: &NastranContent, deck: &Deck, removed: &[Removed]) -> impl Iterator<Item = u32> {
    let place = |removed: &Removed| {
        let origin = deck.model.nth(removed.equation).origin;
        (deck.model.cards.nth(origin.card).file, origin.line)
    };
    let gone: BTreeSet<(u32, u32)> = removed.iter().map(place).collect();
    content.bulk.ties.mpcs().filter(move |card| !gone.contains(&(card.file, card.line))).map(|card| card.set)
}

/// The sets that have lost all their cards, and the unions that contain only such sets.
fn dead(content: &NastranContent, kept: &BTreeSet<u32>) -> BTreeSet<u32> {
    let mut dead: BTreeSet<u32> =
        content.bulk.ties.mpcs().map(|card| card.set).filter(|set| !kept.contains(set)).collect();
    let unions = &content.bulk.mpc_unions;
    let is_dead = |set: &&u32| {
        let members = members(**set, unions).unwrap_or_default();
        !members.is_empty() && members.is_subset(&dead)
    };
    let whole: Vec<u32> = unions.keys().filter(is_dead).copied().collect();
    dead.extend(whole);
    dead
}

/// The largest number of an MPC set that the deck defines or selects; 0 if there is none.
fn last_set(content: &NastranContent) -> u32 {
    let own = content.bulk.ties.mpcs().map(|card| card.set);
    let unions = content.bulk.mpc_unions.iter();
    let named = unions.flat_map(|(&set, cards)| cards.iter().flat_map(|(of, _)| of.iter().copied()).chain([set]));
    let selected = content.control.iter().flat_map(|control| &control.mpc_choices).map(|(_, choice)| choice.set);
    own.chain(named).chain(selected).max().unwrap_or(0)
}

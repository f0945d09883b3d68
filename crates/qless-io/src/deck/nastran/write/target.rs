//! Chooses the set of the new `MPC` cards of each group of load cases, and the new selection of every load case.
//!
//! The set is one that exactly the load cases of the group select, or else a new one. A load case that also needs cards of its old sets
//! selects a new union of the old sets and this one.

use std::collections::{BTreeMap, BTreeSet};

use crate::deck::clean::{CleanError, Removed, Written};
use crate::deck::nastran::cards::sets::members;
use crate::deck::nastran::control::selected::selections;
use crate::deck::nastran::reader::NastranContent;
use crate::deck::{Deck, Model};

/// Load cases by their index in the model, and the new equations that hold in exactly these.
pub type EquationGroup = (Vec<usize>, Vec<Written>);

/// Sets of the new cards, and selections of the load cases.
pub struct MpcTargets<'a> {
    /// The set of each group that writes equations.
    pub cards: Vec<(u32, &'a [Written])>,
    /// New unions.
    pub unions: BTreeMap<Vec<u32>, u32>,
    /// The MPC set that each load case selects before and after.
    pub selected: Vec<(Option<u32>, Option<u32>)>,
    /// Sets whose cards are all removed, and unions of such sets only.
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

    /// The new set that all load cases select, if none of them selected any set before.
    pub fn common(&self) -> Option<u32> {
        let (_, first) = *self.selected.first()?;
        first.filter(|_| self.selected.iter().all(|&(before, after)| before.is_none() && after == first))
    }
}

/// MPC selections of the load cases, and the sets in each.
struct SelectedSets {
    sets: Vec<Option<u32>>,
    members: Vec<BTreeSet<u32>>,
}

impl SelectedSets {
    fn new(content: &NastranContent) -> Self {
        let mut unused = Model::new(Vec::new());
        let chosen = selections(content.control.as_ref(), &content.bulk, &mut unused);
        let sets: Vec<Option<u32>> = chosen.iter().map(|(_, choice)| choice.mpc.map(|choice| choice.set)).collect();
        // The model could be built, so no union contains itself.
        let members_of = |set: &Option<u32>| set.map(|set| members(set, &content.bulk.mpc_unions).unwrap_or_default());
        let members = sets.iter().map(|set| members_of(set).unwrap_or_default()).collect();
        Self { sets, members }
    }

    /// A set that all of these load cases contain and no other does.
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

/// Sets that keep a card.
fn kept(content: &NastranContent, deck: &Deck, removed: &[Removed]) -> impl Iterator<Item = u32> {
    let place = |removed: &Removed| {
        let origin = deck.model.nth(removed.equation).origin;
        (deck.model.cards.nth(origin.card).file, origin.line)
    };
    let gone: BTreeSet<(u32, u32)> = removed.iter().map(place).collect();
    content.bulk.ties.mpcs().filter(move |card| !gone.contains(&(card.file, card.line))).map(|card| card.set)
}

/// Sets whose cards are all removed, and unions of such sets only.
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

/// The largest number of an MPC set, defined or selected; 0 if there is none.
fn last_set(content: &NastranContent) -> u32 {
    let own = content.bulk.ties.mpcs().map(|card| card.set);
    let unions = content.bulk.mpc_unions.iter();
    let named = unions.flat_map(|(&set, cards)| cards.iter().flat_map(|(of, _)| of.iter().copied()).chain([set]));
    let selected = content.control.iter().flat_map(|control| &control.mpc_choices).map(|(_, choice)| choice.set);
    own.chain(named).chain(selected).max().unwrap_or(0)
}

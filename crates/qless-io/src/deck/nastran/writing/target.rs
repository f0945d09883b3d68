//! The set that new `MPC` cards go to, so that it is selected in every subcase; and selections that lose their last card.

use std::collections::BTreeSet;

use super::write::Change;
use crate::deck::clean::{CleanError, Plan};
use crate::deck::nastran::cards::sets::members;
use crate::deck::nastran::control::selected::selections;
use crate::deck::nastran::control::subcases::Selection;
use crate::deck::nastran::syntax::content::Content;
use crate::deck::{Deck, Model};

/// The set of the new cards.
pub struct Target {
    pub set: u32,
    /// Whether case control has to be told of it.
    is_new: bool,
    /// Selected sets none of whose cards stay.
    emptied: BTreeSet<u32>,
}

impl Target {
    pub fn of(content: &Content, deck: &Deck, plan: &Plan) -> Result<Self, CleanError> {
        let mut unused = Model::new(Vec::new());
        let selections = selections(content, &mut unused);
        let mut chosen = selections.iter().map(|(_, selection)| set_of(selection));
        let first = chosen.next().flatten();
        let is_one = chosen.all(|set| set == first);
        let refused = |why| CleanError::Place { path: deck.model.files[0].clone(), line: 1, why };
        if !plan.written.is_empty() && !is_one {
            return Err(refused(
                "subcases select different MPC sets, so that no one set can hold new cards; make a deck of each",
            ));
        }
        if plan.written.iter().any(|written| written.rhs != 0.0) {
            return Err(refused("an equation has a right-hand side, which MPC cards cannot have; change it by hand"));
        }
        let target = match first {
            Some(set) => {
                // The union could be read, so it has no circle.
                let direct = members(set, &content.bulk.mpc_unions).unwrap_or_default();
                Self { set: direct.first().copied().unwrap_or(set), is_new: false, emptied: BTreeSet::new() }
            }
            None => Self { set: unused_set(content), is_new: !plan.written.is_empty(), emptied: BTreeSet::new() },
        };
        if target.is_new && content.control.is_none() && target.set > 1 {
            return Err(refused("the deck has no case control to select an MPC set with; add one with `MPC = n`"));
        }
        target.without_emptied(content, deck, plan)
    }

    /// Notes selected sets that lose all of their cards and get no new ones.
    fn without_emptied(mut self, content: &Content, deck: &Deck, plan: &Plan) -> Result<Self, CleanError> {
        let place = |i: usize| {
            let origin = deck.model.nth(i).origin;
            (deck.model.cards.nth(origin.card).file, origin.line)
        };
        let gone: BTreeSet<(u32, u32)> = plan.removed.iter().map(|removed| place(removed.equation)).collect();
        let (mut before, mut after) = (BTreeSet::new(), BTreeSet::new());
        for card in content.bulk.ties.mpcs() {
            before.insert(card.set);
            if !gone.contains(&(card.file, card.line)) {
                after.insert(card.set);
            }
        }
        if !plan.written.is_empty() {
            after.insert(self.set);
        }
        self.emptied = before.difference(&after).copied().collect();
        let in_union = |set: &u32| content.bulk.mpc_unions.values().flatten().find(|(of, _)| of.contains(set));
        match self.emptied.iter().find_map(in_union) {
            Some((_, place)) => Err(CleanError::Place {
                path: deck.model.files[place.file as usize].clone(),
                line: place.line as usize,
                why: "a set of this MPCADD card would lose its last card; move one there or drop the set from the list",
            }),
            None => Ok(self),
        }
    }

    /// Changes to case control: a new selection, and selections of sets without cards taken out.
    pub fn changes(&self, content: &Content) -> Vec<Change> {
        let mut changes = Vec::new();
        let Some(control) = &content.control else { return changes };
        if let Some(at) = content.landmarks.control.filter(|_| self.is_new) {
            changes.push((at, 0, format!("$ qless: selects the equations written below\nMPC = {}\n", self.set)));
        }
        // Where no selection is in force, those that are there would take the place of the new one.
        for choice in control.mpc_choices.iter().filter(|choice| self.is_new || self.emptied.contains(&choice.set)) {
            let why = if self.is_new { "another set is selected" } else { "the set has no cards left" };
            let text = format!("$ qless: MPC = {} removed, as {why}\n", choice.set);
            changes.push(((choice.file, choice.line), 1, text));
        }
        changes
    }
}

fn set_of(selection: &Selection) -> Option<u32> {
    selection.mpc.map(|choice| choice.set)
}

/// One more than the largest number of an MPC set; 1 where there is none.
fn unused_set(content: &Content) -> u32 {
    let own = content.bulk.ties.mpcs().map(|card| card.set);
    let unions = content.bulk.mpc_unions.iter();
    let named = unions.flat_map(|(&set, cards)| cards.iter().flat_map(|(of, _)| of.iter().copied()).chain([set]));
    own.chain(named).max().unwrap_or(0).saturating_add(1)
}

//! Which sets hold in each load case, and a warning for those that hold in none or do not exist.

use std::collections::{BTreeMap, BTreeSet};

use super::subcases::{Choice, Selection};
use super::{one_for_the_run, unions};
use crate::deck::nastran::cards::bulk::Bulk;
use crate::deck::nastran::cards::loads::parts;
use crate::deck::nastran::cards::sets::{Unions, members};
use crate::deck::nastran::model::build::fail;
use crate::deck::nastran::syntax::content::Content;
use crate::deck::nastran::syntax::place::Place;
use crate::deck::{DeckError, Model};

/// The sets of a load case, unions taken apart.
#[derive(Clone, Debug, Default)]
pub struct Sets {
    pub mpc: BTreeSet<u32>,
    pub spc: BTreeSet<u32>,
    /// Load sets with their factors.
    pub loads: BTreeMap<u32, f64>,
}

/// The sets that the selections come down to.
pub fn sets(
    mut selections: Vec<(String, Selection)>,
    bulk: &Bulk,
    model: &mut Model,
) -> Result<Vec<(String, Sets)>, DeckError> {
    let defined = Defined::of(bulk);
    if bulk.is_mystran {
        one_for_the_run::carry_on(&mut selections, bulk, model);
    }
    unions::refuse(&selections, bulk, model);
    let mut cases = Vec::with_capacity(selections.len());
    let mut missing = BTreeSet::new();
    for (name, selection) in selections {
        let mpc = members_of(selection.mpc, &bulk.mpc_unions, model)?;
        let spc = members_of(selection.spc, &bulk.spc_unions, model)?;
        note_missing("MPC", selection.mpc, &mpc, &defined.mpc, &mut missing);
        note_missing("SPC", selection.spc, &spc, &defined.spc, &mut missing);
        let loads = selection.load.map(|choice| parts(choice.set, &bulk.combinations)).unwrap_or_default();
        cases.push((name, Sets { mpc, spc, loads }));
    }
    for (file, line, text) in missing {
        if bulk.is_mystran {
            model.refuse(file, line, format!("{text}, where MYSTRAN stops"));
        } else {
            model.warn(file, line, format!("{text}: it constrains nothing"));
        }
    }
    defined.warn_of_unused(&cases, model);
    Ok(cases)
}

fn members_of(choice: Option<Choice>, unions: &Unions, model: &mut Model) -> Result<BTreeSet<u32>, DeckError> {
    let members = choice.map(|choice| members(choice.set, unions)).transpose();
    Ok(members.map_err(|(place, problem)| fail(&place, problem, model))?.unwrap_or_default())
}

fn note_missing(
    kind: &str,
    choice: Option<Choice>,
    members: &BTreeSet<u32>,
    defined: &Uses,
    missing: &mut BTreeSet<(u32, u32, String)>,
) {
    for set in members.iter().filter(|set| !defined.contains_key(set)) {
        if let Some(Choice { file, line, set: chosen }) = choice {
            let text = format!("{kind} = {chosen} selects set {set}, which no {kind} card defines");
            missing.insert((file, line, text));
        }
    }
}

/// Sets with their first card and the number of cards.
type Uses = BTreeMap<u32, (Place, usize)>;

/// The sets that the bulk data define.
struct Defined {
    mpc: Uses,
    spc: Uses,
    enforced: Uses,
}

impl Defined {
    fn of(bulk: &Bulk) -> Self {
        let mut all = Self { mpc: Uses::new(), spc: Uses::new(), enforced: Uses::new() };
        let mut cards = bulk.ties.mpcs().peekable();
        while let Some(card) = cards.next() {
            // Cards of a set mostly stand together.
            let more = std::iter::from_fn(|| cards.next_if(|next| next.set == card.set)).count();
            count(&mut all.mpc, card.set, &card.place(), 1 + more);
        }
        bulk.supports.iter().for_each(|(set, _, place)| count(&mut all.spc, *set, place, 1));
        bulk.enforced.iter().for_each(|(set, _, place)| count(&mut all.enforced, *set, place, 1));
        all
    }

    fn warn_of_unused(&self, cases: &[(String, Sets)], model: &mut Model) {
        warn_unused("MPC", &self.mpc, |set| cases.iter().any(|(_, sets)| sets.mpc.contains(&set)), model);
        warn_unused("SPC", &self.spc, |set| cases.iter().any(|(_, sets)| sets.spc.contains(&set)), model);
        warn_unused("SPCD", &self.enforced, |set| cases.iter().any(|(_, sets)| sets.loads.contains_key(&set)), model);
    }
}

fn count(uses: &mut Uses, set: u32, place: &Place, cards: usize) {
    uses.entry(set).or_insert_with(|| (place.clone(), 0)).1 += cards;
}

fn warn_unused(kind: &str, uses: &Uses, used: impl Fn(u32) -> bool, model: &mut Model) {
    const SHOWN: usize = 10;
    let unused: Vec<(&u32, &(Place, usize))> = uses.iter().filter(|(set, _)| !used(**set)).collect();
    let Some((_, (place, _))) = unused.first() else { return };
    let cards: usize = unused.iter().map(|(_, (_, cards))| cards).sum();
    let mut names: Vec<String> = unused.iter().take(SHOWN).map(|(set, _)| set.to_string()).collect();
    if unused.len() > SHOWN {
        names.push("...".into());
    }
    let text = format!("{kind} sets that no subcase selects are left out: {} ({cards} entries)", names.join(", "));
    model.warn(place.file, place.line, text);
}

/// What the load cases select.
pub fn selections(content: &Content, model: &mut Model) -> Vec<(String, Selection)> {
    match &content.control {
        Some(control) => control.selections(),
        None => without_control(&content.bulk, model),
    }
}

/// Bulk data alone select nothing: the only set of a kind is taken, and that is said.
fn without_control(bulk: &Bulk, model: &mut Model) -> Vec<(String, Selection)> {
    let defined = Defined::of(bulk);
    let mpc = only("MPC", &defined.mpc, &bulk.mpc_unions, model);
    let spc = only("SPC", &defined.spc, &bulk.spc_unions, model);
    vec![("model".into(), Selection { mpc, spc, load: None })]
}

fn only(kind: &str, uses: &Uses, unions: &Unions, model: &mut Model) -> Option<Choice> {
    // A union that takes in all sets is the one meant.
    let whole = |set: &&u32| members(**set, unions).is_ok_and(|members| uses.keys().all(|set| members.contains(set)));
    let meant = if uses.len() > 1 { unions.keys().find(whole) } else { uses.keys().next() };
    let set = *meant?;
    let (place, _) = uses.values().next()?;
    let text = format!("the deck has no case control: {kind} set {set}, the only one, is taken");
    model.warn(place.file, place.line, text);
    Some(Choice { set, file: place.file, line: place.line })
}

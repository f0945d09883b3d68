//! Finds the sets that hold in each load case; unions are resolved to the sets in them.
//!
//! Warns of sets that hold in no load case, and of selected sets that do not exist. Solvers refuse `MPCADD` and `SPCADD` cards that name a
//! set twice or name another union. MYSTRAN allows one MPC set and one SPC set per run: a subcase inherits the selection of the previous
//! one, and MYSTRAN stops (error 1830) if two subcases differ.

use std::collections::{BTreeMap, BTreeSet};

use super::subcases::{CaseControl, CaseSelection, SetChoice};
use crate::deck::nastran::cards::bulk::BulkData;
use crate::deck::nastran::cards::loads::parts;
use crate::deck::nastran::cards::sets::{SetUnions, members};
use crate::deck::nastran::syntax::card::CardLocation;
use crate::deck::{DeckError, Model};

/// The sets that hold in a load case; unions are resolved to the sets in them.
#[derive(Clone, Debug, Default)]
pub struct CaseSets {
    pub mpc: BTreeSet<u32>,
    pub spc: BTreeSet<u32>,
    /// The load sets, each with its factor.
    pub loads: BTreeMap<u32, f64>,
}

/// Resolves the selection of each load case to the sets that hold in it.
pub fn sets(
    mut selections: Vec<(String, CaseSelection)>,
    bulk: &BulkData,
    model: &mut Model,
) -> Result<Vec<(String, CaseSets)>, DeckError> {
    let defined = DefinedSets::new(bulk);
    if bulk.is_mystran {
        inherit(&mut selections, bulk, model);
    }
    refuse_unions(&selections, bulk, model);
    let mut cases = Vec::with_capacity(selections.len());
    let mut missing = BTreeSet::new();
    for (name, selection) in selections {
        let mpc = members_of(selection.mpc, &bulk.mpc_unions, model)?;
        let spc = members_of(selection.spc, &bulk.spc_unions, model)?;
        let kinds = [("MPC", selection.mpc, &mpc, &defined.mpc), ("SPC", selection.spc, &spc, &defined.spc)];
        for (kind, choice, members, defined) in kinds {
            for set in members.iter().filter(|set| !defined.contains_key(set)) {
                if let Some(SetChoice { file, line, set: chosen }) = choice {
                    let text = format!("{kind} = {chosen} selects set {set}, which no {kind} card defines");
                    missing.insert((file, line, text));
                }
            }
        }
        let loads = selection.load.map(|choice| parts(choice.set, &bulk.combinations)).unwrap_or_default();
        cases.push((name, CaseSets { mpc, spc, loads }));
    }
    for (file, line, text) in missing {
        if bulk.is_mystran {
            model.refuse(file, line, format!("{text}, where MYSTRAN stops"));
        } else {
            model.warn(file, line, format!("{text}: it constrains nothing"));
        }
    }
    warn_unused("MPC", &defined.mpc, |set| cases.iter().any(|(_, sets)| sets.mpc.contains(&set)), model);
    warn_unused("SPC", &defined.spc, |set| cases.iter().any(|(_, sets)| sets.spc.contains(&set)), model);
    warn_unused("SPCD", &defined.enforced, |set| cases.iter().any(|(_, sets)| sets.loads.contains_key(&set)), model);
    Ok(cases)
}

fn members_of(choice: Option<SetChoice>, unions: &SetUnions, model: &mut Model) -> Result<BTreeSet<u32>, DeckError> {
    let members = choice.map(|choice| members(choice.set, unions)).transpose();
    Ok(members.map_err(|(place, problem)| place.error(problem, model))?.unwrap_or_default())
}

/// For each number of a set: the place of its first card, and the number of its cards.
type SetUses = BTreeMap<u32, (CardLocation, usize)>;

/// The sets that the bulk data define.
struct DefinedSets {
    mpc: SetUses,
    spc: SetUses,
    enforced: SetUses,
}

impl DefinedSets {
    fn new(bulk: &BulkData) -> Self {
        let mut all = Self { mpc: SetUses::new(), spc: SetUses::new(), enforced: SetUses::new() };
        let mut cards = bulk.ties.mpcs().peekable();
        while let Some(card) = cards.next() {
            // Cards of a set are usually consecutive, so consecutive ones are counted together.
            let more = std::iter::from_fn(|| cards.next_if(|next| next.set == card.set)).count();
            count(&mut all.mpc, card.set, &card.place(), 1 + more);
        }
        bulk.supports.iter().for_each(|(set, _, place)| count(&mut all.spc, *set, place, 1));
        bulk.enforced.iter().for_each(|(set, _, place)| count(&mut all.enforced, *set, place, 1));
        all
    }
}

fn count(uses: &mut SetUses, set: u32, place: &CardLocation, cards: usize) {
    uses.entry(set).or_insert_with(|| (place.clone(), 0)).1 += cards;
}

fn warn_unused(kind: &str, uses: &SetUses, used: impl Fn(u32) -> bool, model: &mut Model) {
    const SHOWN: usize = 10;
    let unused: Vec<(&u32, &(CardLocation, usize))> = uses.iter().filter(|(set, _)| !used(**set)).collect();
    let Some((_, (place, _))) = unused.first() else { return };
    let cards: usize = unused.iter().map(|(_, (_, cards))| cards).sum();
    let mut names: Vec<String> = unused.iter().take(SHOWN).map(|(set, _)| set.to_string()).collect();
    if unused.len() > SHOWN {
        names.push("...".into());
    }
    let text = format!(
        "{kind} sets that no subcase selects are left out: {} ({cards} {})",
        names.join(", "),
        if cards == 1 { "entry" } else { "entries" }
    );
    model.warn(place.file, place.line, text);
}

/// The selection of each load case. A deck without case control selects the only set of each kind, or else a union of all sets of
/// that kind, with a warning.
pub fn selections(control: Option<&CaseControl>, bulk: &BulkData, model: &mut Model) -> Vec<(String, CaseSelection)> {
    if let Some(control) = control {
        return control.selections();
    }
    let defined = DefinedSets::new(bulk);
    let mpc = only("MPC", &defined.mpc, &bulk.mpc_unions, model);
    let spc = only("SPC", &defined.spc, &bulk.spc_unions, model);
    vec![("model".into(), CaseSelection { mpc, spc, load: None })]
}

fn only(kind: &str, uses: &SetUses, unions: &SetUnions, model: &mut Model) -> Option<SetChoice> {
    // A union that contains all sets is probably what the user wants to select.
    let is_whole =
        |set: &&u32| members(**set, unions).is_ok_and(|members| uses.keys().all(|set| members.contains(set)));
    let (set, which) = if uses.len() > 1 {
        (*unions.keys().find(is_whole)?, "which unites all others")
    } else {
        (*uses.keys().next()?, "the only one")
    };
    let (place, _) = uses.values().next()?;
    let text = format!("the deck has no case control: {kind} set {set}, {which}, is used");
    model.warn(place.file, place.line, text);
    Some(SetChoice { set, file: place.file, line: place.line })
}

/// Refuses selected unions that solvers reject. For MYSTRAN, also refuses unions that are not selected but name a set twice.
fn refuse_unions(selections: &[(String, CaseSelection)], bulk: &BulkData, model: &mut Model) {
    let selected = |field: fn(&CaseSelection) -> Option<SetChoice>| {
        selections.iter().filter_map(|(_, selection)| field(selection)).map(|choice| choice.set).collect()
    };
    refuse_unions_in(&bulk.mpc_unions, &selected(|selection| selection.mpc), bulk.is_mystran, model);
    refuse_unions_in(&bulk.spc_unions, &selected(|selection| selection.spc), bulk.is_mystran, model);
}

fn refuse_unions_in(unions: &SetUnions, selected: &BTreeSet<u32>, is_mystran: bool, model: &mut Model) {
    for (set, cards) in unions {
        let is_selected = selected.contains(set);
        for (sets, place) in cards {
            let mut seen = BTreeSet::new();
            let twice = sets.iter().find(|set| !seen.insert(**set)).filter(|_| is_selected || is_mystran);
            let inner = sets.iter().find(|set| unions.contains_key(set)).filter(|_| is_selected);
            if let Some(twice) = twice {
                let text = format!("{} names set {twice} twice, which the solver refuses: name it once", place.name);
                model.refuse(place.file, place.line, text);
            }
            if let Some(inner) = inner {
                let text = format!("{} names the union {inner}, which the solver refuses: name its sets", place.name);
                model.refuse(place.file, place.line, text);
            }
        }
    }
}

/// A kind of set, and the function that gives access to the choice of this kind.
type SelectionField = (&'static str, fn(&mut CaseSelection) -> &mut Option<SetChoice>);

const KINDS: [SelectionField; 2] = [("MPC", |selection| &mut selection.mpc), ("SPC", |selection| &mut selection.spc)];

/// Lets subcases inherit selections as in MYSTRAN, and reports where MYSTRAN stops.
fn inherit(selections: &mut [(String, CaseSelection)], bulk: &BulkData, model: &mut Model) {
    for (kind, field) in KINDS {
        let mut before = None;
        for (at, (_, selection)) in selections.iter_mut().enumerate() {
            let choice = field(selection);
            *choice = choice.or(before);
            if let Some(own) = *choice
                && at > 0
                && before.map(|before: SetChoice| before.set) != Some(own.set)
            {
                refuse_second_set(kind, own, before, model);
            }
            before = *choice;
        }
    }
    if selections.iter().all(|(_, selection)| selection.mpc.is_none()) {
        // MYSTRAN uses set 0 if no other is selected.
        let first = bulk.ties.mpcs().find(|card| card.set == 0);
        let zero = first.map(|card| SetChoice { set: 0, file: card.file, line: card.line });
        selections.iter_mut().for_each(|(_, selection)| selection.mpc = zero);
    }
}

fn refuse_second_set(kind: &str, own: SetChoice, before: Option<SetChoice>, model: &mut Model) {
    let other = before.map_or_else(|| format!("no {kind} set"), |before| format!("{kind} = {}", before.set));
    let text = format!(
        "{kind} = {}: MYSTRAN allows one {kind} set per run, and stops because the previous subcase has {other}",
        own.set
    );
    model.refuse(own.file, own.line, text);
}

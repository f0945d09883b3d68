//! `MPCADD` and `SPCADD` cards that solvers refuse: those that name a set twice, or another union.

use std::collections::BTreeSet;

use super::subcases::{Choice, Selection};
use crate::deck::Model;
use crate::deck::nastran::cards::bulk::Bulk;
use crate::deck::nastran::cards::sets::Unions;

/// Says what is refused of unions that are selected; to MYSTRAN a set named twice is one in any.
pub fn refuse(selections: &[(String, Selection)], bulk: &Bulk, model: &mut Model) {
    let selected = |of: fn(&Selection) -> Option<Choice>| {
        selections.iter().filter_map(|(_, selection)| of(selection)).map(|choice| choice.set).collect()
    };
    refuse_in(&bulk.mpc_unions, &selected(|selection| selection.mpc), bulk.is_mystran, model);
    refuse_in(&bulk.spc_unions, &selected(|selection| selection.spc), bulk.is_mystran, model);
}

fn refuse_in(unions: &Unions, selected: &BTreeSet<u32>, is_mystran: bool, model: &mut Model) {
    for (set, cards) in unions {
        let is_selected = selected.contains(set);
        for (of, place) in cards {
            let mut seen = BTreeSet::new();
            let twice = of.iter().find(|set| !seen.insert(**set)).filter(|_| is_selected || is_mystran);
            let inner = of.iter().find(|set| unions.contains_key(set)).filter(|_| is_selected);
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

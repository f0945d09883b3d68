//! Equations that steps take back, by their slaves. CalculiX takes one `*EQUATION, REMOVE` a step, with any number of lines.

use rustc_hash::FxHashSet;

use super::rotations::Rotations;
use crate::deck::clean::{Cases, Plan};
use crate::deck::{Deck, Dof};

/// For each step the card that takes back what ends before it; none where the deck's own cards stay right.
pub fn ends(deck: &Deck, plan: &Plan, rotations: &Rotations) -> Option<Vec<String>> {
    let cases = &deck.model.cases;
    let ends_sooner = !plan.ended.is_empty() || plan.written.iter().any(|written| written.cases != Cases::All);
    if !ends_sooner && cases.iter().all(|case| case.removed.is_empty()) {
        return None;
    }
    let mut slaves: Vec<Vec<Dof>> = vec![Vec::new(); cases.len()];
    for written in &plan.written {
        (1..cases.len()).filter(|&k| written.cases == Cases::UpTo(k - 1)).for_each(|k| slaves[k].push(written.slave));
    }
    let slave = |i: usize| deck.model.nth(i).columns.first().map(|&j| deck.model.dofs[j as usize]);
    plan.ended.iter().for_each(|ended| slaves[ended.last + 1].extend(slave(ended.equation)));
    let mut done: FxHashSet<usize> = plan.removed.iter().map(|removed| removed.equation).collect();
    done.extend(plan.ended.iter().map(|ended| ended.equation));
    for (k, case) in cases.iter().enumerate() {
        let own = case.removed.iter().map(|&i| i as usize);
        own.filter(|&i| done.insert(i)).for_each(|i| slaves[k].extend(slave(i)));
    }
    let card = |slaves: Vec<Dof>| card(slaves.into_iter().map(|dof| rotations.name(dof)));
    Some(slaves.into_iter().map(card).collect())
}

fn card(slaves: impl Iterator<Item = Dof>) -> String {
    let line = |Dof { node, component }: Dof| format!("{node},{component},{component}\n");
    let lines = slaves.fold(String::new(), |lines, dof| lines + &line(dof));
    if lines.is_empty() { lines } else { "*EQUATION, REMOVE\n".to_owned() + &lines }
}

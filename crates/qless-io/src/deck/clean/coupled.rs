//! Coupled sets of ANSYS, `u_j - u_1 = 0`: no DOF of them may be in two sets or prescribed, the first no more than the others, which
//! are slaves.

use rustc_hash::FxHashMap;

use super::fault::Fault;
use crate::deck::{Model, Origin};

/// Where a DOF is in a set.
#[derive(Clone, Copy)]
struct Member {
    equation: usize,
    card: u32,
    is_first: bool,
}

/// What is wrong with first DOFs; that of the others is said of slaves.
pub fn faults(model: &Model, prescribed: &FxHashMap<u32, Origin>, left_out: &[bool]) -> Vec<Fault> {
    let mut known: FxHashMap<u32, Member> = FxHashMap::default();
    let mut faults = Vec::new();
    for (equation, card) in equations(model, left_out) {
        let [slave, first] = model.nth(equation).columns[..] else { continue };
        for (column, is_first) in [(slave, false), (first, true)] {
            let dof = model.dofs[column as usize];
            let member = Member { equation, card, is_first };
            let before = *known.entry(column).or_insert(member);
            let is_new = before.equation == equation || before.card != card;
            if is_first && is_new {
                faults.extend(prescribed.get(&column).map(|&by| Fault::CoupledPrescribed { equation, slave: dof, by }));
            }
            if before.card != card && (is_first || before.is_first) {
                faults.push(Fault::CoupledTwice { equation, slave: dof, first: before.equation });
                known.insert(column, member);
            }
        }
    }
    faults
}

/// The equations of coupled sets, with their cards.
fn equations<'a>(model: &'a Model, left_out: &'a [bool]) -> impl Iterator<Item = (usize, u32)> + 'a {
    let kept = (0..model.equations()).filter(|&i| !left_out[i]);
    kept.map(|i| (i, model.nth(i).origin.card)).filter(|&(_, card)| model.cards.nth(card).name.is_numbered("CP"))
}

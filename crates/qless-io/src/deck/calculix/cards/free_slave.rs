//! Gives equations the slaves that ccx chooses among the DOFs that are free: not slaves of earlier equations.
//!
//! ccx reads `*COUPLING` before all other cards and `*TIE` after them. Therefore the slaves are chosen after the whole deck is read.

use rustc_hash::{FxHashMap, FxHashSet};

use crate::deck::calculix::cards::mean_rotation::{self, MeanRotation};
use crate::deck::{Dof, Model};

/// An equation whose slave ccx chooses.
pub struct ChosenSlave {
    pub equation: usize,
    pub rule: SlaveRule,
}

/// How ccx chooses the slave of an equation.
pub enum SlaveRule {
    /// As for a mean rotation. If no DOF is free, ccx makes no equation.
    MeanRotation(MeanRotation),
    /// The first free one of these DOFs. If none is free, ccx stops.
    First(Vec<Dof>),
}

const NO_ROTATION: &str =
    "all DOFs that could be its slave are slaves or prescribed already, or have coefficients below 1e-5";
const NONE: &str = "all DOFs that could be the slave of its equation are slaves already; remove one of these equations";

/// Chooses the slaves of these equations, which are in the order of the deck.
pub fn choose(model: &mut Model, chosen: &[ChosenSlave]) {
    let name = |model: &Model, i: usize| model.cards.nth(model.nth(i).origin.card).name;
    let own = |model: &Model, i: usize| model.nth(i).columns.first().copied();
    let all = (0..model.equations()).filter(|_| !chosen.is_empty());
    let coupled = all.filter(|&i| name(model, i) == "*KINEMATIC");
    let mut taken: FxHashSet<u32> = coupled.filter_map(|i| own(model, i)).collect();
    let mut next = 0;
    for ChosenSlave { equation, rule } in chosen {
        let before = (next..*equation).filter(|&i| name(model, i) != "*TIE" && model.why_missing(i).is_none());
        taken.extend(before.filter_map(|i| own(model, i)));
        next = *equation;
        match slave(model, *equation, rule, &taken) {
            Some(at) => model.lead(*equation, at),
            None => mark_without(model, *equation, rule),
        }
    }
}

/// Index of the slave's term.
fn slave(model: &Model, equation: usize, rule: &SlaveRule, taken: &FxHashSet<u32>) -> Option<usize> {
    let dofs = match rule {
        SlaveRule::MeanRotation(rotation) => return mean_rotation::slave(model, equation, rotation, taken),
        SlaveRule::First(dofs) => dofs,
    };
    let terms: FxHashMap<Dof, (u32, usize)> =
        model.nth(equation).columns.iter().zip(0..).map(|(&j, at)| (model.dofs[j as usize], (j, at))).collect();
    let free = dofs.iter().filter_map(|dof| terms.get(dof)).find(|(column, _)| !taken.contains(column));
    free.map(|(_, at)| *at)
}

/// Records that ccx finds no slave for an equation.
fn mark_without(model: &mut Model, equation: usize, rule: &SlaveRule) {
    match rule {
        SlaveRule::MeanRotation(_) => model.mark_missing(equation, NO_ROTATION),
        SlaveRule::First(_) => {
            let origin = model.nth(equation).origin;
            let card = model.cards.nth(origin.card);
            model.mark_missing(equation, NONE);
            model.refuse(card.file, origin.line, format!("ccx stops: {}: {NONE}", card.name));
        }
    }
}

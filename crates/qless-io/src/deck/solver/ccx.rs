//! The reactions of CalculiX 2.20 (ccx). The test `tests/calculix/claims.rs` runs it on every pair of cards.
//!
//! ccx reads couplings before all other cards that constrain, and turns ties into equations after the first step. If a DOF is already a
//! slave, ccx stops at some cards, and skips the DOF at others. ccx compares slaves with prescribed DOFs in the first step, and in later
//! steps only if the equations may have changed.

use rustc_hash::FxHashMap;

use super::{CardKind, Outcome};
use crate::deck::{Dof, LoadCase, Model};

/// The position of cards of this kind in the order in which ccx treats cards. Their place in the deck does not matter.
fn order_of(kind: CardKind) -> u8 {
    match kind {
        CardKind::Kinematic => 0,
        CardKind::Tie => 2,
        _ => 1,
    }
}

/// What ccx does if two cards have the same slave. `first` comes before `second` in the deck.
pub fn twice(first: CardKind, second: CardKind) -> Outcome {
    let (late, dropped) = if order_of(second) < order_of(first) {
        (first, Outcome::IgnoresFirst)
    } else {
        (second, Outcome::IgnoresSecond)
    };
    match late {
        CardKind::Tie | CardKind::Kinematic | CardKind::RigidBody | CardKind::Mpc | CardKind::Sector => dropped,
        _ => Outcome::Refused,
    }
}

/// What ccx does if the slave of a card is prescribed. `is_later` means that this happens after the first step, and `is_compared` that ccx
/// compares slaves with prescribed DOFs again in that step.
pub fn prescribed(kind: CardKind, is_later: bool, is_compared: bool) -> Outcome {
    match (kind, is_later) {
        (CardKind::Tie, false) => Outcome::IgnoresFirst,
        (_, true) if !is_compared => Outcome::IgnoresSecond,
        _ => Outcome::Refused,
    }
}

/// Whether ccx compares slaves with prescribed DOFs again in a step that prescribes this slave. Only steps from `since` on count. ccx does
/// so in every step of a deck with `*TRANSFORM`, in steps in which `*EQUATION, REMOVE` removes equations, and in nonlinear steps with two
/// linked equations of which one is nonlinear.
pub fn compares_again(
    model: &Model,
    equation: usize,
    slave: Dof,
    since: usize,
    has_nonlinear_chain: impl FnOnce() -> bool,
) -> bool {
    let holds = |case: &LoadCase| {
        case.prescribed.binary_search_by_key(&slave, |given| given.dof).is_ok()
            && case.removed.binary_search(&(equation as u32)).is_err()
    };
    let mut steps = model.cases.windows(2).skip(since.saturating_sub(1));
    let removes = steps.any(|pair| pair[0].removed != pair[1].removed && holds(&pair[1]));
    removes || model.traits.has_local_axes || has_nonlinear_chain()
}

/// Whether two equations in force are linked: the slave of one is a master of the other, and one of the two is nonlinear.
pub fn nonlinear_chain(model: &Model, left_out: &[bool]) -> bool {
    if !model.traits.is_nonlinear {
        return false;
    }
    // A coupling with its own axes becomes several equations with new nodes, which are slaves in one equation and masters in others. So
    // these equations are linked, but the check below cannot see them.
    if model.traits.has_oriented_couplings {
        return true;
    }
    let kind = |i: usize| CardKind::from_name(&model.cards.nth(model.nth(i).origin.card).name);
    let is_nonlinear = |i: usize| matches!(kind(i), CardKind::Kinematic | CardKind::RigidBody | CardKind::Mpc);
    let mut kept = (0..model.equations()).filter(|&i| !left_out[i]);
    let slaves: FxHashMap<Dof, usize> = kept.clone().filter_map(|i| Some((slave(model, i)?, i))).collect();
    kept.any(|i| {
        let masters = named(model, i, kind(i) == CardKind::Mpc).into_iter().filter(|dof| Some(*dof) != slave(model, i));
        masters.filter_map(|dof| slaves.get(&dof)).any(|&j| is_nonlinear(i) || is_nonlinear(j))
    })
}

fn slave(model: &Model, equation: usize) -> Option<Dof> {
    model.nth(equation).columns.first().map(|&j| model.dofs[j as usize])
}

/// The DOFs that an equation names. `*MPC` names all directions of its nodes, even those with zero coefficients. If it has two equations
/// for a node (STRAIGHT), each of them leaves out the slave of the other one.
fn named(model: &Model, equation: usize, is_mpc: bool) -> Vec<Dof> {
    let dofs = model.nth(equation).columns.iter().map(|&j| model.dofs[j as usize]);
    if !is_mpc {
        return dofs.collect();
    }
    let beside = [equation.wrapping_sub(1), equation + 1].into_iter().filter(|&i| {
        let origin = |i: usize| model.equation(i).map(|equation| equation.origin);
        origin(i) == origin(equation)
    });
    let node = slave(model, equation).map(|dof| dof.node);
    let other = beside.filter_map(|i| slave(model, i)).find(|dof| Some(dof.node) == node).map(|dof| dof.component);
    let directions = (1..=3).filter(move |component| Some(*component) != other);
    dofs.flat_map(|dof| directions.clone().map(move |component| Dof { component, ..dof })).collect()
}

/// Slaves that `*KINEMATIC` adds, each with the first equation of its card. They are the rotations of the reference node. ccx makes them
/// follow the rotations of a node that it adds, and these can be prescribed.
pub fn rotations(model: &Model) -> Vec<(Dof, usize)> {
    let mut rotations = Vec::new();
    let mut last = None;
    for i in 0..model.equations() {
        let equation = model.nth(i);
        if last == Some(equation.origin.card) {
            continue;
        }
        last = Some(equation.origin.card);
        if CardKind::from_name(&model.cards.nth(equation.origin.card).name) == CardKind::Kinematic {
            let nodes = || equation.columns.iter().map(|&j| model.dofs[j as usize].node);
            let reference = nodes().find(|node| Some(*node) != nodes().next());
            rotations
                .extend(reference.iter().flat_map(|&node| (4..=6).map(move |component| (Dof { node, component }, i))));
        }
    }
    rotations
}

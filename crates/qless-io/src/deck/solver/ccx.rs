//! CalculiX, as version 2.20 does; `tests/calculix/claims.rs` runs it on every pair.
//!
//! Couplings are read before all other cards that constrain, ties become equations after the first step has been read. Some cards
//! stop where their slave is one already, others pass that DOF by. Where a slave is prescribed is looked at in the first step, and in a
//! later one only where the equations may have changed since.

use rustc_hash::FxHashMap;

use crate::deck::{Dof, LoadCase, Model, Outcome};

use super::kind::Kind;

/// When ccx looks at a card, whatever its place in the deck.
fn turn(kind: Kind) -> u8 {
    match kind {
        Kind::Kinematic => 0,
        Kind::Tie => 2,
        _ => 1,
    }
}

/// Two cards with the same slave, in the order of the deck.
pub fn twice(first: Kind, second: Kind) -> Outcome {
    let (late, dropped) =
        if turn(second) < turn(first) { (first, Outcome::IgnoresFirst) } else { (second, Outcome::IgnoresSecond) };
    match late {
        Kind::Tie | Kind::Kinematic | Kind::RigidBody | Kind::Mpc | Kind::Sector => dropped,
        _ => Outcome::Refused,
    }
}

/// A slave that is prescribed: from the first step on, or only later and then looked at again or not.
pub fn prescribed(kind: Kind, is_later: bool, is_looked_at: bool) -> Outcome {
    match (kind, is_later) {
        (Kind::Tie, false) => Outcome::IgnoresFirst,
        (_, true) if !is_looked_at => Outcome::IgnoresSecond,
        _ => Outcome::Refused,
    }
}

/// Whether ccx compares slaves with prescribed DOFs again in a step from `since` on that prescribes this slave: it does in every step
/// of a deck with `*TRANSFORM`, where `*EQUATION, REMOVE` takes equations away, and in nonlinear steps where equations of which one is
/// nonlinear hang together.
pub fn looks_again(
    model: &Model,
    equation: usize,
    slave: Dof,
    since: usize,
    hangs_together: impl FnOnce() -> bool,
) -> bool {
    let holds = |case: &LoadCase| {
        case.prescribed.binary_search_by_key(&slave, |given| given.dof).is_ok()
            && case.removed.binary_search(&(equation as u32)).is_err()
    };
    let mut steps = model.cases.windows(2).skip(since.saturating_sub(1));
    let removes = steps.any(|pair| pair[0].removed != pair[1].removed && holds(&pair[1]));
    removes || model.traits.has_local_axes || hangs_together()
}

/// Whether some equation in force has the slave of another as a master, and one of the two is nonlinear.
pub fn nonlinear_chain(model: &Model, left_out: &[bool]) -> bool {
    if !model.traits.is_nonlinear {
        return false;
    }
    // It makes them of equations to nodes of its own, which are slaves.
    if model.traits.has_turned_couplings {
        return true;
    }
    let kind = |i: usize| Kind::of(&model.cards.nth(model.nth(i).origin.card).name);
    let is_nonlinear = |i: usize| matches!(kind(i), Kind::Kinematic | Kind::RigidBody | Kind::Mpc);
    let mut kept = (0..model.equations()).filter(|&i| !left_out[i]);
    let slaves: FxHashMap<Dof, usize> = kept.clone().filter_map(|i| Some((slave(model, i)?, i))).collect();
    kept.any(|i| {
        let masters = named(model, i, kind(i) == Kind::Mpc).into_iter().filter(|dof| Some(*dof) != slave(model, i));
        masters.filter_map(|dof| slaves.get(&dof)).any(|&j| is_nonlinear(i) || is_nonlinear(j))
    })
}

fn slave(model: &Model, equation: usize) -> Option<Dof> {
    model.nth(equation).columns.first().map(|&j| model.dofs[j as usize])
}

/// The DOFs of an equation. `*MPC` names all directions of its nodes, even with coefficients of zero; where it has two equations for a
/// node (STRAIGHT), each leaves out the slave's direction of the other.
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

/// DOFs that `*KINEMATIC` makes slaves besides those of its nodes, each with the first equation of its card: the rotations of its
/// reference node, which follow those of a node that ccx adds. They can be prescribed.
pub fn rotations(model: &Model) -> Vec<(Dof, usize)> {
    let mut rotations = Vec::new();
    let mut last = None;
    for i in 0..model.equations() {
        let equation = model.nth(i);
        if last == Some(equation.origin.card) {
            continue;
        }
        last = Some(equation.origin.card);
        if Kind::of(&model.cards.nth(equation.origin.card).name) == Kind::Kinematic {
            let nodes = || equation.columns.iter().map(|&j| model.dofs[j as usize].node);
            let reference = nodes().find(|node| Some(*node) != nodes().next());
            rotations
                .extend(reference.iter().flat_map(|&node| (4..=6).map(move |component| (Dof { node, component }, i))));
        }
    }
    rotations
}

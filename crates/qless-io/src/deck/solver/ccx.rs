//! CalculiX 2.20; `tests/calculix/claims.rs` runs it on every pair of cards.
//!
//! ccx reads couplings before all other cards that constrain, and turns ties into equations after the first step. If a
//! slave is a slave already, some cards stop and others skip that DOF. ccx compares slaves with prescribed DOFs in the
//! first step, and in later steps only if the equations may have changed.

use rustc_hash::FxHashMap;

use super::{CardKind, Outcome};
use crate::deck::{Dof, LoadCase, Model};

/// Order in which ccx treats cards, regardless of their place in the deck.
fn order_of(kind: CardKind) -> u8 {
    match kind {
        CardKind::Kinematic => 0,
        CardKind::Tie => 2,
        _ => 1,
    }
}

/// Two cards with the same slave, in the order of the deck.
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

/// A slave that is prescribed in the first step, or only in a later step, in which ccx may compare slaves again.
pub fn prescribed(kind: CardKind, is_later: bool, is_compared: bool) -> Outcome {
    match (kind, is_later) {
        (CardKind::Tie, false) => Outcome::IgnoresFirst,
        (_, true) if !is_compared => Outcome::IgnoresSecond,
        _ => Outcome::Refused,
    }
}

/// Whether ccx compares slaves with prescribed DOFs again in a step from `since` on that prescribes this slave. It
/// does so in every step of a deck with `*TRANSFORM`, where `*EQUATION, REMOVE` removes equations, and in nonlinear
/// steps with linked equations of which one is nonlinear.
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

/// Whether a master of some equation in force is the slave of another one, and one of the two is nonlinear.
pub fn nonlinear_chain(model: &Model, left_out: &[bool]) -> bool {
    if !model.traits.is_nonlinear {
        return false;
    }
    // Couplings with their own axes become equations to new nodes, which are slaves.
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

/// DOFs of an equation. `*MPC` names all directions of its nodes, even with zero coefficients. If it has two equations
/// for a node (STRAIGHT), each leaves out the other's slave.
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

/// Additional slaves of `*KINEMATIC`, with the first equation of each card: the rotations of its reference node follow
/// those of a node that ccx adds. They can be prescribed.
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

/// Coefficients below this count as zero in ccx.
const ZERO: f64 = 1e-10;
/// Most insertions; beyond that, the result is unknown.
const MOST_INSERTIONS: usize = 200_000;

/// Terms of an equation, slave first.
type TermList = Vec<(u32, f64)>;

/// Inserts equations into each other as ccx does: for each master that is the slave of another equation, until there
/// is none. ccx stops if the slave of an equation cancels. Returns whether all equations keep their slaves; `None` if
/// that takes too many insertions.
pub fn keeps_slaves(model: &Model, equations: &[usize]) -> Option<bool> {
    let row = |&i: &usize| {
        let equation = model.nth(i);
        collected(equation.columns.iter().copied().zip(equation.coefficients.iter().copied()))
    };
    let mut rows: Vec<TermList> = equations.iter().map(row).filter(|row| !row.is_empty()).collect();
    let slaves: FxHashMap<u32, usize> = rows.iter().map(|row| row[0].0).zip(0..).collect();
    for _ in 0..MOST_INSERTIONS / rows.len().max(1) {
        let mut is_done = true;
        for i in 0..rows.len() {
            let master = |&(j, _): &(u32, f64)| slaves.get(&j).copied().filter(|&k| k != i);
            let Some((at, k)) = rows[i].iter().enumerate().skip(1).find_map(|(at, term)| Some((at, master(term)?)))
            else {
                continue;
            };
            rows[i] = inserted(&rows[i], at, &rows[k]);
            is_done = false;
            if rows[i][0].1.abs() < ZERO {
                return Some(false);
            }
        }
        if is_done {
            return Some(true);
        }
    }
    None
}

/// Adds up terms with the same DOF, in order of first occurrence. Keeps the first term, and others that are not zero.
fn collected(terms: impl Iterator<Item = (u32, f64)>) -> TermList {
    let mut row = TermList::new();
    let mut at: FxHashMap<u32, usize> = FxHashMap::default();
    for (j, a) in terms {
        let k = *at.entry(j).or_insert(row.len());
        if k == row.len() {
            row.push((j, a));
        } else {
            row[k].1 += a;
        }
    }
    let mut is_first = true;
    row.retain(|(_, a)| std::mem::take(&mut is_first) || a.abs() >= ZERO);
    row
}

/// A row in which the term at position `at` is replaced by its equation.
fn inserted(row: &TermList, at: usize, equation: &TermList) -> TermList {
    let factor = -row[at].1 / equation[0].1;
    let instead = equation[1..].iter().map(|&(j, a)| (j, factor * a));
    collected(row[..at].iter().copied().chain(instead).chain(row[at + 1..].iter().copied()))
}

//! `*MPC` of type MEANROT, and the slave that ccx chooses for it.
//!
//! ccx takes the first node of the card that has a DOF which is not taken, and of this node the DOF with the largest
//! coefficient. A DOF is taken if an equation before has it as slave, or if it is prescribed before. ccx reads
//! `*COUPLING` before all other cards, so that slaves are chosen after the whole deck is read.

use rustc_hash::FxHashSet;

use crate::deck::calculix::cards::CardEquation;
use crate::deck::calculix::model::DeckDefinitions;
use crate::deck::kinematics::vector::{Vector, cross, dot, minus, plus, scaled, unit};
use crate::deck::{Dof, Model, Problem};
use crate::fault::quote;

/// Name of the card.
pub const NAME: &str = "*MPC MEANROT";

/// Smallest coefficient of a slave, in the form of [`equation`] where that of the rotation is minus the number of nodes.
const SMALLEST: f64 = 1e-5;
const NONE_FREE: &str = "all DOFs that could be its slave are slaves or prescribed already, or have coefficients below 1e-5";

/// A mean rotation: its equation, and its DOFs that are prescribed before its card.
pub struct MeanRotation {
    pub equation: usize,
    pub prescribed: Vec<Dof>,
}

/// Makes the slaves of some mean rotations those that ccx chooses. It makes no equation if it finds no slave.
pub fn choose_slaves(model: &mut Model, rotations: &[MeanRotation]) {
    for rotation in rotations {
        match slave(model, rotation) {
            Some(at) => model.lead(rotation.equation, at),
            None => model.mark_missing(model.nth(rotation.equation).origin.card, NONE_FREE),
        }
    }
}

/// Position of the slave among the terms of the equation.
fn slave(model: &Model, rotation: &MeanRotation) -> Option<usize> {
    let own = model.nth(rotation.equation);
    let is_early = |i: usize| i < rotation.equation || model.cards.nth(model.nth(i).origin.card).name == "*KINEMATIC";
    let slaves = (0..model.equations()).filter(|&i| is_early(i) && model.why_missing(i).is_none());
    let taken: FxHashSet<u32> = slaves.filter_map(|i| model.nth(i).columns.first().copied()).collect();
    let (_, others) = own.columns.split_last()?;
    let node = |at: usize| model.dofs[own.columns[at] as usize].node;
    let nodes = (0..others.len()).map(node).collect::<FxHashSet<u32>>().len();
    let scale = nodes as f64 / own.coefficients.last()?;
    let size = |at: usize| (own.coefficients[at] * scale).abs();
    let is_free = |&at: &usize| {
        let column = own.columns[at];
        size(at) > SMALLEST && !taken.contains(&column) && !rotation.prescribed.contains(&model.dofs[column as usize])
    };
    let free: Vec<usize> = (0..others.len()).filter(is_free).collect();
    let first = node(*free.first()?);
    // The first component of equal ones.
    let component = |at: usize| model.dofs[own.columns[at] as usize].component;
    let of_first = free.into_iter().filter(|&at| node(at) == first);
    of_first.max_by(|&a, &b| size(a).total_cmp(&size(b)).then(component(b).cmp(&component(a))))
}

/// `sum_k (e x p_k) / abs(p_k)^2 . (u_k - mean u) = n u_p`: p_k is the arm of node k from the mean position,
/// perpendicular to the axis e. Nodes on the axis only enter the mean. The card lists each node three times.
pub fn equation(definitions: &DeckDefinitions, nodes: &[u32]) -> Result<CardEquation, Problem> {
    let Some((&pilot, nodes)) = nodes.split_last().filter(|(_, nodes)| !nodes.is_empty() && nodes.len() % 3 == 0)
    else {
        let found = quote(nodes.len().to_string().as_bytes());
        return Err(Problem::Expected { expected: "nodes three times each, and then one more", found });
    };
    let nodes: Vec<u32> = nodes.iter().step_by(3).copied().collect();
    let axis = unit(definitions.position(pilot)?);
    let axis = axis.ok_or_else(|| Problem::Degenerate { what: format!("node {pilot} gives no axis of rotation") })?;
    let places: Vec<Vector> = nodes.iter().map(|&node| definitions.position(node)).collect::<Result<_, _>>()?;
    let part = 1.0 / nodes.len() as f64;
    let centre = places.iter().fold([0.0; 3], |sum, x| plus(sum, scaled(*x, part)));
    let arms: Vec<Vector> = places.iter().map(|x| minus(*x, centre)).collect();
    let spread = arms.iter().map(|arm| dot(*arm, *arm)).sum::<f64>() * part;
    let rotation = |arm: &Vector| {
        let across = minus(*arm, scaled(axis, dot(*arm, axis)));
        let square = dot(across, across);
        if square > 1e-10 * spread { scaled(cross(axis, across), 1.0 / square) } else { [0.0; 3] }
    };
    let rotations: Vec<Vector> = arms.iter().map(rotation).collect();
    let mean = scaled(rotations.iter().fold([0.0; 3], |sum, rotation| plus(sum, *rotation)), part);
    let mut gradients: Vec<(u32, Vector)> =
        nodes.iter().copied().zip(rotations.iter().map(|rotation| minus(*rotation, mean))).collect();
    gradients.retain(|(_, gradient)| gradient.iter().any(|g| g.abs() > 1e-12 * spread.sqrt().recip()));
    let rotation = (Dof { node: pilot, component: 1 }, -(nodes.len() as f64));
    CardEquation::along_with(definitions, &gradients, &[rotation], 0.0)
}

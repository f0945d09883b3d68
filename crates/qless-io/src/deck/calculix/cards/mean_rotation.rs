//! Reads `*MPC` of type MEANROT, and chooses the slave that ccx chooses for it.
//!
//! ccx searches the nodes in the order of the card, usually up to the first node with a free DOF. The slave is the free DOF with the
//! largest coefficient. Here a DOF is free unless it is the slave of an earlier equation or is prescribed earlier.

use rustc_hash::{FxHashMap, FxHashSet};

use crate::deck::calculix::cards::{CardEquation, terms};
use crate::deck::calculix::model::DeckDefinitions;
use crate::deck::kinematics::vector::{Vector, cross, dot, length, minus, plus, scaled};
use crate::deck::{Dof, Model, Problem};
use crate::fault::quote;

/// Name of these cards in the model.
pub const NAME: &str = "*MPC MEANROT";

/// The coefficient of a slave must exceed this. The coefficients are those of [`equation`].
const SMALLEST: f64 = 1e-5;
/// For at most this many nodes, coefficients are summed in the order of ccx.
const ADDED: usize = 2000;

/// What ccx knows of a `MEANROT` when it searches for its slave.
pub struct MeanRotation {
    /// The DOFs that are prescribed before its card.
    pub prescribed: FxHashSet<Dof>,
    /// The nodes that the card lists, each once and in its order.
    pub nodes: Vec<u32>,
}

/// Index of the slave's term. The slave has the largest coefficient of all free DOFs, up to the first node with a free DOF. If component 3
/// of that node is not free and has a larger coefficient, ccx goes on to the next node.
pub fn slave(model: &Model, equation: usize, rotation: &MeanRotation, taken: &FxHashSet<u32>) -> Option<usize> {
    let own = model.nth(equation);
    let terms: FxHashMap<Dof, usize> = own.columns.iter().map(|&j| model.dofs[j as usize]).zip(0..).collect();
    let is_taken = |at: usize, dof: &Dof| taken.contains(&own.columns[at]) || rotation.prescribed.contains(dof);
    let (mut found, mut largest) = (None, SMALLEST);
    for &node in &rotation.nodes {
        for component in 1..=3 {
            let dof = Dof { node, component };
            let at = terms.get(&dof).copied();
            let larger = at.filter(|&at| own.coefficients[at].abs() > largest);
            match larger {
                Some(at) if is_taken(at, &dof) => continue,
                Some(at) => (found, largest) = (larger, own.coefficients[at].abs()),
                None => {}
            }
            if component == 3 && found.is_some() {
                return found;
            }
        }
    }
    found
}

/// Splits the list of a card into the rotating nodes and its last node, which gives the axis. The list holds each rotating node three
/// times.
pub fn nodes(list: &[u32]) -> Result<(Vec<u32>, u32), Problem> {
    match list.split_last() {
        Some((&pilot, nodes)) if !nodes.is_empty() && nodes.len() % 3 == 0 => {
            Ok((nodes.iter().step_by(3).copied().collect(), pilot))
        }
        _ => {
            let found = quote(list.len().to_string().as_bytes());
            Err(Problem::Expected { expected: "nodes three times each, and then one more", found })
        }
    }
}

/// `sum_k (e x p_k) / abs(p_k)^2 . (u_k - mean u) = n u_p` for n nodes: u_k is the displacement of node k. p_k is its arm from the mean
/// position, perpendicular to the axis e. u_p is component 1 of the last node. Nodes on the axis have no term of their own in the sum, but
/// enter the mean. The card lists each of the n nodes three times.
pub fn equation(definitions: &DeckDefinitions, nodes: &[u32]) -> Result<CardEquation, Problem> {
    let (nodes, pilot) = self::nodes(nodes)?;
    let axis = definitions.position(pilot)?;
    let along = length(axis);
    if along <= 0.0 {
        return Err(Problem::Degenerate { what: format!("node {pilot} gives no axis of rotation") });
    }
    let axis = axis.map(|x| x / along);
    let places: Vec<Vector> = nodes.iter().map(|&node| definitions.position(node)).collect::<Result<_, _>>()?;
    let count = nodes.len() as f64;
    let centre = places.iter().fold([0.0; 3], |sum, x| plus(sum, *x)).map(|sum| sum / count);
    let arms: Vec<Vector> = places.iter().map(|x| minus(*x, centre)).collect();
    let spread = arms.iter().map(|arm| dot(*arm, *arm)).sum::<f64>() / count;
    let rotation = |arm: &Vector| {
        let across = minus(*arm, scaled(axis, dot(*arm, axis)));
        let square = dot(across, across);
        if square > 1e-10 * spread { cross(axis, across).map(|c| c / square) } else { [0.0; 3] }
    };
    let rotations: Vec<Vector> = arms.iter().map(rotation).collect();
    let mut terms = terms(definitions, &gradients(&nodes, &rotations))?;
    if terms.is_empty() {
        return Err(Problem::Degenerate { what: "all nodes of a mean rotation lie on its axis".into() });
    }
    terms.push((Dof { node: pilot, component: 1 }, -count));
    Ok(CardEquation { terms, rhs: 0.0 })
}

/// `r_k - mean r` for each node, with r_k from `rotations`. For up to [`ADDED`] nodes, the sums are formed in the order of ccx, which takes
/// quadratic time: rounding errors decide which of equal coefficients is the largest, and so the slave.
fn gradients(nodes: &[u32], rotations: &[Vector]) -> Vec<(u32, Vector)> {
    let part = 1.0 / nodes.len() as f64;
    let mean = scaled(rotations.iter().fold([0.0; 3], |sum, rotation| plus(sum, *rotation)), part);
    let added = |k: usize| {
        let share = |i: usize| scaled(rotations[i], if i == k { 1.0 - part } else { -part });
        (0..nodes.len()).fold([0.0; 3], |sum, i| plus(sum, share(i)))
    };
    let gradient = |k: usize| if nodes.len() <= ADDED { added(k) } else { minus(rotations[k], mean) };
    nodes.iter().enumerate().map(|(k, &node)| (node, gradient(k))).collect()
}

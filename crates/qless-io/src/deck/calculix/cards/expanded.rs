//! Constraints at nodes of beams, trusses, shells, membranes and plane elements, which ccx expands into solids.
//!
//! The node of the deck stays, and the mean of the new nodes follows it. So equations and values of its translations hold as the deck gives
//! them. ccx replaces other constraints, mostly by equations between new nodes, which may contradict each other. This reader reports the
//! replaced constraints as left out, so the model is incomplete:
//!
//! | constraint | ccx 2.20 |
//! | --- | --- |
//! | a rotation, but for the prescribed ones of [`HeldRotations`] | replaces it by mean rotations or by a rigid body, or ignores it, or stops |
//! | `*MPC` | stops, or uses the nodes of the deck |
//! | component 3 at a plane element | is zero, whatever the equation says |
//! | `*TIE` with faces of shells | ties the new nodes: see `tie` |

use std::collections::{BTreeMap, BTreeSet};

use rustc_hash::{FxHashMap, FxHashSet};

use crate::deck::calculix::cards::mean_rotation;
use crate::deck::calculix::model::DeckDefinitions;
use crate::deck::calculix::model::elements::ElementShape;
use crate::deck::calculix::model::steps::StepTraits;
use crate::deck::kinematics::vector::Vector;
use crate::deck::{Dof, LoadCase, Model, Origin, Prescribed};

const ROTATION: &str = "with equations of their own for rotations";
const PROJECTED: &str = "and holds only the part of the rotation in the plane of the shell";
const MPC: &str = "with rules of its own for *MPC";
const THIRD: &str = "of which component 3 stays zero";

/// For each kind of constraint that ccx changes: where it was found first, the DOF found there, and all DOFs found.
type Found = BTreeMap<&'static str, (Origin, Dof, BTreeSet<Dof>)>;

/// Reports the constraints that ccx changes when it expands elements into solids. They count as left out; each kind gives one warning.
pub fn leave_out(model: &mut Model, definitions: &DeckDefinitions) {
    if !definitions.blocks.iter().any(|block| ElementShape::from_type(&block.kind).is_expanded()) {
        return;
    }
    let mut found = Found::new();
    let held = HeldRotations::new(model, definitions);
    let mut note = |why, dof, origin| {
        found.entry(why).or_insert_with(|| (origin, dof, BTreeSet::new())).2.insert(dof);
    };
    for given in model.cases.iter().flat_map(|case| &case.prescribed) {
        match is_rotation(given.dof, definitions) {
            true if !held.has(given) => note(ROTATION, given.dof, given.origin),
            true if held.is_projected(given) => note(PROJECTED, given.dof, given.origin),
            _ => {}
        }
    }
    for equation in (0..model.equations()).map(|i| model.nth(i)) {
        for dof in equation.columns.iter().map(|&j| model.dofs[j as usize]) {
            why(dof, model, equation.origin.card, definitions)
                .into_iter()
                .for_each(|why| note(why, dof, equation.origin));
        }
    }
    for (why, (origin, dof, all)) in found {
        let card = model.cards.nth(origin.card);
        let (more, name) = (all.len() - 1, model.dof_name(dof));
        let more = if more > 0 { format!(" and {more} more") } else { String::new() };
        let text = format!("{} at {name}{more}: ccx expands the elements there into solids {why}", card.name);
        if why == PROJECTED {
            model.warn(card.file, origin.line, text);
        } else {
            model.leave_out(card.file, origin.line, text + ": left out");
        }
    }
}

/// Prescribed rotations that ccx holds without a clash, at nodes of shells alone or of beams alone:
///
/// - By mean rotations, it holds rotations of shells, projected to their plane, and rotations of beams that are all along one global axis.
///   The equations of other beams may clash, and a rotation that a later step releases leaves the stiffness singular.
/// - If the only step is dynamic, it makes the section at the node a rigid body. Then it holds all rotations of beams, and zeros of shells
///   if all three rotations are prescribed. With others, or with elements S8R, the stiffness may be singular.
struct HeldRotations<'a> {
    definitions: &'a DeckDefinitions,
    /// Rotations that are prescribed as zero in a step, and those that a later step releases.
    zeros: FxHashSet<Dof>,
    released: FxHashSet<Dof>,
    has_s8r: bool,
    /// The global axis of all beams and trusses at a node; `None` if they have not one axis.
    axes: FxHashMap<u32, Option<usize>>,
    /// Nodes whose components are along axes of their own.
    turned: FxHashSet<u32>,
}

impl<'a> HeldRotations<'a> {
    fn new(model: &'a Model, definitions: &'a DeckDefinitions) -> Self {
        let rotations = |case: &'a LoadCase| case.prescribed.iter().filter(|given| given.dof.component > 3);
        let zeros = model.cases.iter().flat_map(rotations).filter(|given| given.value == 0.0).map(|given| given.dof);
        let is_in = |case: &LoadCase, dof: &Dof| case.prescribed.binary_search_by_key(dof, |given| given.dof).is_ok();
        let steps = model.cases.windows(2);
        let released =
            steps.flat_map(|two| rotations(&two[0]).map(|given| given.dof).filter(|dof| !is_in(&two[1], dof)));
        let (zeros, released) = (zeros.collect(), released.collect());
        let has_s8r = definitions.blocks.iter().any(|block| block.kind.starts_with("S8R"));
        let mut axes: FxHashMap<u32, Option<usize>> = FxHashMap::default();
        for bar in definitions.elements().iter().flat_map(|elements| elements.bars()) {
            let axis = global_axis(bar, definitions);
            for &node in bar {
                let of_node = axes.entry(node).or_insert(axis);
                *of_node = of_node.filter(|_| *of_node == axis);
            }
        }
        Self { definitions, zeros, released, has_s8r, axes, turned: definitions.nodes_with_axes().collect() }
    }

    fn has(&self, given: &Prescribed) -> bool {
        let node = given.dof.node;
        let shapes = self.definitions.expanded_at(node);
        let are_shells = shapes.iter().all(|shape| shape.is_shell() && shape.rotates && !shape.is_flat);
        let are_beams = shapes.iter().all(|shape| !shape.is_shell() && shape.rotates && !shape.is_flat);
        let has_axis = || self.axes.get(&node).is_some_and(Option::is_some);
        let is_clamped = || (4..=6).all(|component| self.zeros.contains(&Dof { node, component }));
        !self.turned.contains(&node)
            && !self.released.contains(&given.dof)
            && match self.definitions.steps {
                StepTraits { is_dynamic: false, .. } => are_shells || are_beams && has_axis(),
                StepTraits { count: 1, .. } => !self.has_s8r && (are_beams || are_shells && is_clamped()),
                _ => false,
            }
    }

    /// Whether ccx holds only a part of this rotation: that in the plane of the shell.
    fn is_projected(&self, given: &Prescribed) -> bool {
        let node = given.dof.node;
        given.value != 0.0 && self.definitions.expanded_at(node).iter().any(ElementShape::is_shell)
    }
}

/// The global axis along which the nodes of a bar are.
fn global_axis(nodes: &[u32], definitions: &DeckDefinitions) -> Option<usize> {
    let places: Vec<Vector> = nodes.iter().map(|&node| definitions.position(node)).collect::<Result<_, _>>().ok()?;
    let varies = |&axis: &usize| places.iter().any(|place| place[axis] != places[0][axis]);
    let mut varying = (0..3).filter(varies);
    varying.next().filter(|_| varying.next().is_none())
}

fn is_rotation(dof: Dof, definitions: &DeckDefinitions) -> bool {
    (4..=6).contains(&dof.component) && !definitions.expanded_at(dof.node).is_empty()
}

/// Why ccx may change an equation of `card` because of the term on `dof`; `None` if it does not.
fn why(dof: Dof, model: &Model, card: u32, definitions: &DeckDefinitions) -> Option<&'static str> {
    let name = model.cards.nth(card).name;
    if is_rotation(dof, definitions) {
        Some(ROTATION)
    } else if !definitions.expanded_at(dof.node).is_empty() && (name == "*MPC" || name == mean_rotation::NAME) {
        Some(MPC)
    } else if dof.component == 3 && definitions.is_flat(dof.node) && name == "*EQUATION" {
        Some(THIRD)
    } else {
        None
    }
}

//! Makes the equations of `*RIGID BODY` and `*KINEMATIC`: `u_k = u_r + w x (x_k - x_r)` at the reference configuration. Node k at x_k
//! follows the reference node r at x_r with the rotation w.

use crate::deck::calculix::cards::{CardEquation, RegisteredCard};
use crate::deck::calculix::model::DeckDefinitions;
use crate::deck::calculix::syntax::{KeywordCard, number};
use crate::deck::kinematics::axes::{BASIC_AXES, Frame};
use crate::deck::kinematics::body::Poses;
use crate::deck::kinematics::body::product;
use crate::deck::kinematics::vector::{Vector, cross, minus};
use crate::deck::{DeckError, Dof, Model, Problem, Solver};

/// Reference of a body: the node whose motion the body follows, and the first of three components for its rotation.
#[derive(Clone, Copy)]
pub struct BodyReference {
    pub node: u32,
    pub rotation: Dof,
}

/// The component that stands for the rotation of a `*RIGID BODY` without `ROT NODE` in CalculiX. No card can name this rotation: components
/// 4 to 6 of the node are a different one.
const UNREACHED: u8 = 21;

impl BodyReference {
    /// A reference node whose components 4 to 6 are the rotation of the body.
    pub fn with_rotations(node: u32) -> Self {
        Self { node, rotation: Dof { node, component: 4 } }
    }

    /// The equation of the motion of a node k along a direction e: `e . u_k - e . u_r - (r x e) . w = 0`. In it, u_r is the displacement of
    /// the reference, r the arm from the reference to the node, and w the rotation.
    pub fn follows(
        &self,
        definitions: &DeckDefinitions,
        node: u32,
        direction: Vector,
    ) -> Result<CardEquation, Problem> {
        let reference = definitions.pose(self.node)?;
        let arm = minus(definitions.position(node)?, reference.position);
        let gradients = [(node, direction), (self.node, direction.map(|x| -x))];
        let moment = cross(arm, direction);
        let rotation = [0, 1, 2].map(|k| (self.rotation_dof(k), -product(&reference.axes[k], &moment)));
        CardEquation::along_with(definitions, &gradients, &rotation, 0.0)
    }

    /// The `ROT NODE`, whose components 1 to 3 are the rotation of the body; `None` if there is none.
    pub fn rotation_node(&self) -> Option<u32> {
        (self.rotation.component == 1).then_some(self.rotation.node)
    }

    /// Whether the rotation has DOFs that cards can name.
    pub fn names_rotation(&self) -> bool {
        self.rotation.component != UNREACHED
    }

    /// The three DOFs of the body's rotation.
    pub fn rotations(&self) -> [Dof; 3] {
        [0, 1, 2].map(|k| self.rotation_dof(k))
    }

    fn rotation_dof(&self, k: usize) -> Dof {
        Dof { component: self.rotation.component + k as u8, ..self.rotation }
    }

    /// The equation `e . w_k = e . w` of the rotations of a node k and of the body about a direction e, along the axes of each.
    pub fn rotates_with(
        &self,
        definitions: &DeckDefinitions,
        node: u32,
        direction: Vector,
    ) -> Result<CardEquation, Problem> {
        let own = definitions.axes(node)?.map(|axis| product(&axis, &direction));
        let body = definitions.axes(self.node)?.map(|axis| -product(&axis, &direction));
        let dofs = [4, 5, 6].map(|component| Dof { node, component });
        let slave = (0..3).rev().max_by(|&i, &j| own[i].abs().total_cmp(&own[j].abs())).unwrap_or(0);
        let terms = dofs.into_iter().zip(own).chain(self.rotations().into_iter().zip(body));
        let mut equation = CardEquation { terms: terms.collect(), rhs: 0.0 };
        equation.lead(slave);
        equation.terms.retain(|(_, a)| *a != 0.0);
        Ok(equation)
    }
}

/// Reads `*RIGID BODY`. Returns its reference if any node follows it.
pub fn read(
    card: &KeywordCard,
    model: &mut Model,
    definitions: &DeckDefinitions,
    solver: Solver,
) -> Result<Option<BodyReference>, DeckError> {
    let place = RegisteredCard::register(card, model, "*RIGID BODY");
    let mut body = RigidBodyCard { card, definitions, solver, warnings: Vec::new(), made: None, used: None };
    let rows = body.rows();
    let RigidBodyCard { warnings, made, used, .. } = body;
    warnings.into_iter().for_each(|text| model.warn(card.file, card.line, text));
    if let Some(node) = made {
        model.name_node(node, format!("reference of line {}", card.line));
    }
    let before = model.equations();
    place.push(model, rows)?;
    if model.equations() == before {
        return Ok(None);
    }
    // Equations in the deck cannot name a reference node that the solver makes: the deck has no number for it.
    if definitions.steps.is_nonlinear || made.is_some() {
        place.mark_irreplaceable(model);
    } else if let Some(reference) = used.filter(|_| card.parameter("ROTNODE").is_none()) {
        own_rotation(&place, reference, model, definitions);
    }
    let others = ["PINNSET", "TIENSET", "ELSET", "ANALYTICALSURFACE"];
    if card.parameter("NSET").is_some() && others.iter().all(|other| card.parameter(other).is_none()) {
        model.cards.mark_divisible(place.origin.card);
    }
    model.warn(card.file, card.line, "*RIGID BODY is linearised at the reference configuration");
    Ok(used)
}

/// A `*RIGID BODY` card that is being read.
struct RigidBodyCard<'a> {
    card: &'a KeywordCard,
    definitions: &'a DeckDefinitions,
    solver: Solver,
    warnings: Vec<String>,
    /// The number of the reference node if the solver makes it; `None` if the deck gives it.
    made: Option<u32>,
    /// The reference that the equations use; `None` if no node follows it.
    used: Option<BodyReference>,
}

impl RigidBodyCard<'_> {
    fn rows(&mut self) -> Result<Vec<CardEquation>, Problem> {
        let nodes = self.nodes()?;
        if nodes.is_empty() {
            return Ok(Vec::new());
        }
        let reference = self.motion()?;
        self.used = Some(reference);
        let is_own = |node: u32| node == reference.node || node == reference.rotation.node;
        let mut rows = Vec::new();
        for (node, rotates) in nodes.into_iter().filter(|(node, _)| !is_own(*node)) {
            let components = self.definitions.components(node, rotates);
            rows.extend(kinematic(self.definitions, reference, std::iter::once(node), &components, None)?);
        }
        Ok(rows)
    }

    /// The node that a parameter names, directly or as a set of one node.
    fn node(&mut self, parameter: &str) -> Result<Option<u32>, Problem> {
        let Some(text) = self.card.parameter(parameter) else { return Ok(None) };
        if self.solver == Solver::Ccx && number(text.as_bytes(), "a node").is_err() {
            self.warnings.push(format!("*RIGID BODY: ccx refuses the set {text} as a node; give the node's number"));
        }
        self.definitions.one_node(self.card.scope, text.as_bytes()).map(Some)
    }

    /// The reference node that the card names. If it names none, ccx makes a node at the origin.
    fn reference(&mut self) -> Result<u32, Problem> {
        match self.node("REFNODE")? {
            Some(node) => Ok(node),
            None if self.solver == Solver::Ccx => {
                let node = self.definitions.make_node([0.0; 3])?;
                self.made = Some(node);
                Ok(node)
            }
            None => Err(Problem::NoParameter { name: "REF NODE" }),
        }
    }

    /// The reference node and the DOFs of its rotation, which may belong to another node.
    fn motion(&mut self) -> Result<BodyReference, Problem> {
        let node = self.reference()?;
        if self.solver == Solver::Abaqus && self.card.word("POSITION").is_some_and(|position| position != "INPUT") {
            // Abaqus moves the reference there.
            return Err(Problem::NotFollowed { what: "the centre of mass of the body".into() });
        }
        let own = Dof { node, component: if self.solver == Solver::Ccx { UNREACHED } else { 4 } };
        let rotation = self.node("ROTNODE")?.map_or(own, |node| Dof { node, component: 1 });
        Ok(BodyReference { node, rotation })
    }

    /// The nodes of the body, each once and in the order of the card; true for those that rotate with the body.
    fn nodes(&mut self) -> Result<Vec<(u32, bool)>, Problem> {
        let mut all: Vec<(u32, bool)> = Vec::new();
        for (parameter, rotates) in self.sets() {
            let Some(set) = self.card.parameter(parameter) else { continue };
            let nodes = match parameter {
                "ELSET" => self.definitions.nodes_of(self.card.scope, set)?,
                _ => self.definitions.nodes(self.card.scope, set)?.to_vec(),
            };
            all.extend(nodes.into_iter().map(|node| (node, rotates)));
        }
        let mut seen = rustc_hash::FxHashSet::default();
        all.retain(|(node, _)| seen.insert(*node));
        if all.is_empty() && self.card.parameter("ANALYTICALSURFACE").is_none() && self.solver != Solver::Ccx {
            return Err(Problem::NoParameter { name: "ELSET" });
        }
        Ok(all)
    }

    /// The parameters that name sets; true for those whose nodes rotate with the body. A node in several sets belongs to the first of
    /// these. ccx ignores parameters that it does not know, and the whole card if it knows none of them.
    fn sets(&mut self) -> Vec<(&'static str, bool)> {
        if self.solver != Solver::Ccx {
            return vec![("PINNSET", false), ("TIENSET", true), ("NSET", false), ("ELSET", true)];
        }
        let known = [("NSET", false), ("PINNSET", false), ("ELSET", false)];
        let has_set = known.iter().any(|(parameter, _)| self.card.parameter(parameter).is_some());
        for (parameter, shown) in [("TIENSET", "TIE NSET"), ("ANALYTICALSURFACE", "ANALYTICAL SURFACE")] {
            if self.card.parameter(parameter).is_some() {
                let what = if has_set { "the parameter" } else { "the card, so that nothing is rigid" };
                self.warnings.push(format!("*RIGID BODY with {shown}: ccx does not know it and ignores {what}"));
            }
        }
        known.to_vec()
    }
}

/// Records a rotation that the solver makes, so that a new node of a cleaned deck can carry it. This is possible if the reference has
/// global axes and no rotations of its own, and if no step is nonlinear. Otherwise equations cannot replace the card.
pub fn own_rotation(
    place: &RegisteredCard,
    reference: BodyReference,
    model: &mut Model,
    definitions: &DeckDefinitions,
) {
    let node = reference.node;
    let is_plain = definitions.pose(node).is_ok_and(|pose| pose.axes == BASIC_AXES);
    if is_plain && !definitions.steps.is_nonlinear && !definitions.rotates(node) {
        model.own_rotations.insert(reference.rotation);
    } else {
        place.mark_irreplaceable(model);
    }
}

/// The equations of nodes that follow a reference in these components, along the axes `local`, or else along the axes of each node.
pub fn kinematic(
    definitions: &DeckDefinitions,
    reference: BodyReference,
    nodes: impl Iterator<Item = u32>,
    components: &[u8],
    local: Option<&Frame>,
) -> Result<Vec<CardEquation>, Problem> {
    let mut rows = Vec::new();
    // If all three translations or rotations are coupled, the choice of their axes does not matter, so the axes of each node are used.
    let is_whole = |first: u8| (first..first + 3).all(|component| components.contains(&component));
    let [along, about] = [1, 4].map(|first| local.filter(|_| !is_whole(first)));
    for node in nodes {
        let pose = definitions.pose(node)?;
        let [along, about] = [along, about].map(|local| local.map_or(pose.axes, |local| local.axes_at(pose.position)));
        let mut slaves = Vec::with_capacity(6);
        for &component in components {
            let row = match usize::from(component) - 1 {
                // Abaqus ignores the component; ccx stops.
                2 if definitions.is_abaqus && definitions.is_flat(node) => continue,
                k @ 0..3 => reference.follows(definitions, node, along[k])?,
                k if definitions.rotates_about(node, component) => {
                    reference.rotates_with(definitions, node, about[k - 3])?
                }
                _ => continue,
            };
            let row = row.led_by_none_of(&slaves);
            slaves.push(row.terms[0].0);
            rows.push(row);
        }
    }
    Ok(rows)
}

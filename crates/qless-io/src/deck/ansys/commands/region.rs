//! Reads the commands `CERIG` and `RBE3`: equations that ANSYS generates from the positions of nodes.
//!
//! ```text
//! CERIG, MASTE, SLAVE, Ldof, Ldof2, ... Ldof5       slave = master + rotation x arm, for each label
//! RBE3,  MASTER, DOF, Slaves, Wtfact                master = weighted mean of the slaves' translations
//! ```
//!
//! Plane models have only UX, UY and ROTZ. The components are along the axes of the nodes, and every small rigid motion of the region
//! satisfies the equations. ANSYS numbers the equations above the highest number so far.

use crate::deck::ansys::model::nodes::AnsysNodes;
use crate::deck::ansys::model::selection::NodeSelection;
use crate::deck::ansys::syntax::archive::DofCoefficient;
use crate::deck::ansys::syntax::command::AnsysCommand;
use crate::deck::ansys::syntax::field::{FieldFault, expected, whole};
use crate::deck::ansys::syntax::parameters::ApdlParameters;
use crate::deck::kinematics::body::CouplingEquation;
use crate::deck::kinematics::components::Components;
use crate::deck::kinematics::mean::{MeanElement, WeightedNodes};
use crate::deck::kinematics::rigid::RigidElement;
use crate::deck::{CardFault, Problem};

/// Limit on the equations of a `CERIG`. It bounds the memory.
const EQUATIONS: usize = 5_000_000;
/// Limit on the slaves of an `RBE3`: each of its equations contains all slaves.
const SLAVES: usize = 500_000;

/// Limit on the coefficients of an equation. Some of them are the arms between nodes. Beside a longer arm, the coefficient 1 of a
/// translation would be no more than a rounding error.
const ARM: f64 = 1e15;

/// The equations of a `CERIG` or `RBE3`, or the reason why there are none.
pub enum RegionOutcome {
    /// The master node, and the equations.
    Equations(u32, Vec<Vec<DofCoefficient>>),
    /// ANSYS ignores the command, and so does this reader; the text says why.
    Ignored(String),
    /// This reader cannot determine the equations; the text says why.
    LeftOut(String),
}

/// State of the reader that `CERIG` and `RBE3` need.
pub struct RegionContext<'a> {
    pub nodes: &'a AnsysNodes,
    pub selection: &'a NodeSelection,
    pub parameters: &'a ApdlParameters,
    pub is_plane: bool,
}

impl RegionContext<'_> {
    /// The equations of `CERIG`.
    pub fn rigid(&self, command: &AnsysCommand) -> Result<RegionOutcome, FieldFault> {
        let Some(set) = self.labels(command, &[3, 4, 5, 6, 7])? else { return Err(no_label(command, 3)) };
        let master = node(command)?;
        let slaves = match whole(command.field(2)) {
            Some(slave) => vec![slave],
            None => match self.members(command.field(2)) {
                Some(slaves) => slaves,
                None => return Ok(unknown_name(command, 2)),
            },
        };
        let dependent: Vec<u32> = slaves.into_iter().filter(|slave| *slave != master).collect();
        if dependent.is_empty() {
            return Ok(RegionOutcome::Ignored(
                "CERIG names no node but its master, so it makes no equations".to_owned(),
            ));
        }
        if dependent.len().saturating_mul(set.len()) > EQUATIONS {
            let advice = "split the region";
            return Err((None, Problem::Limit { what: "the number of equations", limit: EQUATIONS, advice }));
        }
        Ok(outcome(master, RigidElement::about(master, dependent, set).equations(self.nodes)))
    }

    /// The equations of `RBE3`, whose slaves and weights may be arrays.
    pub fn mean(&self, command: &AnsysCommand) -> Result<RegionOutcome, FieldFault> {
        let Some(components) = self.labels(command, &[2])? else { return Err(no_label(command, 2)) };
        let reference = node(command)?;
        let Some(slaves) = self.slaves(command.field(3)) else { return Ok(unknown_name(command, 3)) };
        let weights = match command.field(4) {
            b"" => None,
            text => match self.parameters.elements(text) {
                Some(weights) => Some(weights),
                None => return Ok(unknown_name(command, 4)),
            },
        };
        if slaves.len() > SLAVES {
            return Err((
                Some(3),
                Problem::Limit { what: "the number of slaves", limit: SLAVES, advice: "name fewer nodes" },
            ));
        }
        let translations = if self.is_plane { "12" } else { "123" };
        let translations = Components::parse(translations.as_bytes()).unwrap_or_default();
        let weight = |k: usize| weights.map_or(1.0, |weights| weights.get(k).copied().unwrap_or(0.0));
        let group =
            |(k, node): (usize, u32)| WeightedNodes { weight: weight(k), components: translations, nodes: vec![node] };
        let groups: Vec<WeightedNodes> =
            slaves.into_iter().enumerate().map(group).filter(|group| group.weight != 0.0).collect();
        if groups.iter().any(|group| !(group.weight > 0.0 && group.weight.is_finite())) {
            return Ok(RegionOutcome::LeftOut("RBE3 has negative or unknown weights: left out".to_owned()));
        }
        let mean = MeanElement { reference, components, groups, dependent: Vec::new() };
        let equations = mean.equations(self.nodes);
        if let Err(Problem::Card(CardFault::MeanUndetermined { .. })) = equations {
            let text = "RBE3 is ignored, as in the program: its slaves, if they are in line for example, do not determine the master";
            return Ok(RegionOutcome::Ignored(text.to_owned()));
        }
        Ok(outcome(reference, equations))
    }

    /// The slaves of `RBE3`: the elements of an array up to its first 0, or the nodes that a word names. `None` if they are unknown.
    fn slaves(&self, text: &[u8]) -> Option<Vec<u32>> {
        let Some(elements) = self.parameters.elements(text) else { return self.members(text) };
        let nodes = elements.iter().take_while(|value| **value != 0.0);
        nodes.map(|value| (1.0..4e9).contains(value).then(|| value.round() as u32)).collect()
    }

    fn members(&self, word: &[u8]) -> Option<Vec<u32>> {
        let members = self.selection.members(&String::from_utf8_lossy(word), self.nodes)?;
        Some(members.into_iter().collect())
    }

    /// The components of the labels in the fields `at`, or all if the first field is blank. `None` if the model has none of these
    /// components.
    fn labels(&self, command: &AnsysCommand, at: &[usize]) -> Result<Option<Components>, FieldFault> {
        let mut digits = String::new();
        for (k, &at) in at.iter().enumerate() {
            digits += match command.field(at).to_ascii_uppercase().as_slice() {
                b"" | b"ALL" if k == 0 => "123456",
                b"UXYZ" if k == 0 => "123",
                b"RXYZ" if k == 0 => "456",
                b"" => "",
                b"UX" => "1",
                b"UY" => "2",
                b"UZ" => "3",
                b"ROTX" => "4",
                b"ROTY" => "5",
                b"ROTZ" => "6",
                _ => return Err(no_label(command, at)),
            };
        }
        digits.retain(|digit| !self.is_plane || "126".contains(digit));
        Ok(Components::parse(digits.as_bytes()).filter(|set| !set.is_empty()))
    }
}

/// The master node, which field 1 names.
fn node(command: &AnsysCommand) -> Result<u32, FieldFault> {
    whole(command.field(1)).ok_or_else(|| expected(command, 1, "the number of a node"))
}

fn outcome(node: u32, equations: Result<Vec<CouplingEquation>, Problem>) -> RegionOutcome {
    let equations = match equations {
        Ok(equations) => equations,
        Err(problem) => {
            return RegionOutcome::LeftOut(format!(
                "the equations of the region about node {node} are not known: {problem}: left out"
            ));
        }
    };
    if !equations.iter().flat_map(|equation| &equation.terms).all(|(_, value)| value.abs() < ARM) {
        return RegionOutcome::LeftOut(format!(
            "nodes of the region about node {node} are too far apart for 64-bit numbers: left out"
        ));
    }
    RegionOutcome::Equations(node, equations.into_iter().map(|equation| equation.terms).collect())
}

fn no_label(command: &AnsysCommand, at: usize) -> FieldFault {
    expected(command, at, "ALL, UXYZ, RXYZ, or one of UX, UY, UZ, ROTX, ROTY, ROTZ that the model has")
}

fn unknown_name(command: &AnsysCommand, at: usize) -> RegionOutcome {
    let text = String::from_utf8_lossy(&command.field(at)[..command.field(at).len().min(32)]).into_owned();
    RegionOutcome::LeftOut(format!("{} names {text}, which this reader does not know: left out", command.title()))
}

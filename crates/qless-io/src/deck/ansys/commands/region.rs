//! `CERIG` and `RBE3`: equations that the program makes of where nodes are.
//!
//! ```text
//! CERIG, MASTE, SLAVE, Ldof, Ldof2, ... Ldof5       slave = master + rotation x arm, for each label
//! RBE3,  MASTER, DOF, Slaves, Wtfact                master = weighted mean of the slaves' translations
//! ```
//!
//! In plane models UX, UY and ROTZ are all that there is. Equations are along the axes of the nodes, and hold for every small motion
//! of the region as one body. The program numbers them from the highest on.

use crate::deck::ansys::model::nodes::AnsysNodes;
use crate::deck::ansys::model::selection::NodeSelection;
use crate::deck::ansys::syntax::archive::DofCoefficient;
use crate::deck::ansys::syntax::command::AnsysCommand;
use crate::deck::ansys::syntax::field::{FieldFault, expected, whole};
use crate::deck::ansys::syntax::parameters::ApdlParameters;
use crate::deck::kinematics::components::Components;
use crate::deck::kinematics::mean::{Group, Mean};
use crate::deck::kinematics::rigid::Rigid;
use crate::deck::kinematics::row::Row;
use crate::deck::{CardFault, Problem};

/// Equations of a region at most: bounds the memory.
const EQUATIONS: usize = 5_000_000;
/// Terms of an `RBE3` at most, each of which is in all of its equations.
const SLAVES: usize = 500_000;

/// Arms as long as this, of which the translation beside them is the rounding.
const ARM: f64 = 1e15;

/// The equations that a command makes, or why there are none.
pub enum RegionOutcome {
    /// Those of a region about this node.
    Rows(u32, Vec<Vec<DofCoefficient>>),
    /// None in the program either.
    Ignored(String),
    /// What it constrains is not known.
    LeftOut(String),
}

/// What such a command is read with.
pub struct RegionContext<'a> {
    pub nodes: &'a AnsysNodes,
    pub selection: &'a NodeSelection,
    pub parameters: &'a ApdlParameters,
    pub is_plane: bool,
}

impl RegionContext<'_> {
    /// `CERIG`.
    pub fn rigid(&self, command: &AnsysCommand) -> Result<RegionOutcome, FieldFault> {
        let Some(set) = self.labels(command, &[3, 4, 5, 6, 7])? else { return Err(no_label(command, 3)) };
        let master = node(command)?;
        let slaves = match whole(command.field(2)) {
            Some(slave) => vec![slave],
            None => match self.named(command.field(2)) {
                Some(slaves) => slaves,
                None => return Ok(not_followed(command, 2)),
            },
        };
        let dependent: Vec<_> = slaves.into_iter().filter(|slave| *slave != master).map(|slave| (slave, set)).collect();
        if dependent.is_empty() {
            return Ok(RegionOutcome::Ignored(
                "CERIG names no node but its master: no equations come of it".to_owned(),
            ));
        }
        if dependent.len().saturating_mul(set.len()) > EQUATIONS {
            let advice = "make several regions of it";
            return Err((None, Problem::Limit { what: "the number of equations", limit: EQUATIONS, advice }));
        }
        let rigid = Rigid { independent: vec![(master, Components::ALL)], dependent };
        Ok(made(master, rigid.rows(self.nodes)))
    }

    /// `RBE3`; slaves and weights are elements of arrays.
    pub fn mean(&self, command: &AnsysCommand) -> Result<RegionOutcome, FieldFault> {
        let Some(components) = self.labels(command, &[2])? else { return Err(no_label(command, 2)) };
        let reference = node(command)?;
        let Some(slaves) = self.slaves(command.field(3)) else { return Ok(not_followed(command, 3)) };
        let weights = match command.field(4) {
            b"" => None,
            text => match self.parameters.elements(text) {
                Some(weights) => Some(weights),
                None => return Ok(not_followed(command, 4)),
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
        let group = |(k, node): (usize, u32)| Group { weight: weight(k), components: translations, nodes: vec![node] };
        let groups: Vec<Group> =
            slaves.into_iter().enumerate().map(group).filter(|group| group.weight != 0.0).collect();
        if groups.iter().any(|group| !(group.weight > 0.0 && group.weight.is_finite())) {
            return Ok(RegionOutcome::LeftOut(
                "RBE3 has weights below zero, or that are not known: left out".to_owned(),
            ));
        }
        let mean = Mean { reference, components, groups, dependent: Vec::new() };
        let rows = mean.rows(self.nodes);
        if let Err(Problem::Card(CardFault::MeanUndetermined { .. })) = rows {
            let text = "RBE3 is ignored, as the program does: its slaves do not determine the motion of the master, as where they are in line";
            return Ok(RegionOutcome::Ignored(text.to_owned()));
        }
        Ok(made(reference, rows))
    }

    /// The nodes of an array, zeros left out where they end it, or those selected.
    fn slaves(&self, text: &[u8]) -> Option<Vec<u32>> {
        let Some(elements) = self.parameters.elements(text) else { return self.named(text) };
        let given = elements.iter().take_while(|value| **value != 0.0);
        given.map(|value| (1.0..4e9).contains(value).then(|| value.round() as u32)).collect()
    }

    fn named(&self, word: &[u8]) -> Option<Vec<u32>> {
        let members = self.selection.members(&String::from_utf8_lossy(word), self.nodes)?;
        Some(members.into_iter().collect())
    }

    /// The components of labels; `ALL` where the first is left out. None where there is no such label.
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

/// The node in field 1.
fn node(command: &AnsysCommand) -> Result<u32, FieldFault> {
    whole(command.field(1)).ok_or_else(|| expected(command, 1, "the number of a node"))
}

fn made(node: u32, rows: Result<Vec<Row>, Problem>) -> RegionOutcome {
    let rows = match rows {
        Ok(rows) => rows,
        Err(problem) => {
            return RegionOutcome::LeftOut(format!(
                "the equations of the region about node {node} are not known: {problem}: left out"
            ));
        }
    };
    let finite = |row: &Row| row.terms.iter().all(|(_, value)| value.abs() < ARM);
    if !rows.iter().all(finite) {
        return RegionOutcome::LeftOut(format!(
            "nodes of the region about node {node} are too far apart for numbers: left out"
        ));
    }
    RegionOutcome::Rows(node, rows.into_iter().map(|row| row.terms).collect())
}

fn no_label(command: &AnsysCommand, at: usize) -> FieldFault {
    expected(command, at, "ALL, UXYZ, RXYZ, or one of UX, UY, UZ, ROTX, ROTY, ROTZ that the model has")
}

fn not_followed(command: &AnsysCommand, at: usize) -> RegionOutcome {
    let text = String::from_utf8_lossy(&command.field(at)[..command.field(at).len().min(32)]).into_owned();
    RegionOutcome::LeftOut(format!("{} names {text}, which this reader does not follow: left out", command.title()))
}

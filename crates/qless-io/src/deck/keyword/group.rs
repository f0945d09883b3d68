//! What a group of lines of a card means: equations, prescribed DOFs and messages.

use super::line::{KeywordFault, KeywordLine};
use crate::deck::kinematics::body::CouplingEquation;
use crate::deck::kinematics::components::Components;
use crate::deck::{Dof, Problem};

/// Why a constraint cannot be made from its card and the definitions.
#[derive(Debug)]
pub enum Gap {
    /// The deck is wrong at this place.
    Fault(KeywordFault),
    /// The constraint needs a definition, or its card has an option, that this reader does not read. The text is a clause for a message.
    Unread(String),
    /// As [`Gap::Unread`]. In addition, the following lines of the card are not understood.
    UnreadFromHere(String),
}

impl From<KeywordFault> for Gap {
    fn from(fault: KeywordFault) -> Self {
        Self::Fault(fault)
    }
}

/// What a group of lines of a card means: equations, prescribed DOFs and messages.
#[derive(Default)]
pub struct GroupMeaning {
    pub rows: Vec<CouplingEquation>,
    /// Whether the equations hold for small rotations only.
    pub is_linearised: bool,
    pub held: Vec<HeldDof>,
    pub warning: Option<String>,
    /// Why a part of the constraint is left out. The text is a clause.
    pub left_out: Option<String>,
    /// The number of the constraint, which its label shows.
    pub number: Option<u32>,
}

/// A DOF with a prescribed value.
pub struct HeldDof {
    pub dof: Dof,
    pub value: f64,
    /// The name of the value's time history. `None` is the standard history; a value of zero always has it.
    pub history: Option<String>,
    pub line: u32,
}

impl GroupMeaning {
    /// The meaning of a group that gives the equations `rows`. The first field of `line` is the number of the constraint.
    pub fn of_rows(line: &KeywordLine, rows: Result<Vec<CouplingEquation>, Problem>) -> Result<Self, Gap> {
        let rows = rows.map_err(|problem| line.fault(problem))?;
        Ok(Self { rows, number: Some(line.id(0)?), ..Self::default() })
    }

    /// Like [`Self::of_rows`], for equations that hold for small rotations only.
    pub fn of_body(line: &KeywordLine, rows: Result<Vec<CouplingEquation>, Problem>) -> Result<Self, Gap> {
        Self::of_rows(line, rows).map(|made| Self { is_linearised: !made.rows.is_empty(), ..made })
    }

    /// Adds DOFs that `line` holds at zero.
    pub fn with_held(mut self, line: &KeywordLine, dofs: impl IntoIterator<Item = Dof>) -> Self {
        let held = |dof| HeldDof { dof, value: 0.0, history: None, line: line.number };
        self.held.extend(dofs.into_iter().map(held));
        self
    }
}

/// All DOFs with these components at these nodes.
pub fn dofs(nodes: Vec<u32>, set: Components) -> impl Iterator<Item = Dof> {
    nodes.into_iter().flat_map(move |node| set.iter().map(move |component| Dof { node, component }))
}

/// Whether the components mean the same along all axes: all three translations or none, and all three rotations or none.
pub fn is_without_axes(set: Components) -> bool {
    let translations = set.and(Components::TRANSLATIONS).len();
    [translations, set.len() - translations].iter().all(|count| matches!(count, 0 | 3))
}

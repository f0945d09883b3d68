//! Constraints of a model: DOFs, equations, load cases, warnings, and their origin in the deck.

/// A component of a node; reports show `node:component`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Dof {
    /// The node's number in the deck.
    pub node: u32,
    /// 1 to 3 are translations and 4 to 6 rotations; others depend on the format.
    pub component: u8,
}

impl std::fmt::Display for Dof {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}:{}", self.node, self.component)
    }
}

/// Origin in the deck: a card and its lines.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Origin {
    /// Index into [`Model::cards`](super::Model::cards).
    pub card: u32,
    /// First line, from 1.
    pub line: u32,
    /// Number of lines.
    pub lines: u32,
}

/// An equation `sum a_j u_j = rhs`. In formats that name a slave, it is the first term.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeckEquation<'a> {
    /// Columns: indices into [`Model::dofs`](super::Model::dofs).
    pub columns: &'a [u32],
    /// Coefficients, in the order of `columns`; zeros included.
    pub coefficients: &'a [f64],
    /// The right-hand side.
    pub rhs: f64,
    /// Origin of the equation.
    pub origin: Origin,
}

/// A DOF with a prescribed value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prescribed {
    /// The DOF.
    pub dof: Dof,
    /// Value at the end of the load case. At time `t` it is multiplied by the time history.
    pub value: f64,
    /// Time history: index into [`Model::histories`](super::Model::histories).
    pub history: u32,
    /// Origin of the value.
    pub origin: Origin,
}

/// A loaded DOF.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Load {
    /// The DOF.
    pub dof: Dof,
    /// Origin of the load.
    pub origin: Origin,
}

/// A step or a subcase.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LoadCase {
    /// `step 1`, `subcase 2`.
    pub name: String,
    /// Prescribed DOFs, ascending, each once.
    pub prescribed: Vec<Prescribed>,
    /// Other values for DOFs of `prescribed`; they contradict the values there.
    pub clashes: Vec<Prescribed>,
    /// Loads.
    pub loads: Vec<Load>,
    /// Equations that are not in force, ascending.
    pub removed: Vec<u32>,
}

impl LoadCase {
    /// Whether another load case constrains the same; loads are ignored.
    pub fn constrains_as(&self, other: &Self) -> bool {
        self.prescribed == other.prescribed && self.clashes == other.clashes && self.removed == other.removed
    }
}

/// A message for the user.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Warning {
    /// Index into [`Model::files`](super::Model::files).
    pub file: u32,
    /// The line, from 1; 0 if it concerns no line.
    pub line: u32,
    /// The message: one sentence.
    pub text: String,
    /// Whether a constraint was left out, so that the model is incomplete.
    pub leaves_out: bool,
}

/// Properties of a whole deck that change a solver's behaviour.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct DeckTraits {
    /// Whether some nodes have local axes.
    pub(crate) has_local_axes: bool,
    /// Whether a step is geometrically nonlinear.
    pub(crate) is_nonlinear: bool,
    /// Whether a kinematic coupling has its own axes.
    pub(crate) has_oriented_couplings: bool,
}

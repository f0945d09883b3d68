//! What a model is made of: DOFs, equations, load cases, warnings, and where each stands in the input.

/// One component of one node; `node:component` in reports.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Dof {
    /// The node's number in the deck.
    pub node: u32,
    /// 1 to 3 translations, 4 to 6 rotations, others as the format has them.
    pub component: u8,
}

impl std::fmt::Display for Dof {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}:{}", self.node, self.component)
    }
}

/// Where something is said: a card, and the lines of it, from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Origin {
    /// Index into [`Model::cards`](super::Model::cards).
    pub card: u32,
    /// First line.
    pub line: u32,
    /// How many lines.
    pub lines: u32,
}

/// One equation `sum a_j u_j = rhs`; its first term is the slave in formats that name one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeckEquation<'a> {
    /// Columns, which are indices into [`Model::dofs`](super::Model::dofs), and coefficients; a zero one keeps its place.
    pub columns: &'a [u32],
    /// Coefficients, in the order of `columns`.
    pub coefficients: &'a [f64],
    /// The right-hand side.
    pub rhs: f64,
    /// Where it stands.
    pub origin: Origin,
}

/// A DOF with a given value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prescribed {
    /// The DOF.
    pub dof: Dof,
    /// Its value; at a time `t`, this times the course at `t`.
    pub value: f64,
    /// How the value runs in time: index into [`Model::courses`](super::Model::courses).
    pub course: u32,
    /// Where that is said.
    pub origin: Origin,
}

/// A loaded DOF.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Load {
    /// The DOF.
    pub dof: Dof,
    /// Where that is said.
    pub origin: Origin,
}

/// What holds at the same time: a step or a subcase.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LoadCase {
    /// `step 1`, `subcase 2`.
    pub name: String,
    /// Prescribed DOFs, ascending, each once.
    pub prescribed: Vec<Prescribed>,
    /// Further values of prescribed DOFs that contradict those in `prescribed`.
    pub clashes: Vec<Prescribed>,
    /// Loads.
    pub loads: Vec<Load>,
    /// Equations that are not in force, ascending.
    pub removed: Vec<u32>,
}

impl LoadCase {
    /// Whether the same holds in another load case, apart from loads.
    pub fn constrains_as(&self, other: &Self) -> bool {
        self.prescribed == other.prescribed && self.clashes == other.clashes && self.removed == other.removed
    }
}

/// Something that the user should know.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Warning {
    /// Index into [`Model::files`](super::Model::files).
    pub file: u32,
    /// The line, from 1; 0 if it concerns no line.
    pub line: u32,
    /// What, in one sentence.
    pub text: String,
    /// Whether something that constrains was left out, so that the model is incomplete.
    pub leaves_out: bool,
}

/// What a deck says once for all of it, where solvers go by it.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct DeckTraits {
    /// Whether some nodes have axes of their own.
    pub(crate) has_local_axes: bool,
    /// Whether a step is geometrically nonlinear.
    pub(crate) is_nonlinear: bool,
    /// Whether a kinematic coupling has axes of its own.
    pub(crate) has_turned_couplings: bool,
}

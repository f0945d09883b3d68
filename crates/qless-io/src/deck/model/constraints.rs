//! The parts of a model: DOFs, equations, load cases and warnings, with their origin in the deck.

/// A component of a node. Reports show it as `node:component`.
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

/// Where something comes from in the deck: a card and its lines.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Origin {
    /// Index into [`Model::cards`](super::Model::cards).
    pub card: u32,
    /// First line, from 1.
    pub line: u32,
    /// Number of lines.
    pub lines: u32,
}

/// An equation `sum a_j u_j = rhs`. In formats with slaves, the first term is the slave.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeckEquation<'a> {
    /// The columns of the terms, which are indices into [`Model::dofs`](super::Model::dofs).
    pub columns: &'a [u32],
    /// The coefficients a_j, in the order of `columns`. Some may be zero.
    pub coefficients: &'a [f64],
    /// The right-hand side.
    pub rhs: f64,
    /// Where the equation comes from.
    pub origin: Origin,
}

/// A DOF with a prescribed value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prescribed {
    /// The DOF.
    pub dof: Dof,
    /// The value at the end of the load case. At any time, the DOF has this value times that of the time history.
    pub value: f64,
    /// The time history, as an index into [`Model::histories`](super::Model::histories).
    pub history: u32,
    /// Where the value comes from.
    pub origin: Origin,
}

/// A DOF on which a load acts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Load {
    /// The DOF.
    pub dof: Dof,
    /// Where the load comes from.
    pub origin: Origin,
}

/// A load case: a step or a subcase.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LoadCase {
    /// The name of the load case, such as `step 1` or `subcase 2`.
    pub name: String,
    /// The prescribed DOFs, ascending, each once.
    pub prescribed: Vec<Prescribed>,
    /// Second values for DOFs that are already in `prescribed`; they contradict the values there.
    pub clashes: Vec<Prescribed>,
    /// The loads that act in this load case.
    pub loads: Vec<Load>,
    /// The equations that are not in force in this load case, ascending.
    pub removed: Vec<u32>,
}

impl LoadCase {
    /// Whether another load case has the same prescribed values and the same equations. Loads are not compared.
    pub fn constrains_as(&self, other: &Self) -> bool {
        self.prescribed == other.prescribed && self.clashes == other.clashes && self.removed == other.removed
    }
}

/// A message for the user.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Warning {
    /// Index into [`Model::files`](super::Model::files).
    pub file: u32,
    /// The line, from 1; 0 if the message concerns no single line.
    pub line: u32,
    /// The message: one sentence.
    pub text: String,
    /// Whether a constraint was left out, so that the model is incomplete.
    pub leaves_out: bool,
}

/// Properties of a whole deck that affect how a solver behaves.
#[derive(Clone, Copy, Debug, Default)]
#[expect(clippy::struct_excessive_bools, reason = "each is a property that stands alone")]
pub(crate) struct DeckTraits {
    /// Whether some nodes have local axes.
    pub(crate) has_local_axes: bool,
    /// Whether a step is geometrically nonlinear.
    pub(crate) is_nonlinear: bool,
    /// Whether a kinematic coupling has axes of its own (`ORIENTATION`).
    pub(crate) has_oriented_couplings: bool,
    /// Whether OptiStruct must not choose other dependent DOFs of rigid elements.
    pub(crate) keeps_dependent: bool,
}

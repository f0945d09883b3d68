//! A constraint system with its known properties, such as `rank C_f = m - redundant`.

use qless::{ConstraintSystem, SystemBuilder};

use crate::SceneError;

/// A generated constraint system with its truth and its geometry.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// m equations on n DOFs. Every DOF occurs in an equation unless the generator states otherwise.
    pub system: ConstraintSystem,
    /// Known properties of the system.
    pub truth: Truth,
    /// Coordinates x, y, z of the nodes in metres; empty for a scene without geometry.
    pub nodes: Vec<[f64; 3]>,
    /// Node and component of each DOF; length n, or empty for a scene without geometry.
    pub dofs: Vec<Dof>,
}

/// Properties of a system that follow from its construction; `None` if unknown.
///
/// ```
/// use qless_scenes::Truth;
/// let truth = Truth::independent(10).with_redundant(2);
/// assert_eq!((truth.rank_free, truth.redundant, truth.conflicting), (Some(8), Some(2), false));
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Truth {
    /// Rank of `C_f`, the columns of the free DOFs, in real arithmetic. Rounded coefficients may have a higher exact rank
    /// as stored, but the difference is far below any sensible tolerance.
    pub rank_free: Option<usize>,
    /// m - rank: number of dependent equations, conflicting ones included.
    pub redundant: Option<usize>,
    /// Whether `C_f u_f = b - C_p u_p` has no solution.
    pub conflicting: bool,
    /// All generated boundary conditions `(DOF, value)`: free DOFs that have the same value in every solution.
    pub generated: Option<Vec<(usize, f64)>>,
    /// Whether the numerical rank may differ from the exact rank, because of small singular values without a clear gap.
    pub ambiguous: bool,
}

impl Truth {
    /// m independent equations.
    pub fn independent(equations: usize) -> Self {
        Self { rank_free: Some(equations), redundant: Some(0), ..Self::default() }
    }

    /// m equations of known rank.
    pub fn rank(equations: usize, rank: usize) -> Self {
        Self::independent(equations).with_redundant(equations.saturating_sub(rank))
    }

    /// Turns `count` of the independent equations into redundant ones.
    #[must_use]
    pub fn with_redundant(mut self, count: usize) -> Self {
        self.rank_free = self.rank_free.map(|rank| rank.saturating_sub(count));
        self.redundant = self.redundant.map(|redundant| redundant.saturating_add(count));
        self
    }

    /// States that there are no generated boundary conditions, or that they are unknown if not `certain`.
    #[must_use]
    pub(crate) fn without_generated(mut self, certain: bool) -> Self {
        self.generated = certain.then(Vec::new);
        self
    }

    /// States whether equations conflict.
    #[must_use]
    pub fn with_conflict(mut self, conflicting: bool) -> Self {
        self.conflicting = conflicting;
        self
    }
}

/// Node and component of a DOF.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Dof {
    /// Index into [`Scene::nodes`].
    pub node: usize,
    /// The displacement component.
    pub component: Component,
}

impl Dof {
    /// The DOFs of nodes with the first `components` of x, y and z, by node.
    pub(crate) fn of_nodes(nodes: usize, components: usize) -> Vec<Self> {
        let dof = |j| Self { node: j / components, component: Component::SPACE[j % components] };
        (0..nodes * components).map(dof).collect()
    }
}

/// A displacement component of a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Component {
    /// Displacement along x.
    X,
    /// Displacement along y.
    Y,
    /// Displacement along z, upwards.
    Z,
    /// Displacement along the outward normal of a wall.
    Normal,
}

impl Component {
    /// The components x, y and z.
    pub const SPACE: [Self; 3] = [Self::X, Self::Y, Self::Z];

    /// The letter in labels: `x`, `y`, `z`, `n`.
    pub fn letter(self) -> char {
        ['x', 'y', 'z', 'n'][self as usize]
    }
}

impl Scene {
    /// A scene without geometry.
    pub(crate) fn bare(builder: SystemBuilder, truth: Truth) -> Result<Self, SceneError> {
        Ok(Self { system: builder.build()?, truth, nodes: Vec::new(), dofs: Vec::new() })
    }
}

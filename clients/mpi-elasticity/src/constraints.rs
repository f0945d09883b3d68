//! The constraints on the nodes of one rank: the tie, periodicity, the inclusion, a fixed corner.

use std::collections::BTreeMap;
use std::error::Error;

use qless::ConstraintSystem;
use qless_constraints::types::{MacroStrain, Node6, NodeTie, Periodic, Point, Shape, SmallRigidBody};
use qless_constraints::{ConstraintSet, SetBuilder};
use qless_mpi::{DistributedElimination, Ranks, Share};

use crate::cell::{AXES, Cell, Node, RIGID};

/// A displacement gradient.
pub type Gradient = [[f64; 3]; 3];

/// Largest number of nodes in the equations of one node: the node, a face, and two images.
const NAMED: usize = 1 + 4 + 2;

/// The equations of one rank.
pub struct Constraints {
    pub share: Share,
    /// The same equations over DOFs in the numbering of this rank.
    system: ConstraintSystem,
    /// The global numbers of these DOFs.
    dofs: Vec<u64>,
    /// The vector from the image of each node to the node; zero unless they lie on opposite faces. Three equations each.
    steps: Vec<[f64; 3]>,
}

/// Collects constraints node by node.
struct Writer<'a> {
    cell: &'a Cell,
    set: SetBuilder,
    place: BTreeMap<u64, usize>,
    dofs: Vec<u64>,
    numbers: Vec<u64>,
    steps: Vec<[f64; 3]>,
}

impl Constraints {
    /// The constraints on the nodes that a rank owns; a corner is fixed.
    pub fn new(cell: &Cell, ranks: &dyn Ranks) -> Result<Self, Box<dyn Error>> {
        let owned = cell.owned(ranks.rank(), ranks.size());
        let set = ConstraintSet::builder(AXES * NAMED * owned.len() + RIGID);
        let mut writer =
            Writer { cell, set, place: BTreeMap::new(), dofs: Vec::new(), numbers: Vec::new(), steps: Vec::new() };
        cell.nodes_in(owned.clone()).try_for_each(|node| writer.node(node))?;
        let Writer { set, dofs, numbers, steps, .. } = writer;
        let set = set.build()?;
        let mut quantities = set.allocate();
        set.evaluate(&vec![0.0; set.dofs()], &mut quantities)?;
        let system = set.linearised(&quantities, &[])?;

        let mut share = Share::new(cell.owned_dofs(ranks.rank(), ranks.size()));
        share.add_system(&system, |j| dofs[j], |i| numbers[i]);
        if owned.contains(&0) {
            (0..AXES as u64).for_each(|dof| share.prescribe(dof, 0.0));
        }
        // The rank needs these DOFs to check its equations and to assemble its hexahedra.
        dofs.iter().for_each(|&dof| share.need(dof));
        let corners = cell.hexahedra_in(owned).flatten();
        corners.for_each(|node| dofs_of(cell, node).into_iter().for_each(|dof| share.need(dof)));
        Ok(Self { share, system, dofs, steps })
    }

    /// `u_b - u_a = E (X_b - X_a)`.
    pub fn stretch(&mut self, e: &Gradient) {
        (0..self.system.equations()).for_each(|i| self.share.set_rhs(i, jump(&self.steps, i, e)));
    }

    /// The largest `|C u - b|` of the original equations.
    pub fn unmet(&self, map: &DistributedElimination, u: &[f64], e: &Gradient) -> f64 {
        let value = |j: usize| u[map.dofs().binary_search(&self.dofs[j]).expect("it was asked for")];
        let off = |i: usize| {
            let sum: f64 = self.system.matrix().row(i).map(|(j, coefficient)| coefficient * value(j)).sum();
            (sum - jump(&self.steps, i, e)).abs()
        };
        (0..self.system.equations()).map(off).fold(0.0, f64::max)
    }
}

/// The right-hand side of an equation.
fn jump(steps: &[[f64; 3]], equation: usize, e: &Gradient) -> f64 {
    let (step, axis) = (steps[equation / AXES], equation % AXES);
    (0..3).map(|k| e[axis][k] * step[k]).sum()
}

/// The numbers of the DOFs of a node.
pub fn dofs_of(cell: &Cell, node: Node) -> [u64; AXES] {
    std::array::from_fn(|axis| (AXES * cell.number(node) + axis) as u64)
}

impl Writer<'_> {
    /// Each kind of equation of a node has its own numbers, independent of the owner of the node.
    fn node(&mut self, node: Node) -> Result<(), Box<dyn Error>> {
        let cells = self.cell.blocks[node.block].cells;
        let point = self.point(node);
        if node.block == 1 && node.place[2] == 0 {
            let tie = self.tie(node, self.cell.blocks[0].cells[2], 0.5);
            self.set.add("tie", tie)?;
            self.said(node, 0, [0.0; 3]);
        }
        if node.block == 1 && node.place[2] == cells[2] {
            let tie = self.tie(node, 0, 0.0);
            self.set.add("periodic in z", tie)?;
            self.said(node, 0, [0.0, 0.0, 1.0]);
        }
        for (axis, step) in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].into_iter().enumerate() {
            if node.place[axis] == cells[axis] {
                let mut image = node;
                image.place[axis] = 0;
                let a = self.point(image);
                self.set.add("periodic", Periodic { a, b: point, strain: MacroStrain::Given([[0.0; 3]; 3]) })?;
                self.said(node, 1 + axis, step);
            }
        }
        if self.cell.is_rigid(node) {
            let rigid: [usize; RIGID] = std::array::from_fn(|k| self.place((AXES * self.cell.nodes() + k) as u64));
            let [x, y, z, rotations @ ..] = rigid;
            let reference = Node6::new([x, y, z], rotations, [0.5; 3]);
            self.set.add("inclusion", SmallRigidBody { reference, nodes: vec![point.into()] })?;
            self.said(node, 3, [0.0; 3]);
        }
        Ok(())
    }

    fn said(&mut self, node: Node, kind: usize, step: [f64; 3]) {
        let first = AXES * (4 * self.cell.number(node) + kind);
        self.numbers.extend((first..first + AXES).map(|number| number as u64));
        self.steps.push(step);
    }

    /// The node projected to this height, and the face of the lower block there.
    fn tie(&mut self, node: Node, k: usize, height: f64) -> NodeTie<3> {
        let Node { place, .. } = node;
        let (own, lower) = (self.cell.blocks[1].cells, self.cell.blocks[0].cells);
        let first = |axis: usize| (place[axis] * lower[axis] / own[axis]).min(lower[axis] - 1);
        let corners = [(0, 0), (1, 0), (1, 1), (0, 1)];
        let face = corners.map(|(i, j)| self.point(Node { block: 0, place: [first(0) + i, first(1) + j, k] })).to_vec();
        let mut point = self.point(node);
        point.at[2] = height;
        NodeTie { node: point, shape: Shape::Quad4, face, tolerance: 1e-9 }
    }

    /// A node for `qless-constraints`, with DOFs in the numbering of this rank.
    fn point(&mut self, node: Node) -> Point {
        Point::new(dofs_of(self.cell, node).map(|dof| self.place(dof)), self.cell.at(node))
    }

    fn place(&mut self, dof: u64) -> usize {
        let next = self.dofs.len();
        let place = *self.place.entry(dof).or_insert(next);
        if place == next {
            self.dofs.push(dof);
        }
        place
    }
}

//! Two blocks of different meshes, one on the other, and what constrains them.

use fenris::assembly::local::{ElementEllipticAssembler, ElementEllipticAssemblerBuilder, UniformQuadratureTable};
use fenris::connectivity::{Connectivity, Hex8Connectivity};
use fenris::mesh::HexMesh;
use fenris::mesh::procedural::create_unit_box_uniform_hex_mesh_3d;
use fenris::nalgebra::{DVector, U3, Vector3};
use fenris_solid::MaterialEllipticOperator;
use fenris_solid::materials::{LameParameters, LinearElasticMaterial};
use qless::ConstraintSystem;
use qless_constraints::ConstraintSet;
use qless_constraints::types::{Face, MacroStrain, Node6, NodeTie, Periodic, Point, Shape, SmallRigidBody, Surface, pairs};

/// DOFs that fenris does not know: translations and rotations of the rigid end.
pub const RIGID: usize = 6;

/// The lower block has `cells` cells along each edge, the upper one fewer.
pub fn two_blocks(cells: usize) -> HexMesh<f64> {
    let lower = create_unit_box_uniform_hex_mesh_3d(cells);
    let upper: HexMesh<f64> = create_unit_box_uniform_hex_mesh_3d(cells - 1).translated(&Vector3::z());
    let first = lower.vertices().len();
    let raised = upper.connectivity().iter().map(|cell| Hex8Connectivity(cell.0.map(|node| first + node)));
    let cells = lower.connectivity().iter().copied().chain(raised).collect();
    HexMesh::from_vertices_and_connectivity([lower.vertices(), upper.vertices()].concat(), cells)
}

pub type Material<'a> = MaterialEllipticOperator<'a, LinearElasticMaterial>;
pub type Quadrature = UniformQuadratureTable<f64, U3, LameParameters<f64>>;

/// Stiffness matrices of the cells.
pub fn stiffness<'a>(
    mesh: &'a HexMesh<f64>,
    material: &'a Material<'a>,
    quadrature: &'a Quadrature,
    u: &'a DVector<f64>,
) -> ElementEllipticAssembler<'a, f64, HexMesh<f64>, Material<'a>, Quadrature> {
    ElementEllipticAssemblerBuilder::new()
        .with_finite_element_space(mesh)
        .with_operator(material)
        .with_quadrature_table(quadrature)
        .with_u(u)
        .build()
}

/// The upper block is tied to the lower one and has a rigid top; the lower one is periodic in x and y under a macroscopic strain, and
/// stands on a plane. The equations of the edges of the periodic faces, and of their feet, are redundant: that is left to qless.
pub fn constraints(mesh: &HexMesh<f64>) -> eyre::Result<ConstraintSystem> {
    let at = |i: usize| mesh.vertices()[i].coords.into();
    let nodes: Vec<Point> =
        (0..mesh.vertices().len()).map(|i| Point::new([3 * i, 3 * i + 1, 3 * i + 2], at(i))).collect();
    let (n, is) = (3 * nodes.len(), |x: f64, plane: f64| (x - plane).abs() < 1e-9);
    let upper = 3 * first_of_upper(mesh);
    let is_lower = |node: &Point| node.dofs[0] < upper;
    let on = |lower: bool, axis: usize, plane: f64| {
        let those = nodes.iter().filter(move |node| is_lower(node) == lower && is(node.at[axis], plane));
        those.copied().collect::<Vec<Point>>()
    };
    let mut set = ConstraintSet::builder(n + RIGID);

    let boundary = mesh.find_boundary_faces().into_iter().map(|(face, ..)| face.vertex_indices().to_vec());
    let top = |face: &Vec<usize>| face.iter().all(|&i| is_lower(&nodes[i]) && is(nodes[i].at[2], 1.0));
    let faces = boundary.filter(top).map(|face| Face::new(Shape::Quad4, face)).collect();
    let surface = Surface { nodes: nodes.clone(), faces };
    for tie in NodeTie::to_surface(&on(false, 2, 1.0), &surface, 1e-9)? {
        set.add("tie", tie)?;
    }
    let strain = MacroStrain::Given([[0.02, 0.01, 0.0], [0.0, -0.01, 0.0], [0.0; 3]]);
    for (axis, step) in [(0, [1.0, 0.0, 0.0]), (1, [0.0, 1.0, 0.0])] {
        for (a, b) in pairs(&on(true, axis, 0.0), &on(true, axis, 1.0), step, 1e-9)? {
            set.add("periodic", Periodic { a, b, strain })?;
        }
    }
    let reference = Node6::new([n, n + 1, n + 2], [n + 3, n + 4, n + 5], [0.5, 0.5, 2.0]);
    let nodes = on(false, 2, 2.0).into_iter().map(Node6::from).collect();
    set.add("rigid end", SmallRigidBody { reference, nodes })?;

    let set = set.build()?;
    let mut quantities = set.allocate();
    set.evaluate(&vec![0.0; set.dofs()], &mut quantities)?;
    let feet = on(true, 2, 0.0).into_iter().map(|node| (node.dofs[2], 0.0));
    // The end is pushed, and twisted about z; it may tilt.
    let driven = [n, n + 1, n + 2, n + 5].map(|dof| (dof, 0.0));
    Ok(set.linearised(&quantities, &feet.chain(driven).collect::<Vec<_>>())?)
}

/// The first node of the upper block.
fn first_of_upper(mesh: &HexMesh<f64>) -> usize {
    // The lower block comes first, and ends at its corner (1, 1, 1).
    let corner = |i: usize| mesh.vertices()[i].coords.iter().all(|x| (x - 1.0).abs() < 1e-9);
    (0..mesh.vertices().len()).find(|&i| corner(i)).map_or(0, |i| i + 1)
}

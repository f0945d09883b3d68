//! Two blocks of Hex20, one on the other, and what constrains their temperatures.

use std::error::Error;

use gemlab::prelude::{At, Block, Features, GeoKind, Mesh, any_x};
use qless::ConstraintSystem;
use qless_constraints::ConstraintSet;
use qless_constraints::types::{Equal, Face, MacroStrain, Node, NodeTie, Periodic, Shape, Surface, pairs};

/// Bottom and top of the lower block, and of the upper one.
const LEVELS: [f64; 3] = [0.0, 1.0, 1.5];

/// Of the temperature from x = 0 to x = 1.
const STEP: f64 = 0.5;

/// The blocks do not share points: gemlab's `join_meshes` would merge those that coincide.
pub fn two_blocks(cells: usize) -> Result<Mesh, Box<dyn Error>> {
    let mut mesh = block(LEVELS[0], LEVELS[1], cells)?;
    let upper = block(LEVELS[1], LEVELS[2], cells + 1)?;
    let (points, count) = (mesh.points.len(), mesh.cells.len());
    for mut point in upper.points {
        point.id += points;
        mesh.points.push(point);
    }
    for mut cell in upper.cells {
        cell.id += count;
        cell.marker = 2;
        cell.points.iter_mut().for_each(|point| *point += points);
        mesh.cells.push(cell);
    }
    Ok(mesh)
}

fn block(low: f64, high: f64, cells: usize) -> Result<Mesh, Box<dyn Error>> {
    let corners = |z: f64| [[0.0, 0.0, z], [1.0, 0.0, z], [1.0, 1.0, z], [0.0, 1.0, z]];
    let all: [[f64; 3]; 8] = [corners(low), corners(high)].concat().try_into().expect("twice four");
    Ok(Block::new(&all)?.set_ndiv(&[cells; 3])?.subdivide(GeoKind::Hex20)?)
}

/// The upper block is tied to the lower one, and its top is isothermal; the lower one is periodic in x and y, but for a step of the
/// temperature in x, and its bottom has given temperatures. What is redundant on its edges and at its bottom is left to qless.
pub fn constraints(mesh: &Mesh) -> Result<ConstraintSystem, Box<dyn Error>> {
    let features = Features::new(mesh, false);
    let mut is_upper = vec![false; mesh.points.len()];
    mesh.cells.iter().filter(|cell| cell.marker == 2).flat_map(|cell| &cell.points).for_each(|&i| is_upper[i] = true);
    let node = |i: usize| Node::of_field(i, std::array::from_fn::<f64, 3, _>(|axis| mesh.points[i].coords[axis]));
    let mut set = ConstraintSet::builder(mesh.points.len());

    let faces = features.search_faces(At::Z(LEVELS[1]), any_x)?.all;
    let faces = faces.iter().filter(|face| !is_upper[face.points[0]]);
    let surface = Surface {
        nodes: (0..mesh.points.len()).map(node).collect(),
        faces: faces.map(|face| Face::new(Shape::Quad8, face.points.as_slice())).collect(),
    };
    let interface = features.search_point_ids(At::Z(LEVELS[1]), any_x)?;
    let tied: Vec<_> = interface.into_iter().filter(|&i| is_upper[i]).map(node).collect();
    for tie in NodeTie::to_surface(&tied, &surface, 1e-9)? {
        set.add("tie", tie)?;
    }
    for (step, across) in [(STEP, [1.0, 0.0, 0.0]), (0.0, [0.0, 1.0, 0.0])] {
        let plane = |x: f64| if across[0] == 1.0 { At::X(x) } else { At::Y(x) };
        let side = |x: f64| features.search_point_ids(plane(x), |at| at[2] <= LEVELS[1]);
        let [from, to] = [side(0.0)?, side(1.0)?]
            .map(|side| side.into_iter().filter(|&i| !is_upper[i]).map(node).collect::<Vec<_>>());
        for (a, b) in pairs(&from, &to, across, 1e-9)? {
            set.add("periodic", Periodic { a, b, strain: MacroStrain::Given([across.map(|x| step * x)]) })?;
        }
    }
    set.add("isothermal end", Equal::new(features.search_point_ids(At::Z(LEVELS[2]), any_x)?))?;

    let set = set.build()?;
    let mut quantities = set.allocate();
    set.evaluate(&vec![0.0; set.dofs()], &mut quantities)?;
    let bottom = features.search_point_ids(At::Z(LEVELS[0]), any_x)?;
    let given: Vec<_> = bottom.into_iter().map(|i| (i, heated(mesh, i))).collect();
    Ok(set.linearised(&quantities, &given)?)
}

/// The temperature of a point of the bottom in the end.
pub fn heated(mesh: &Mesh, point: usize) -> f64 {
    1.0 + STEP * mesh.points[point].coords[0]
}

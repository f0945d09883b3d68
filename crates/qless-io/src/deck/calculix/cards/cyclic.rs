//! `*CYCLIC SYMMETRY MODEL` with `*TIE, CYCLIC SYMMETRY`, for nodal diameter 0. The slave side of the sector moves as the rotated master
//! side: `e . u_s = (R e) . sum N_i u_i` for every direction e. R rotates the slave side onto the master side. N_i are the shape functions
//! of the master's faces, and u_i the displacements of its nodes.
//!
//! Slave and master nodes are matched by radius and height. A slave node without a partner is rotated by one sector; it
//! follows the point on the master's faces that is then nearest.
//!
//! For nodal diameter N, the right-hand side has the factor `e^(i N a)`, a the angle of a sector. If no other equation has DOFs of the two
//! sides, and their prescribed values are zero, then motions of the master side times this factor fulfil the equations exactly where the
//! motions themselves fulfil those of nodal diameter 0: what is redundant, and why, is the same for all N. Values other than zero do not
//! matter if all steps are `*STATIC`, which have nodal diameter 0, or `*FREQUENCY`, whose modes are zero there.

use std::collections::BTreeSet;

use crate::deck::calculix::cards::unread::claim;
use crate::deck::calculix::cards::{CardEquation, RegisteredCard, tie};
use crate::deck::calculix::model::frames::{around, two_points};
use crate::deck::calculix::model::{DeckDefinitions, DeckSurface};
use crate::deck::calculix::syntax::{KeywordCard, float};
use crate::deck::kinematics::axes::Frame;
use crate::deck::kinematics::body::Poses;
use crate::deck::kinematics::project::{FaceGrid, MasterFace};
use crate::deck::kinematics::vector::{Vector, dot, length, minus, plus, scaled};
use crate::deck::{DeckError, Dof, Model, Prescribed, Problem};
use crate::fault::quote;

/// Default for the largest distance between a slave node and its partner, relative to the size of the slave side.
const TOLERANCE: f64 = 1e-4;
/// A node lies on the axis if its radius is below this fraction of its distance from the origin of the axis.
const AXIS: f64 = 1e-9;

/// Adds the equations of a `*CYCLIC SYMMETRY MODEL` card and its tie, or leaves the card out with a warning.
pub fn read(
    card: &KeywordCard,
    tie: &KeywordCard,
    model: &mut Model,
    definitions: &DeckDefinitions,
) -> Result<(), DeckError> {
    let place = RegisteredCard::register(card, model, "*CYCLIC SYMMETRY MODEL");
    place.mark_irreplaceable(model);
    let sector = Sector::new(card, tie, definitions);
    let sector = sector.map_err(|problem| place.fail(model, problem))?;
    let is_complex = definitions.steps.has_diameters && !sector.is_alone(model);
    let rows = if is_complex { None } else { sector.rows().map_err(|p| place.fail(model, p))? };
    if let Some(rows) = rows {
        if definitions.steps.has_diameters {
            let text = "the equations are those of nodal diameter 0; those of others have complex factors, which change no verdict";
            model.warn(card.file, card.line, format!("*CYCLIC SYMMETRY MODEL: {text}"));
        }
        return place.push(model, Ok(rows));
    }
    let why = if is_complex {
        "modes of several nodal diameters have complex equations, and its sides have other equations or values"
    } else {
        "nodes of the slave side lie on the axis or have no partner on the master side"
    };
    model.leave_out(card.file, card.line, format!("*CYCLIC SYMMETRY MODEL constrains, but {why}: left out"));
    claim(&place, model, definitions, sector.slaves.iter().chain(&sector.masters).copied());
    Ok(())
}

/// One sector of the model: its axis and angle, and the nodes and faces of its two sides.
struct Sector<'a> {
    definitions: &'a DeckDefinitions,
    axis: Frame,
    angle: f64,
    slaves: Vec<u32>,
    masters: Vec<u32>,
    faces: Vec<MasterFace>,
    tolerance: f64,
}

impl<'a> Sector<'a> {
    fn new(card: &KeywordCard, tie: &KeywordCard, definitions: &'a DeckDefinitions) -> Result<Self, Problem> {
        let count = card.parameter("N").ok_or(Problem::NoParameter { name: "N" })?;
        let count = float(count.as_bytes())?;
        if count < 1.0 {
            let found = quote(count.to_string().as_bytes());
            return Err(Problem::Expected { expected: "at least one sector", found });
        }
        let [a, b] = two_points(card.lines().flat_map(|line| line.fields()))?;
        let axis = around(a, b);
        let axis = axis.ok_or_else(|| Problem::Degenerate { what: "the two points define no axis".into() })?;
        let [slave, master] = tie::sides(tie)?;
        let slaves = DeckSurface::find(definitions, tie.scope, &slave)?.all_nodes();
        let master = DeckSurface::find(definitions, tie.scope, &master)?;
        let masters = master.all_nodes();
        let faces = MasterFace::all(master.faces, master.is_line, |node| definitions.position(node))?;
        let given = tie.parameter("POSITIONTOLERANCE").map(|text| float(text.as_bytes())).transpose()?;
        let tolerance = given.map_or_else(|| size(definitions, &slaves).map(|size| TOLERANCE * size), Ok)?;
        let angle = std::f64::consts::TAU / count;
        Ok(Self { definitions, axis, angle, slaves, masters, faces, tolerance })
    }

    /// Whether no equation that has been read has DOFs of the two sides, they have no node in common, and their prescribed values are zero or
    /// act in static steps only.
    fn is_alone(&self, model: &Model) -> bool {
        let sides: BTreeSet<u32> = self.slaves.iter().chain(&self.masters).copied().collect();
        let is_apart = sides.len() == self.slaves.len() + self.masters.len();
        let has_equation = |&node: &u32| (1..=3).any(|component| model.column(Dof { node, component }).is_some());
        let has_value = |given: &Prescribed| given.value != 0.0 && sides.contains(&given.dof.node);
        let mut given = model.cases.iter().flat_map(|case| &case.prescribed);
        is_apart
            && !sides.iter().any(has_equation)
            && (self.definitions.steps.are_static_or_modes() || !given.any(has_value))
    }

    /// The equations of all slaves. `None` if a slave lies on the axis, or has neither a partner nor a master face nearby.
    fn rows(&self) -> Result<Option<Vec<CardEquation>>, Problem> {
        let mut masters = Vec::with_capacity(self.masters.len());
        for &master in &self.masters {
            masters.push((master, self.meridian(self.definitions.position(master)?)));
        }
        // The masters are sorted by radius, so that each slave is compared with only a few of them.
        masters.sort_by(|a, b| a.1[0].total_cmp(&b.1[0]));
        let grid = FaceGrid::new(&self.faces, self.tolerance);
        let mut rows = Vec::with_capacity(3 * self.slaves.len());
        for &slave in &self.slaves {
            let position = self.definitions.position(slave)?;
            let meridian = self.meridian(position);
            if meridian[0] <= AXIS * length(minus(position, self.axis.origin)) {
                return Ok(None);
            }
            let partner = self.partner(&masters, meridian).map(|node| vec![(node, 1.0)]);
            let Some(partners) = partner.or_else(|| self.projected(&grid, position)) else { return Ok(None) };
            if partners.iter().any(|(node, _)| *node == slave) {
                continue;
            }
            rows.extend(self.follow(slave, position, &partners)?);
        }
        Ok(Some(rows))
    }

    /// The radius of a point about the axis, and its height along the axis.
    fn meridian(&self, x: Vector) -> [f64; 2] {
        let from = minus(x, self.axis.origin);
        let [first, second, third] = self.axis.axes.map(|axis| dot(axis, from));
        [first.hypot(second), third]
    }

    /// The master node that is nearest to the radius r and the height z of a slave; `None` if it is beyond the tolerance.
    fn partner(&self, masters: &[(u32, [f64; 2])], [r, z]: [f64; 2]) -> Option<u32> {
        let start = masters.partition_point(|(_, meridian)| meridian[0] < r - self.tolerance);
        let near = masters[start..].iter().take_while(|(_, meridian)| meridian[0] <= r + self.tolerance);
        let apart = near.map(|(node, [s, t])| (*node, (s - r).hypot(t - z)));
        let nearest = apart.min_by(|a, b| a.1.total_cmp(&b.1))?;
        (nearest.1 <= self.tolerance).then_some(nearest.0)
    }

    /// Rotates the slave at x by one sector in either direction and finds the nearest point on the master's faces.
    /// Returns the nodes and weights of this point; `None` if the point is too far away.
    fn projected(&self, grid: &FaceGrid, x: Vector) -> Option<Vec<(u32, f64)>> {
        let near = [self.angle, -self.angle].map(|angle| grid.nearest(&self.faces, self.rotated(x, angle)));
        let near = near.into_iter().flatten().min_by(|a, b| a.distance.total_cmp(&b.distance))?;
        let is_near = near.distance <= self.tolerance.max(tie::TOLERANCE * MasterFace::mean_size(&self.faces));
        let nodes = self.faces[near.face].nodes.iter().copied();
        is_near.then(|| nodes.zip(near.weights).filter(|(_, weight)| *weight != 0.0).collect())
    }

    fn rotated(&self, x: Vector, angle: f64) -> Vector {
        let [radial, tangential, _] = self.axis.axes_at(x);
        let [r, z] = self.meridian(x);
        let axial = scaled(self.axis.axes[2], z);
        let across = plus(scaled(radial, r * angle.cos()), scaled(tangential, r * angle.sin()));
        plus(plus(self.axis.origin, axial), across)
    }

    /// The equations by which the three components of a slave follow the master nodes in `partners`, each of which has a weight.
    fn follow(&self, slave: u32, position: Vector, partners: &[(u32, f64)]) -> Result<Vec<CardEquation>, Problem> {
        let mut there = [0.0; 3];
        for &(node, weight) in partners {
            there = plus(there, scaled(self.definitions.position(node)?, weight));
        }
        let (here, there) = (self.axis.axes_at(position), self.axis.axes_at(there));
        let row = |direction: Vector| {
            let image = (0..3).fold([0.0; 3], |sum, k| plus(sum, scaled(there[k], dot(here[k], direction))));
            let others = partners.iter().map(|&(node, weight)| (node, scaled(image, -weight)));
            let gradients: Vec<(u32, Vector)> = std::iter::once((slave, direction)).chain(others).collect();
            CardEquation::along(self.definitions, &gradients, 0.0)
        };
        self.definitions.pose(slave)?.axes.into_iter().map(row).collect()
    }
}

/// The diagonal of the bounding box of these nodes.
fn size(definitions: &DeckDefinitions, nodes: &[u32]) -> Result<f64, Problem> {
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for &node in nodes {
        let x = definitions.position(node)?;
        low = std::array::from_fn(|k| low[k].min(x[k]));
        high = std::array::from_fn(|k| high[k].max(x[k]));
    }
    Ok(if nodes.is_empty() { 0.0 } else { length(minus(high, low)) })
}

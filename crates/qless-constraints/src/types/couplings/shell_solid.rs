//! `u_s + theta x r`: the edge of a shell and the side of a solid, line by line through the thickness.

use super::equations::{DofOwners, follow};
use super::error::{CouplingError, LineFault};
use super::face_integrals::GaussPoint;
use super::node6::Node6;
use super::rigid_motion::{along, arm, axis, clean};
use super::{Section, face_integrals};
use crate::geometry::node::AXES;
use crate::geometry::surface::Surface;
use crate::scalar::vector::{Vector, add, cross, dot, norm, perpendicular, scale, unit};
use crate::{Constraint, Store};

/// The edge of a shell joined to the side of a solid, for small rotations: each shell node with its line of solid nodes.
///
/// With the direction d of the line, `e_1`, `e_2` perpendicular to it, `r_i = X_i - X_s`, and for each line one of
///
/// - [`Section::Rigid`]: `u_i = u_s + theta x r_i` at each of its n nodes, 3 n equations;
/// - [`Section::Plane`]: `e . u_i = e . (u_s + theta x r_i)` for `e_1` and `e_2` at each node, and along d the mean: `2 n + 1`;
/// - [`Section::Mean`]: `sum_i w_i (u_i - u_s - theta x r_i) = 0`, and `e . sum_i m_i (u_i - u_s - theta x r_i) = 0` for `e_1` and
///   `e_2`: 5 equations.
///
/// `w_i = int N_i dA` is the tributary area of a node on the side of the solid, `m_i = int N_i z dA` with the height z along the
/// line above the centre of the `w_i`. So `Mean` hands over the nodal forces of a stress that is linear through the thickness and
/// the same along the edge, exactly, also for quadratic faces. The rotation about d, which moves no node of a straight line,
/// is not coupled: hold it at the shell, as elsewhere on it.
///
/// DOFs removed: as many as equations; they are independent. Units: lengths for translations, radians for rotations; the choice
/// of the unit of length changes nothing. Cost: O(nodes + faces).
///
/// Source: resultants as in Reissner-Mindlin theory, `n = int sigma dz`, `m = int z sigma dz`, with the virtual work of both sides equal.
///
#[doc = include_str!("../../../docs/pictures/shell_to_solid.svg")]
///
#[doc = include_str!("../../../docs/types/shell_to_solid.md")]
/// # Example
///
/// ```
/// use qless_constraints::ConstraintSet;
/// use qless_constraints::types::{Face, Node6, Point, Section, Shape, ShellToSolid, Surface, ThicknessLine};
/// // A side of 2 x 1 with two nodes through the thickness, z; the shell's edge at half of it.
/// let at = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 0.0, 1.0], [0.0, 0.0, 1.0]];
/// let nodes = (0..4).map(|i| Point::new([12 + 3 * i, 13 + 3 * i, 14 + 3 * i], at[i])).collect();
/// let face = Surface { nodes, faces: vec![Face::new(Shape::Quad4, [0, 1, 2, 3])] };
/// let lines = vec![
///     ThicknessLine { shell: Node6::new([0, 1, 2], [3, 4, 5], [0.0, 0.0, 0.5]), nodes: vec![0, 3] },
///     ThicknessLine { shell: Node6::new([6, 7, 8], [9, 10, 11], [2.0, 0.0, 0.5]), nodes: vec![1, 2] },
/// ];
/// let mut builder = ConstraintSet::builder(24);
/// builder.add("edge", ShellToSolid { lines, face, section: Section::Mean })?;
/// assert_eq!(builder.build()?.equations(), 10);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct ShellToSolid {
    /// One for each node of the shell's edge; every node of the faces is in one.
    pub lines: Vec<ThicknessLine>,
    /// The side of the solid that the edge is joined to.
    pub face: Surface<3>,
    /// What stays of the shape of the lines.
    pub section: Section,
}

/// A node of a shell's edge and the nodes of the solid through the thickness there.
#[derive(Clone, Debug, PartialEq)]
pub struct ThicknessLine {
    /// The node of the shell.
    pub shell: Node6,
    /// Nodes of the surface, from 0, in any order.
    pub nodes: Vec<usize>,
}

/// One line, and what it needs to write its equations.
struct LineCoupling<'a> {
    number: usize,
    shell: &'a Node6,
    line: &'a LineShares,
    face: &'a Surface<3>,
}

impl LineCoupling<'_> {
    /// `sum_i a_i e . (u_i - u_s - theta x r_i) = 0`.
    fn equation(&self, store: &mut Store, a: &[f64], e: Vector<f64>, name: &str) -> Result<(), CouplingError> {
        let (mut terms, mut motion, mut sizes) = (Vec::new(), [0.0; 6], [0.0; 2]);
        for (&node, &a) in self.line.nodes.iter().zip(a) {
            let node = &self.face.nodes[node];
            terms.extend((0..3).map(|k| (node.dofs[k], a * e[k])));
            let r = arm(node.at, self.shell.at);
            let own = along(e, r);
            (0..6).for_each(|k| motion[k] += a * own[k]);
            sizes = [sizes[0] + a.abs(), sizes[1] + a.abs() * norm(r)];
        }
        // Weights sum to one and moments to zero: what rounding leaves of such sums is no factor.
        let rounding = |k: usize| 64.0 * f64::EPSILON * sizes[k / 3];
        motion.iter_mut().enumerate().filter(|(k, x)| x.abs() <= rounding(*k)).for_each(|(_, x)| *x = 0.0);
        clean(terms.iter_mut().map(|(_, a)| a), 1.0);
        follow(store, format!("line {}, {name}", self.number), terms, self.shell, motion)
    }

    fn held(&self, store: &mut Store, e: Vector<f64>, name: &str) -> Result<(), CouplingError> {
        for (i, node) in self.line.nodes.iter().enumerate() {
            let one: Vec<f64> = (0..self.line.nodes.len()).map(|k| f64::from(u8::from(k == i))).collect();
            self.equation(store, &one, e, &format!("node {}, {name}", node + 1))?;
        }
        Ok(())
    }

    fn equations(&self, store: &mut Store, section: Section) -> Result<(), CouplingError> {
        let LineShares { direction, weights, moments, .. } = self.line;
        let across = perpendicular(*direction);
        let both = ["across 1", "across 2"].into_iter().zip(across);
        match section {
            Section::Rigid => (0..3).try_for_each(|k| self.held(store, axis(k), AXES[k])),
            Section::Plane => {
                both.into_iter().try_for_each(|(name, e)| self.held(store, e, name))?;
                self.equation(store, weights, *direction, "thickness")
            }
            Section::Mean => {
                (0..3).try_for_each(|k| self.equation(store, weights, axis(k), AXES[k]))?;
                both.into_iter().try_for_each(|(name, e)| self.equation(store, moments, e, &format!("rotation {name}")))
            }
        }
    }
}

impl ShellToSolid {
    /// Each node has DOFs of its own, and each shell node a place; lines name nodes that are there.
    fn check_dofs(&self) -> Result<(), CouplingError> {
        let mut owners = DofOwners::default();
        let fault = |line: usize, fault: LineFault| CouplingError::Line { line: line + 1, fault };
        for (i, ThicknessLine { nodes, .. }) in self.lines.iter().enumerate() {
            for &node in nodes {
                let shared = |dof| fault(i, LineFault::SharedDof { node, dof });
                owners.claim(node, &self.face.nodes[node].into(), false).map_err(shared)?;
            }
        }
        for (i, ThicknessLine { shell, .. }) in self.lines.iter().enumerate() {
            let sound = shell.at.iter().all(|x| x.is_finite()) && shell.without_dofs().is_none();
            if !sound || owners.claim(i, shell, false).is_err() {
                return Err(fault(i, LineFault::Shell));
            }
        }
        Ok(())
    }
}

impl Constraint for ShellToSolid {
    const NAME: &'static str = "shell to solid";
    type Error = CouplingError;

    fn process(self, store: &mut Store) -> Result<(), CouplingError> {
        let points = face_integrals::points(&self.face)?;
        if self.lines.is_empty() {
            return Err(CouplingError::NoNodes);
        }
        let made = lines(&self.lines, &self.face, &points)?;
        self.check_dofs()?;
        for (i, (ThicknessLine { shell, .. }, line)) in self.lines.iter().zip(&made).enumerate() {
            LineCoupling { number: i + 1, shell, line, face: &self.face }.equations(store, self.section)?;
        }
        Ok(())
    }
}

/// How far a node may be beside the line, in lengths of it.
const BENT: f64 = 0.01;
/// Sums of weights below this part of their terms are zero.
const NOTHING: f64 = 1e-8;

/// A line that is straight and near its shell node.
pub struct LineShares {
    pub direction: Vector<f64>,
    /// Nodes of the surface.
    pub nodes: Vec<usize>,
    origin: Vector<f64>,
    /// Heights of the nodes above the origin.
    heights: Vec<f64>,
    /// `w_i`, then divided by their sum.
    pub weights: Vec<f64>,
    /// `m_i`, then with a sum of zero and `sum m_i z_i = 1`: one over a length.
    pub moments: Vec<f64>,
}

impl LineShares {
    pub fn new(line: &ThicknessLine, face: &Surface<3>) -> Result<Self, LineFault> {
        let places: Vec<Vector<f64>> = line.nodes.iter().map(|&node| face.nodes[node].at).collect();
        let origin = *places.first().ok_or(LineFault::TooShort)?;
        let arms: Vec<Vector<f64>> = places.iter().map(|&at| arm(at, origin)).collect();
        let (far, length) = extent(&arms);
        let direction = unit(far).ok_or(LineFault::TooShort)?;
        let heights = arms.iter().map(|&r| dot(r, direction)).collect();
        for (&node, &r) in line.nodes.iter().zip(&arms) {
            let distance = size(cross(r, direction));
            if distance > BENT * length {
                return Err(LineFault::Bent { node, distance, length });
            }
        }
        let distance = size(cross(arm(line.shell.at, origin), direction));
        if distance > length {
            return Err(LineFault::Apart { distance, length });
        }
        let none = vec![0.0; places.len()];
        Ok(Self { direction, nodes: line.nodes.clone(), origin, heights, weights: none.clone(), moments: none })
    }

    /// Adds the share of a point of integration to its node at `place` of the line.
    pub fn add(&mut self, place: usize, gauss: &GaussPoint, function: f64) {
        let share = gauss.weight() * function;
        self.weights[place] += share;
        self.moments[place] += share * dot(arm(gauss.at, self.origin), self.direction);
    }

    /// Makes the weights a mean, and the moments those about the centre of the weights.
    pub fn normalise(&mut self) -> Result<(), LineFault> {
        let total = sum(self.weights.iter().copied())?;
        self.weights.iter_mut().for_each(|w| *w /= total);
        let centre: f64 = self.moments.iter().sum();
        self.moments.iter_mut().zip(&self.weights).for_each(|(m, w)| *m -= centre * w);
        let second = sum(self.moments.iter().zip(&self.heights).map(|(m, z)| m * z))?;
        self.moments.iter_mut().for_each(|m| *m /= second);
        Ok(())
    }
}

/// A sum that is more than rounding of its terms.
fn sum(terms: impl Iterator<Item = f64> + Clone) -> Result<f64, LineFault> {
    let (total, size) = (terms.clone().sum::<f64>(), terms.map(f64::abs).sum::<f64>());
    if total > NOTHING * size { Ok(total) } else { Err(LineFault::NoArea) }
}

/// From the first place to the one farthest from it, made longer by what lies on the other side; and the length of the line.
fn extent(arms: &[Vector<f64>]) -> (Vector<f64>, f64) {
    let far = arms.iter().copied().max_by(|&a, &b| size(a).total_cmp(&size(b))).unwrap_or_default();
    let (mut low, mut high) = ([0.0; 3], far);
    for &r in arms {
        if dot(r, far) < dot(low, far) {
            low = r;
        } else if dot(r, far) > dot(high, far) {
            high = r;
        }
    }
    let whole = add(high, scale(-1.0, low));
    (whole, size(whole))
}

fn size(x: Vector<f64>) -> f64 {
    x[0].hypot(x[1]).hypot(x[2])
}

/// The lines, with the shares of all faces; each node of a face is in one line.
pub fn lines(
    lines: &[ThicknessLine],
    face: &Surface<3>,
    points: &[GaussPoint],
) -> Result<Vec<LineShares>, CouplingError> {
    let places = places(lines, face)?;
    let fault = |line: usize| move |fault| CouplingError::Line { line: line + 1, fault };
    let made = lines.iter().enumerate().map(|(i, line)| LineShares::new(line, face).map_err(fault(i)));
    let mut made: Vec<LineShares> = made.collect::<Result<_, _>>()?;
    for gauss in points {
        for (&node, &function) in face.faces[gauss.face].nodes.iter().zip(&gauss.functions) {
            let (line, place) = places[node].ok_or(CouplingError::NotInLine { node })?;
            made[line].add(place, gauss, function);
        }
    }
    made.iter_mut().enumerate().try_for_each(|(i, line)| line.normalise().map_err(fault(i)))?;
    Ok(made)
}

/// The line of each node of the surface, and its place there.
fn places(lines: &[ThicknessLine], face: &Surface<3>) -> Result<Vec<Option<(usize, usize)>>, CouplingError> {
    let mut places = vec![None; face.nodes.len()];
    let mut on_face = vec![false; face.nodes.len()];
    face.faces.iter().flat_map(|face| &face.nodes).for_each(|&node| on_face[node] = true);
    for (i, line) in lines.iter().enumerate() {
        for (k, &node) in line.nodes.iter().enumerate() {
            if !on_face.get(node).is_some_and(|&is| is) || places[node].is_some() {
                return Err(CouplingError::Line { line: i + 1, fault: LineFault::Node { node } });
            }
            places[node] = Some((i, k));
        }
    }
    Ok(places)
}

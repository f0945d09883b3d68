//! `u_s + theta x r`: the edge of a shell joined to the side of a solid, line by line through the thickness.

use super::equations::{DofOwners, follow};
use super::error::{CouplingError, LineFault};
use super::face_integrals::GaussPoint;
use super::node6::Node6;
use super::rigid_motion::{along, arm};
use super::{Section, face_integrals};
use crate::geometry::node::{AXES, ROUNDING};
use crate::geometry::surface::Surface;
use crate::scalar::vector::{Vector, add, axis, cross, dot, hypot, norm, perpendicular, scale, unit};
use crate::scalar::{HALF_DIGITS, clean};
use crate::{Constraint, EquationSink};

/// The edge of a shell joined to the side of a solid, for small rotations: each shell node with a line of solid nodes.
///
/// Let d be the direction of the line, `e_1` and `e_2` perpendicular to it, and `r_i = X_i - X_s`. The equations of
/// each line are one of
///
/// - [`Section::Rigid`]: `u_i = u_s + theta x r_i` at each of its n nodes, 3 n equations;
/// - [`Section::Plane`]: `e . u_i = e . (u_s + theta x r_i)` for `e_1` and `e_2` at each node, and the mean along d,
///   `2 n + 1` equations;
/// - [`Section::Mean`]: `sum_i w_i (u_i - u_s - theta x r_i) = 0`, and `e . sum_i m_i (u_i - u_s - theta x r_i) = 0`
///   for `e_1` and `e_2`, 5 equations.
///
/// `w_i = int N_i dA` is the tributary area of a node on the side of the solid, and `m_i = int N_i z dA`, where z is
/// the height along the line above the centre of the `w_i`. So `Mean` applies exactly the nodal forces of a stress
/// that is linear through the thickness and constant along the edge, also for quadratic faces. If the shell node lies on
/// the line, its rotation about d moves no node of the line. This rotation is not coupled: the shell must restrain it, as
/// at its other nodes.
///
/// The equations are independent. Cost: O(nodes + faces).
///
#[doc = include_str!("../../../docs/pictures/shell_to_solid.svg")]
///
#[doc = include_str!("../../../docs/types/shell_to_solid.md")]
/// # Example
///
/// ```
/// use qless_constraints::ConstraintSet;
/// use qless_constraints::types::{Face, Node6, Point, Section, Shape, ShellToSolid, Surface, ThicknessLine};
/// // A side of 2 x 1 with two nodes through the thickness, along z. The edge of the shell is at half of it.
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
    /// One line for each node of the shell's edge. Every node of the faces belongs to one line.
    pub lines: Vec<ThicknessLine>,
    /// The side of the solid.
    pub face: Surface<3>,
    /// How the lines may deform.
    pub section: Section,
}

/// A node of a shell's edge, and the solid nodes through the thickness there.
#[derive(Clone, Debug, PartialEq)]
pub struct ThicknessLine {
    /// The node of the shell.
    pub shell: Node6,
    /// Indices of the nodes of the line in the surface, from 0, in any order.
    pub nodes: Vec<usize>,
}

/// One line with the data of its equations.
struct LineCoupling<'a> {
    number: usize,
    shell: &'a Node6,
    line: &'a LineShares,
    face: &'a Surface<3>,
}

impl LineCoupling<'_> {
    /// Adds `sum_i a_i e . (u_i - u_s - theta x r_i) = 0` over the nodes i of the line, which are at `r_i` from the shell node s.
    fn equation(&self, sink: &mut EquationSink, a: &[f64], e: Vector<f64>, name: &str) -> Result<(), CouplingError> {
        let (mut terms, mut motion, mut sizes) = (Vec::new(), [0.0; 6], [0.0; 2]);
        for (&node, &a) in self.line.nodes.iter().zip(a) {
            let node = &self.face.nodes[node];
            terms.extend((0..3).map(|k| (node.dofs[k], a * e[k])));
            let r = arm(node.at, self.shell.at);
            let own = along(e, r);
            (0..6).for_each(|k| motion[k] += a * own[k]);
            sizes = [sizes[0] + a.abs(), sizes[1] + a.abs() * norm(r)];
        }
        // If the `a_i` are first moments, they sum to zero, so that some factors of the shell's motion are only rounding. These factors are
        // set to zero.
        let rounding = |k: usize| ROUNDING * sizes[k / 3];
        motion.iter_mut().enumerate().filter(|(k, x)| x.abs() <= rounding(*k)).for_each(|(_, x)| *x = 0.0);
        clean(terms.iter_mut().map(|(_, a)| a), 1.0);
        follow(sink, format!("line {}, {name}", self.number), terms, self.shell, motion)
    }

    fn equation_per_node(&self, sink: &mut EquationSink, e: Vector<f64>, name: &str) -> Result<(), CouplingError> {
        for (i, node) in self.line.nodes.iter().enumerate() {
            let one: Vec<f64> = (0..self.line.nodes.len()).map(|k| f64::from(u8::from(k == i))).collect();
            self.equation(sink, &one, e, &format!("node {}, {name}", node + 1))?;
        }
        Ok(())
    }

    fn equations(&self, sink: &mut EquationSink, section: Section) -> Result<(), CouplingError> {
        let LineShares { direction, weights, moments, .. } = self.line;
        let across = perpendicular(*direction);
        let both = ["across 1", "across 2"].into_iter().zip(across);
        match section {
            Section::Rigid => (0..3).try_for_each(|k| self.equation_per_node(sink, axis(k), AXES[k])),
            Section::Plane => {
                both.into_iter().try_for_each(|(name, e)| self.equation_per_node(sink, e, name))?;
                self.equation(sink, weights, *direction, "thickness")
            }
            Section::Mean => {
                (0..3).try_for_each(|k| self.equation(sink, weights, axis(k), AXES[k]))?;
                both.into_iter().try_for_each(|(name, e)| self.equation(sink, moments, e, &format!("rotation {name}")))
            }
        }
    }
}

impl ShellToSolid {
    /// Checks that each node has DOFs of its own, and that shell nodes have finite coordinates.
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

    fn emit(self, sink: &mut EquationSink) -> Result<(), CouplingError> {
        let points = face_integrals::points(&self.face)?;
        if self.lines.is_empty() {
            return Err(CouplingError::NoNodes);
        }
        let shares = line_shares(&self.lines, &self.face, &points)?;
        self.check_dofs()?;
        for (i, (ThicknessLine { shell, .. }, line)) in self.lines.iter().zip(&shares).enumerate() {
            LineCoupling { number: i + 1, shell, line, face: &self.face }.equations(sink, self.section)?;
        }
        Ok(())
    }
}

/// Largest allowed distance of a solid node from the line through the thickness, relative to the length of the line.
const BENT: f64 = 0.01;

/// Solid nodes on a straight line through the thickness, near a shell node. Each has a share of the side of the solid: its area
/// `w_i = int N_i dA` and its first moment `m_i = int N_i z dA`, where z is the height along the line.
pub struct LineShares {
    pub direction: Vector<f64>,
    /// Indices of the nodes of the line in the surface.
    pub nodes: Vec<usize>,
    origin: Vector<f64>,
    /// Heights `z_i` of the nodes along the line, measured from its first node.
    heights: Vec<f64>,
    /// The areas `w_i`; [`LineShares::normalise`] divides them by their sum.
    pub weights: Vec<f64>,
    /// The first moments `m_i`. After [`LineShares::normalise`] their sum is zero and `sum m_i z_i = 1` with the heights `z_i`; their unit
    /// is then one over a length.
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
            let distance = hypot(cross(r, direction));
            if distance > BENT * length {
                return Err(LineFault::Bent { node, distance, length });
            }
        }
        let distance = hypot(cross(arm(line.shell.at, origin), direction));
        if distance > length {
            return Err(LineFault::Apart { distance, length });
        }
        let none = vec![0.0; places.len()];
        Ok(Self { direction, nodes: line.nodes.clone(), origin, heights, weights: none.clone(), moments: none })
    }

    /// Adds the share of a quadrature point to the node at position `place` of the line.
    pub fn add(&mut self, place: usize, gauss: &GaussPoint, function: f64) {
        let share = gauss.weight() * function;
        self.weights[place] += share;
        self.moments[place] += share * dot(arm(gauss.at, self.origin), self.direction);
    }

    /// Scales the weights to the sum one. Refers the moments to the centre of the weights, and scales them to `sum m_i z_i = 1` with the
    /// heights `z_i` of the nodes.
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

/// The sum of the terms. An error unless it is positive beyond rounding.
fn sum(terms: impl Iterator<Item = f64> + Clone) -> Result<f64, LineFault> {
    let (total, size) = (terms.clone().sum::<f64>(), terms.map(f64::abs).sum::<f64>());
    if total > HALF_DIGITS * size { Ok(total) } else { Err(LineFault::NoArea) }
}

/// The vector between the outermost nodes, and its length.
fn extent(arms: &[Vector<f64>]) -> (Vector<f64>, f64) {
    let far = arms.iter().copied().max_by(|&a, &b| hypot(a).total_cmp(&hypot(b))).unwrap_or_default();
    let (mut low, mut high) = ([0.0; 3], far);
    for &r in arms {
        if dot(r, far) < dot(low, far) {
            low = r;
        } else if dot(r, far) > dot(high, far) {
            high = r;
        }
    }
    let whole = add(high, scale(-1.0, low));
    (whole, hypot(whole))
}

/// Computes the shares of all lines. Every node of a face must belong to a line.
fn line_shares(
    lines: &[ThicknessLine],
    face: &Surface<3>,
    points: &[GaussPoint],
) -> Result<Vec<LineShares>, CouplingError> {
    let places = places(lines, face)?;
    let fault = |line: usize| move |fault| CouplingError::Line { line: line + 1, fault };
    let shares = lines.iter().enumerate().map(|(i, line)| LineShares::new(line, face).map_err(fault(i)));
    let mut shares: Vec<LineShares> = shares.collect::<Result<_, _>>()?;
    for gauss in points {
        for (&node, &function) in face.faces[gauss.face].nodes.iter().zip(&gauss.functions) {
            let (line, place) = places[node].ok_or(CouplingError::NotInLine { node })?;
            shares[line].add(place, gauss, function);
        }
    }
    shares.iter_mut().enumerate().try_for_each(|(i, line)| line.normalise().map_err(fault(i)))?;
    Ok(shares)
}

/// For each node of the surface, its line and its position there.
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

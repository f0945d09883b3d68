//! A line of nodes through the thickness of a shell, with the shares `w_i = int N_i dA` and `m_i = int N_i z dA` of its nodes.

use super::area::Gauss;
use super::arm::arm;
use super::error::{CouplingError, LineFault};
use super::shell_solid::ThicknessLine;
use crate::geometry::surface::Surface;
use crate::scalar::vector::{Vector, add, cross, dot, scale, unit};

/// How far a node may be beside the line, in lengths of it.
const BENT: f64 = 0.01;
/// Sums of weights below this part of their terms are zero.
const NOTHING: f64 = 1e-8;

/// A line that is straight and near its shell node.
pub struct Thickness {
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

impl Thickness {
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
    pub fn add(&mut self, place: usize, gauss: &Gauss, function: f64) {
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
pub fn lines(lines: &[ThicknessLine], face: &Surface<3>, points: &[Gauss]) -> Result<Vec<Thickness>, CouplingError> {
    let places = places(lines, face)?;
    let fault = |line: usize| move |fault| CouplingError::Line { line: line + 1, fault };
    let made = lines.iter().enumerate().map(|(i, line)| Thickness::new(line, face).map_err(fault(i)));
    let mut made: Vec<Thickness> = made.collect::<Result<_, _>>()?;
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

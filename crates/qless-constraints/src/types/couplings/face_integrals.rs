//! `int f dA = sum_g w_g f(x_g)`: quadrature over the faces of a surface, with shape functions and normals.
//!
//! Quadrilaterals have 3 x 3 Gauss points, triangles the seven points of Radon. Both rules have degree five, so that
//! integrals of `N_i r r^T` are exact on parallelograms and triangles with straight edges.

use crate::geometry::outline::{gauss_points, seven_points};
use crate::geometry::shape::{Shape, ShapeParameters};
use crate::geometry::surface::Surface;
use crate::scalar::clean;
use crate::scalar::vector::{Vector, add, cross, dot, hypot, scale, sub, unit};
use crate::types::CouplingError;

/// A quadrature point.
pub struct GaussPoint {
    /// Index of the face that the point lies on.
    pub face: usize,
    /// Shape functions `N_k` of the nodes of the face.
    pub functions: Vec<f64>,
    /// Coordinates of the point.
    pub at: Vector<f64>,
    /// The normal vector; its length is the quadrature weight, an area.
    pub normal: Vector<f64>,
}

impl GaussPoint {
    /// Quadrature weight, an area.
    pub fn weight(&self) -> f64 {
        hypot(self.normal)
    }
}

/// All quadrature points, face by face.
pub fn points(surface: &Surface<3>) -> Result<Vec<GaussPoint>, CouplingError> {
    surface.check_integrable()?;
    if surface.faces.iter().any(|face| face.shape.dimensions() != 2) {
        return Err(CouplingError::NoNormal);
    }
    Ok((0..surface.faces.len()).flat_map(|face| on_face(surface, face)).collect())
}

fn on_face(surface: &Surface<3>, face: usize) -> impl Iterator<Item = GaussPoint> + use<> {
    let (shape, places) = (surface.faces[face].shape, surface.places(face));
    rule(shape).into_iter().map(move |(xi, weight)| {
        let (functions, at, normal) = point(shape, &places, xi);
        GaussPoint { face, functions, at, normal: scale(weight, normal) }
    })
}

/// The shape functions `N_k`, the point x and the normal `dx/dxi x dx/deta` of a face at the parameters `xi`. Coordinates are relative to
/// the first node, so that a plane with constant z stays exact.
pub fn point(shape: Shape, places: &[Vector<f64>], xi: ShapeParameters) -> (Vec<f64>, Vector<f64>, Vector<f64>) {
    let n = shape.slopes(xi);
    let arms = || places.iter().map(|&x| sub(x, places[0]));
    let sum = |k: usize| arms().zip(&n).fold([0.0; 3], |sum, (arm, n)| add(sum, scale(n[k], arm)));
    (n.iter().map(|n| n[0]).collect(), add(places[0], sum(0)), cross(sum(1), sum(2)))
}

fn rule(shape: Shape) -> Vec<(ShapeParameters, f64)> {
    if shape.corners().len() == 3 {
        return seven_points().map(|(l, weight)| ([l[1], l[2], 0.0], weight / 2.0)).to_vec();
    }
    let line = gauss_points();
    line.iter().flat_map(|&(xi, a)| line.iter().map(move |&(eta, b)| ([xi, eta, 0.0], a * b))).collect()
}

/// The mean normal. An error if faces point against it.
pub fn mean_normal(points: &[GaussPoint]) -> Result<Vector<f64>, CouplingError> {
    let total = points.iter().fold([0.0; 3], |sum, gauss| add(sum, gauss.normal));
    let mut normal = unit(total).ok_or(CouplingError::NoNormal)?;
    clean(normal.iter_mut(), 1.0);
    let against = points.iter().any(|gauss| dot(gauss.normal, normal) <= 0.0);
    if against { Err(CouplingError::NoNormal) } else { Ok(normal) }
}

//! Cyclic symmetry: `u_b = R(alpha) u_a` for a node a and its image b in the next sector, at the sector angle alpha; for harmonic k,
//! `u_b = e^(i k alpha) R(alpha) u_a`.

use crate::geometry::node::{Node, field, rounding, separation, within};
use crate::geometry::sector_rotation::{Turn, sin_cos};
use crate::{Constraint, EquationSink};

/// How the F fields of a node change under rotation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Turning {
    /// Components of vectors, D per vector: displacements, and rotations in space. They rotate with the sector.
    Vectors,
    /// Scalars, which do not change: temperatures, pressures, rotations in the plane.
    Scalars,
}

/// Cyclic symmetry of harmonic 0: all sectors deform alike, `u_b = R(alpha) u_a` (vectors) or `u_b = u_a` (scalars).
///
#[doc = include_str!("../../../docs/pictures/cyclic.svg")]
///
#[doc = include_str!("../../../docs/types/cyclic.md")]
/// # Example
///
/// ```
/// use qless_constraints::{ConstraintSet, types::{Cyclic, Point, Turn, Turning}};
/// let a = Point::new([0, 1, 2], [1.0, 0.0, 0.0]);
/// let b = Point::new([3, 4, 5], [0.0, 1.0, 0.0]);
/// let turn = Turn::about([0.0; 3], [0.0, 0.0, 1.0], std::f64::consts::FRAC_PI_2)?;
/// let mut builder = ConstraintSet::builder(6);
/// builder.add("sector", Cyclic { a, b, turn, fields: Turning::Vectors, tolerance: 1e-9 })?;
/// let set = builder.build()?;
/// // A radial displacement of a corresponds to a radial displacement of b.
/// let mut evaluation = set.allocate();
/// set.evaluate(&[0.1, 0.0, 0.0, 0.0, 0.1, 0.0], &mut evaluation)?;
/// assert!(evaluation.c().iter().all(|c| c.abs() < 1e-16));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cyclic<const D: usize, const F: usize = D> {
    /// A node at one side of the sector.
    pub a: Node<D, F>,
    /// The image of node a, at the other side of the sector.
    pub b: Node<D, F>,
    /// Rotation from one sector to the next.
    pub turn: Turn<D>,
    /// Whether the fields are vectors, which rotate with the sector, or scalars.
    pub fields: Turning,
    /// Largest allowed distance between node b and the rotated node a, a length.
    pub tolerance: f64,
}

/// Cyclic symmetry of harmonic k: F equations for the real parts of the amplitudes, and F for the imaginary parts.
///
/// If the harmonic k is 0 or half the number of sectors, `e^(i k alpha)` is real for the sector angle alpha. Then no equation couples the
/// real and imaginary parts, and the real part suffices.
///
#[doc = include_str!("../../../docs/pictures/cyclic_harmonic.svg")]
///
#[doc = include_str!("../../../docs/types/cyclic_harmonic.md")]
/// # Example
///
/// ```
/// use qless_constraints::{ConstraintSet, types::{Cyclic, CyclicHarmonic, Node, Turn, Turning}};
/// // A pressure wave with two periods around the axis, in sectors of 60 degrees.
/// let turn = Turn::in_plane([0.0; 2], std::f64::consts::FRAC_PI_3);
/// let (a, b) = (Node::of_field(0, [2.0, 0.0]), Node::of_field(1, [1.0, 3.0_f64.sqrt()]));
/// let real = Cyclic { a, b, turn, fields: Turning::Scalars, tolerance: 1e-9 };
/// let mut builder = ConstraintSet::builder(4);
/// builder.add("sector", CyclicHarmonic { real, imaginary_a: [2], imaginary_b: [3], harmonic: 2 })?;
/// let g = builder.build()?.allocate().g().clone();
/// assert!(g.row(0).zip([(0, 0.5), (1, 1.0), (2, 0.75_f64.sqrt())]).all(|(a, b)| a.0 == b.0 && (a.1 - b.1).abs() < 1e-15));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CyclicHarmonic<const D: usize, const F: usize = D> {
    /// Both nodes, and the DOFs of the real parts.
    pub real: Cyclic<D, F>,
    /// DOFs of the imaginary parts at node a.
    pub imaginary_a: [usize; F],
    /// DOFs of the imaginary parts at its image b.
    pub imaginary_b: [usize; F],
    /// k, the number of waves around the circumference.
    pub harmonic: u32,
}

/// What can be wrong with cyclic symmetry.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CyclicError {
    /// The fields cannot be vectors: their number F is not a multiple of the dimension D.
    #[error("{fields} fields are not vectors of {dimensions} components each; tie vectors and scalars separately")]
    NoVectors {
        /// F, the number of fields.
        fields: usize,
        /// D, the number of dimensions.
        dimensions: usize,
    },
    /// The image is too far from the rotated node.
    #[error("the rotated node is {distance} away from its image, more than the tolerance {tolerance}")]
    NoImage {
        /// Distance from the rotated node to the image.
        distance: f64,
        /// Largest allowed distance.
        tolerance: f64,
    },
}

impl<const D: usize, const F: usize> Cyclic<D, F> {
    fn check(&self) -> Result<(), CyclicError> {
        if self.fields == Turning::Vectors && !F.is_multiple_of(D) {
            return Err(CyclicError::NoVectors { fields: F, dimensions: D });
        }
        let image = self.turn.image(self.a.at);
        let distance = separation(&image, &self.b.at);
        if within(distance - rounding(&[image], &self.a.at), self.tolerance) {
            Ok(())
        } else {
            Err(CyclicError::NoImage { distance, tolerance: self.tolerance })
        }
    }

    /// Terms of `-factor (R u)_k`, where u are the values of `dofs`. R rotates vectors to the next sector; for scalars it is the identity.
    fn turned(&self, k: usize, factor: f64, dofs: &[usize; F]) -> Vec<(usize, f64)> {
        let terms: Vec<_> = match self.fields {
            Turning::Scalars => vec![(dofs[k], -factor)],
            Turning::Vectors => {
                let row = self.turn.rotation[k % D].iter().enumerate();
                row.map(|(j, r)| (dofs[k / D * D + j], -factor * r)).collect()
            }
        };
        terms.into_iter().filter(|&(_, v)| v != 0.0).collect()
    }
}

impl<const D: usize, const F: usize> Constraint for Cyclic<D, F> {
    const NAME: &'static str = "cyclic symmetry";
    type Error = CyclicError;

    fn emit(self, sink: &mut EquationSink) -> Result<(), CyclicError> {
        self.check()?;
        for k in 0..F {
            let terms = self.turned(k, 1.0, &self.a.dofs).into_iter().chain([(self.b.dofs[k], 1.0)]);
            sink.equation(field::<D, F>(k), terms, 0.0);
        }
        Ok(())
    }
}

impl<const D: usize, const F: usize> Constraint for CyclicHarmonic<D, F> {
    const NAME: &'static str = "cyclic symmetry of a harmonic";
    type Error = CyclicError;

    fn emit(self, sink: &mut EquationSink) -> Result<(), CyclicError> {
        let (pair, real, imaginary) = (self.real, self.real.a.dofs, self.imaginary_a);
        pair.check()?;
        let (sin, cos) = sin_cos(f64::from(self.harmonic) * pair.turn.angle);
        for k in 0..F {
            for (part, [of_real, of_imaginary], image) in
                [("real", [cos, -sin], pair.b.dofs[k]), ("imaginary", [sin, cos], self.imaginary_b[k])]
            {
                let terms = [pair.turned(k, of_real, &real), pair.turned(k, of_imaginary, &imaginary)].concat();
                let name = format!("{part} {}", field::<D, F>(k)).trim_end().to_owned();
                sink.equation(name, terms.into_iter().chain([(image, 1.0)]), 0.0);
            }
        }
        Ok(())
    }
}

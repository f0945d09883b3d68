//! `u_b = R(alpha) u_a`: a node and its image one sector further; for harmonic k, `u_b = e^(i k alpha) R(alpha) u_a`.

use crate::geometry::node::{AXES, Point, separation, within};
use crate::geometry::rotation::by_vector;
use crate::scalar::vector::{Vector, add, scale, sub, unit};
use crate::{Constraint, Store};

/// Cyclic symmetry, harmonic 0: all sectors move alike.
///
#[doc = include_str!("../../docs/pictures/cyclic.svg")]
///
#[doc = include_str!("../../docs/types/cyclic.md")]
/// # Example
///
/// ```
/// use qless_constraints::{ConstraintSet, types::{Cyclic, Point}};
/// let a = Point::new([0, 1, 2], [1.0, 0.0, 0.0]);
/// let b = Point::new([3, 4, 5], [0.0, 1.0, 0.0]);
/// let quarter = std::f64::consts::FRAC_PI_2;
/// let pair = Cyclic { a, b, centre: [0.0; 3], axis: [0.0, 0.0, 1.0], angle: quarter, tolerance: 1e-9 };
/// let mut builder = ConstraintSet::builder(6);
/// builder.add("sector", pair)?;
/// let set = builder.build()?;
/// // Outwards at a is outwards at b.
/// let mut quantities = set.allocate();
/// set.evaluate(&[0.1, 0.0, 0.0, 0.0, 0.1, 0.0], &mut quantities)?;
/// assert!(quantities.c().iter().all(|c| c.abs() < 1e-16));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cyclic {
    /// The node.
    pub a: Point,
    /// Its image.
    pub b: Point,
    /// A point of the axis, coordinates.
    pub centre: Vector<f64>,
    /// The direction of the axis, of any length.
    pub axis: Vector<f64>,
    /// alpha, in radians.
    pub angle: f64,
    /// Farthest that the image may be from where the turn brings the node, a length.
    pub tolerance: f64,
}

/// Cyclic symmetry of a harmonic: real and imaginary parts of the amplitude, six equations.
///
/// `u_b' = R (cos(k alpha) u_a' - sin(k alpha) u_a'')`, `u_b'' = R (sin(k alpha) u_a' + cos(k alpha) u_a'')`.
///
#[doc = include_str!("../../docs/pictures/cyclic_harmonic.svg")]
///
#[doc = include_str!("../../docs/types/cyclic_harmonic.md")]
/// # Example
///
/// ```
/// use qless_constraints::{ConstraintSet, types::{Cyclic, CyclicHarmonic, Point}};
/// let a = Point::new([0, 1, 2], [1.0, 0.0, 0.0]);
/// let b = Point::new([3, 4, 5], [0.0, 1.0, 0.0]);
/// let quarter = std::f64::consts::FRAC_PI_2;
/// let real = Cyclic { a, b, centre: [0.0; 3], axis: [0.0, 0.0, 1.0], angle: quarter, tolerance: 1e-9 };
/// let mut builder = ConstraintSet::builder(12);
/// builder.add("sector", CyclicHarmonic { real, imaginary_a: [6, 7, 8], imaginary_b: [9, 10, 11], harmonic: 1 })?;
/// assert_eq!(builder.build()?.equations(), 6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CyclicHarmonic {
    /// Geometry, and the DOFs of the real parts.
    pub real: Cyclic,
    /// DOFs of the imaginary part at the node.
    pub imaginary_a: [usize; 3],
    /// DOFs of the imaginary part at its image.
    pub imaginary_b: [usize; 3],
    /// k, the number of waves around the circumference.
    pub harmonic: u32,
}

/// What can be wrong with cyclic symmetry.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CyclicError {
    /// The axis has no direction.
    #[error("the axis has no direction; give a vector that is not zero")]
    Axis,
    /// The image is not where the turn brings the node.
    #[error("the turned node is {distance} away from its image, more than the tolerance {tolerance}")]
    NoImage {
        /// How far.
        distance: f64,
        /// How far it may be.
        tolerance: f64,
    },
}

impl Cyclic {
    /// R, row by row, after the check.
    fn rotation(&self) -> Result<[Vector<f64>; 3], CyclicError> {
        let axis = unit(self.axis).ok_or(CyclicError::Axis)?;
        let turn = |s| by_vector(scale(self.angle, axis), s);
        let image = add(self.centre, turn(sub(self.a.at, self.centre)));
        let distance = separation(&image, &self.b.at);
        if !within(distance, self.tolerance) {
            return Err(CyclicError::NoImage { distance, tolerance: self.tolerance });
        }
        let columns = [turn([1.0, 0.0, 0.0]), turn([0.0, 1.0, 0.0]), turn([0.0, 0.0, 1.0])];
        Ok(std::array::from_fn(|i| std::array::from_fn(|j| columns[j][i])))
    }
}

/// `-f R_i u`.
fn turned(row: Vector<f64>, factor: f64, dofs: [usize; 3]) -> impl Iterator<Item = (usize, f64)> {
    (0..3).map(move |k| (dofs[k], -factor * row[k])).filter(|&(_, v)| v != 0.0)
}

impl Constraint for Cyclic {
    const NAME: &'static str = "cyclic symmetry";
    type Error = CyclicError;

    fn process(self, store: &mut Store) -> Result<(), CyclicError> {
        for (axis, row) in self.rotation()?.into_iter().enumerate() {
            store.equation(AXES[axis], turned(row, 1.0, self.a.dofs).chain([(self.b.dofs[axis], 1.0)]), 0.0);
        }
        Ok(())
    }
}

impl Constraint for CyclicHarmonic {
    const NAME: &'static str = "cyclic symmetry of a harmonic";
    type Error = CyclicError;

    fn process(self, store: &mut Store) -> Result<(), CyclicError> {
        let (sin, cos) = (f64::from(self.harmonic) * self.real.angle).sin_cos();
        let (real, imaginary) = (self.real.a.dofs, self.imaginary_a);
        for (axis, row) in self.real.rotation()?.into_iter().enumerate() {
            let first = turned(row, cos, real).chain(turned(row, -sin, imaginary));
            store.equation(format!("real {}", AXES[axis]), first.chain([(self.real.b.dofs[axis], 1.0)]), 0.0);
            let second = turned(row, sin, real).chain(turned(row, cos, imaginary));
            store.equation(format!("imaginary {}", AXES[axis]), second.chain([(self.imaginary_b[axis], 1.0)]), 0.0);
        }
        Ok(())
    }
}

//! Rotation vectors of up to eight bodies at once, with SIMD instructions.
//!
//! The roughly 150 operations for one rotation vector depend on each other; those for eight bodies run in parallel.

#![expect(clippy::inline_always, reason = "only inlined code uses the wide instructions of its caller")]

use std::ops::{Add, Mul, Neg, Sub};

use pulp::{Arch, Simd, WithSimd};

use super::rodrigues::{closed, from_highest, highest};
use super::rotation::RotationKind;
use super::rotation_derivatives::{Phi, slopes_by_vector};
use crate::scalar::vector::{Vector, dot};

/// Numbers per lane vector.
pub const LANES: usize = 8;

/// One number for each of eight constraints.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Lanes(pub [f64; LANES]);

impl From<f64> for Lanes {
    #[inline(always)]
    fn from(x: f64) -> Self {
        Self([x; LANES])
    }
}

macro_rules! lane_by_lane {
    ($operator:ident, $function:ident, $assign:tt) => {
        impl $operator for Lanes {
            type Output = Self;
            #[inline(always)]
            fn $function(mut self, other: Self) -> Self {
                (0..LANES).for_each(|k| self.0[k] $assign other.0[k]);
                self
            }
        }
    };
}

lane_by_lane!(Add, add, +=);
lane_by_lane!(Sub, sub, -=);
lane_by_lane!(Mul, mul, *=);

impl Neg for Lanes {
    type Output = Self;
    #[inline(always)]
    fn neg(mut self) -> Self {
        (0..LANES).for_each(|k| self.0[k] = -self.0[k]);
        self
    }
}

/// [`factors`](super::rodrigues::factors) of eight numbers; each result is independent of the other lanes.
#[inline(always)]
pub fn factors_in_lanes(y: Lanes) -> [[Lanes; 3]; 2] {
    let mut all = from_highest(y, highest::<12, _>(y));
    for (lane, &y) in y.0.iter().enumerate().filter(|&(_, &y)| y >= 4.0) {
        let of_lane = closed(y);
        (0..6).for_each(|k| all[k / 3][k % 3].0[lane] = of_lane[k / 3][k % 3]);
    }
    all
}

/// Rotation vectors of up to eight bodies and the arms that they rotate; zero for bodies without a rotation vector.
#[derive(Default)]
pub struct RotationVectorLanes {
    theta: Vector<Lanes>,
    arm: Vector<Lanes>,
    any: bool,
}

/// `R s` and `d(R s)` of each body, as returned by [`super::rotation_derivatives::slopes`].
#[derive(Default)]
pub struct RotatedArmLanes((Vector<Lanes>, [Vector<Lanes>; 3]));

impl RotatedArmLanes {
    /// Result of one body.
    #[inline]
    pub fn lane(&self, lane: usize) -> (Vector<f64>, [[f64; 4]; 3]) {
        let (turned, rows) = &self.0;
        let of_row = |i: usize| [rows[i][0].0[lane], rows[i][1].0[lane], rows[i][2].0[lane], 0.0];
        (std::array::from_fn(|i| turned[i].0[lane]), std::array::from_fn(of_row))
    }
}

impl RotationVectorLanes {
    /// Stores the rotation and the arm of one body; `u` are its DOFs.
    #[inline]
    pub fn set(&mut self, lane: usize, (kind, arm): (RotationKind, Vector<f64>), u: &[f64]) {
        if kind == RotationKind::Vector {
            (0..3).for_each(|k| (self.theta[k].0[lane], self.arm[k].0[lane]) = (u[3 + k], arm[k]));
            self.any = true;
        }
    }

    /// `R s` and its slopes for all bodies.
    #[inline]
    pub fn slopes(&self, out: &mut RotatedArmLanes) {
        if self.any {
            Arch::new().dispatch(SlopesOfLanes { theta: &self.theta, arm: &self.arm, out: &mut out.0 });
        }
    }

    /// Hessian of `m . (R s)` for all bodies, each with its own `m`.
    #[inline]
    pub fn hessians(&self, m: &Vector<Lanes>, out: &mut [Lanes; 6]) {
        if self.any {
            Arch::new().dispatch(HessianOfLanes { theta: &self.theta, arm: &self.arm, m, out });
        }
    }
}

struct SlopesOfLanes<'a> {
    theta: &'a Vector<Lanes>,
    arm: &'a Vector<Lanes>,
    out: &'a mut (Vector<Lanes>, [Vector<Lanes>; 3]),
}

impl WithSimd for SlopesOfLanes<'_> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let theta = *self.theta;
        *self.out = slopes_by_vector(theta, *self.arm, factors_in_lanes(dot(theta, theta)));
    }
}

struct HessianOfLanes<'a> {
    theta: &'a Vector<Lanes>,
    arm: &'a Vector<Lanes>,
    m: &'a Vector<Lanes>,
    out: &'a mut [Lanes; 6],
}

impl WithSimd for HessianOfLanes<'_> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let theta = *self.theta;
        *self.out = Phi::new(theta, *self.arm, *self.m, factors_in_lanes(dot(theta, theta))).hessian();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::rodrigues::factors;
    use crate::geometry::rodrigues::tests::assert_same;

    /// Each lane gives the same bits regardless of the other lanes.
    #[test]
    fn lanes_are_those_of_one_number() {
        let y = [0.0, 1e-9, 0.04, 0.06, 1.0, 3.999, 4.0, 30.0];
        let all = factors_in_lanes(Lanes(y));
        for (lane, &y) in y.iter().enumerate() {
            assert_same(all.map(|of| of.map(|x| x.0[lane])), factors(y), 4e-15, y);
            let alone = factors_in_lanes(Lanes::from(y));
            assert_eq!(all.map(|of| of.map(|x| x.0[lane])), alone.map(|of| of.map(|x| x.0[0])), "y = {y}");
        }
    }
}

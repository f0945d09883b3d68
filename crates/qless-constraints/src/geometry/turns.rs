//! The turned arms of up to eight bodies at once, in the widest instructions that the processor has.
//!
//! One rotation vector after the other, its some 150 operations wait for one another; those of eight bodies do not.

#![expect(clippy::inline_always, reason = "in functions with wider instructions nothing else gets them")]

use pulp::{Arch, Simd, WithSimd};

use super::carrier::{Carrier, Kind};
use super::factors::factors_of_lanes;
use super::lanes::Lanes;
use super::turned::{Phi, slopes_by_vector};
use crate::scalar::vector::{Vector, dot};

/// The rotation vectors of up to eight bodies, and the arms that they turn; zeros where a body has none.
#[derive(Default)]
pub struct Vectors {
    theta: Vector<Lanes>,
    arm: Vector<Lanes>,
    any: bool,
}

/// `R s` and `d(R s)` of each, as [`super::turned::slopes`] has them.
#[derive(Default)]
pub struct Turns((Vector<Lanes>, [Vector<Lanes>; 3]));

impl Turns {
    /// That of one body.
    #[inline]
    pub fn of(&self, lane: usize) -> (Vector<f64>, [[f64; 4]; 3]) {
        let (turned, rows) = &self.0;
        let of_row = |i: usize| [rows[i][0].0[lane], rows[i][1].0[lane], rows[i][2].0[lane], 0.0];
        (std::array::from_fn(|i| turned[i].0[lane]), std::array::from_fn(of_row))
    }
}

impl Vectors {
    /// That of one more body with the DOFs u.
    #[inline]
    pub fn set(&mut self, lane: usize, carrier: &Carrier, u: &[f64]) {
        if carrier.kind == Kind::Vector {
            (0..3).for_each(|k| (self.theta[k].0[lane], self.arm[k].0[lane]) = (u[3 + k], carrier.arm[k]));
            self.any = true;
        }
    }

    /// `R s` and its slopes.
    #[inline]
    pub fn slopes(&self, out: &mut Turns) {
        if self.any {
            Arch::new().dispatch(SlopesOfLanes { theta: &self.theta, arm: &self.arm, out: &mut out.0 });
        }
    }

    /// The Hessian of `m . (R s)` of each with its `m`.
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
        *self.out = slopes_by_vector(theta, *self.arm, factors_of_lanes(dot(theta, theta)));
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
        *self.out = Phi::new(theta, *self.arm, *self.m, factors_of_lanes(dot(theta, theta))).hessian();
    }
}

//! Settings and results of Newton's method.

use qless::Options;

/// Settings of [`solve`](super::solve).
#[derive(Clone, Debug)]
pub struct NewtonOptions {
    /// Largest `|c_r|` of a solution, in multiples of the bound on its rounding
    /// ([`ConstraintSet::rounding`](qless_constraints::ConstraintSet::rounding)). Default 4, at least 1.
    ///
    /// If c no longer falls, a row may instead be compared with the rounding of the largest terms of its connected part, with the weights
    /// of [`NewtonIterate::residual`]. This holds only for a row that demands a negligible motion, `|c_r| <= 1e-11 sum_j |G_rj| s_j`, where
    /// `s_j` is the largest of `|u_j|`, the coordinates that DOF j displaces and, in rotation vectors, one radian.
    pub tolerance: f64,
    /// Largest number of steps of a part. Default 50.
    pub steps: usize,
    /// How the linearised equations are analysed.
    pub analysis: Options,
}

impl Default for NewtonOptions {
    fn default() -> Self {
        Self { tolerance: 4.0, steps: 50, analysis: Options::default() }
    }
}

/// One iterate, before its step.
#[derive(Clone, Debug, PartialEq)]
pub struct NewtonIterate {
    /// `max_r D_r |c_r| / max_r D_r size_r`, where size_r is that of the terms of c_r and the weights D make equations comparable. It is
    /// the same in all units; the largest of all connected parts counts.
    pub residual: f64,
    /// Rank of the constraint Jacobian G.
    pub rank: usize,
    /// Equations that the step ignores.
    pub ignored: Vec<usize>,
    /// Step length that led to this iterate, relative to du: the smallest of the connected parts that moved; 1 for a full step and for the
    /// first iterate.
    pub length: f64,
}

/// A configuration that satisfies all constraints.
#[derive(Clone, Debug)]
pub struct NewtonSolution {
    /// Values of the DOFs.
    pub u: Vec<f64>,
    /// All iterates; the last one is the solution.
    pub iterates: Vec<NewtonIterate>,
    /// Equations that are redundant at the solution.
    pub redundant: Vec<usize>,
}

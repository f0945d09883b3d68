//! Settings of Newton's method, and what it returns.

use qless::Options;

/// Settings of [`solve`](super::solve).
#[derive(Clone, Debug)]
pub struct NewtonOptions {
    /// Done when each `|c_r|` is at most so many times the bound on its rounding ([`ConstraintSet::rounding`](qless_constraints::ConstraintSet::rounding)). Default 4, at least 1.
    ///
    /// Where c no longer falls, that of the largest terms of its connected part counts, with the weights of [`NewtonIterate::residual`], for rows that ask for no
    /// motion that matters: `|c_r| <= 1e-11 sum_j |G_rj| s_j` with the coordinates `s_j` that the DOFs add to, or `|u_j|`, or one radian.
    pub tolerance: f64,
    /// Most steps of any part; all go in lock step. Default 50.
    pub steps: usize,
    /// How the linearised equations are analysed.
    pub analysis: Options,
}

impl Default for NewtonOptions {
    fn default() -> Self {
        Self { tolerance: 4.0, steps: 50, analysis: Options::default() }
    }
}

/// One iterate: what was found before its step was made.
#[derive(Clone, Debug, PartialEq)]
pub struct NewtonIterate {
    /// `max_r D_r |c_r| / max_r D_r size_r`: relative to the largest terms that went into any c, with weights D that make equations
    /// comparable; the same in all units. The largest of all connected parts.
    pub residual: f64,
    /// Rank of G.
    pub rank: usize,
    /// Equations left out of the step.
    pub left_out: Vec<usize>,
    /// How much of `du` was gone to come here: the least of the connected parts that were still on their way; 1 for a full step and for the
    /// first iterate.
    pub length: f64,
}

/// A configuration that satisfies all constraints.
#[derive(Clone, Debug)]
pub struct NewtonSolution {
    /// The DOFs.
    pub u: Vec<f64>,
    /// The way there; the last one is the solution.
    pub iterates: Vec<NewtonIterate>,
    /// Equations that are redundant at the solution.
    pub redundant: Vec<usize>,
}

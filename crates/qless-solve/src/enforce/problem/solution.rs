//! What comes out of a solve, and what it is worth.

/// Displacements, multipliers and forces.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// All DOFs.
    pub u: Vec<f64>,
    /// lambda, one per original equation, of `K u + C^T lambda = f`; redundant equations ([`super::Problem::redundant`]) have zero.
    pub multipliers: Vec<f64>,
    /// `-C^T lambda`: what the constraints exert on each DOF.
    pub forces: Vec<f64>,
    /// `(DOF, K u + C^T lambda - f)` for each prescribed DOF: what holds it.
    pub reactions: Vec<(usize, f64)>,
    /// The share of u, in its largest number per connected part, that may be wrong: what rounding of K and C does to it, and what
    /// penalties leave; if that is more, the share of what loads would do to the stiffness they act on.
    /// Translations and rotations are compared in units of energy; DOFs of a part of K without a number on its diagonal, which has no
    /// such units, each by itself, and by the terms of its equations where it is zero. An estimate: as a rule too large, seldom several times too small.
    pub accuracy: f64,
    /// The largest imbalance, relative to its terms, of a row of the equations that were solved: `K u + C^T lambda = f`, and `C u = b` of
    /// equations by multipliers. What springs leave of theirs, `C u - b = lambda / D`, is balanced by lambda and part of `accuracy`.
    pub imbalance: f64,
}

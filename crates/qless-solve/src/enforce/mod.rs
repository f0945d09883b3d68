//! Linear constraints on a stiffness model: `K u + C^T lambda = f` with `C u = b` (Eq. 1, 2, 10).
//!
//! | method | equations that are solved | error that it leaves |
//! | --- | --- | --- |
//! | transformation | `T^T K T q = T^T (f - K u_0)` (Eq. 7-9) | rounding |
//! | Lagrange | `[K C^T; C 0] [u; lambda] = [f; b]` (Eq. 10), scaled by powers of two | rounding |
//! | penalty | `(K + C^T D C) u = f + C^T D b`, `D` scaled from K (Eq. 11) | `C u - b = lambda / D`, at most the accuracy, or an error |
//! | augmented Lagrange | the limit of `lambda += D (C u - b)`: C u = b | the requested tolerance |
//! | mixed | any of these, equation by equation ([`Problem::enforce`]) | that of each method |
//!
//! One pipeline serves all methods: scale, factor, refine, estimate the condition. Every equation is first enforced exactly, and penalties
//! are corrections of the exact solution. A spring may thus be arbitrarily stiff, and its error of u is known.
//!
//! Connected parts of K and C are solved one by one, each in its own scale. The result of a part does not depend on other parts, to the
//! last bit.
//!
//! Only independent equations are enforced: a redundant equation would make Lagrange's matrix singular and would have no slave. K need not
//! be symmetric or definite, and may be singular without the constraints. Prescribed DOFs keep their values.
//!
//! # What is checked
//!
//! After every solve the residuals of `K u + C^T lambda = f` and `C u = b` are compared with the sizes of their terms, row by row, and the
//! solution is refined. `|K u + C^T lambda - f|_i` is at most 1e-10 of the terms of row i; otherwise the solution is refused
//! ([`EnforceError::OutOfBalance`]). If the terms of a row are far smaller than those of its connected part, the residual is compared with
//! a thousandth of the largest terms, in units in which all unknowns are square roots of energy. For constraint equations without a
//! penalty, it is compared with the rounding of the largest terms instead. If multipliers do not satisfy an equation to this tolerance,
//! elimination is tried before the solution is refused.
//!
//! Rounding of K changes u by a fraction of about `eps g`, where g is the condition number of Skeel and Bauer, estimated in every solve.
//! [`Solution::accuracy`] states this fraction, or the effect of rounding on this particular solution if that is larger. If only rounding
//! resists a motion, as with a stiffness of `0.1 + 0.2 - 0.3`, the model is refused and the motion is named
//! ([`EnforceError::Unsupported`]).
//!
//! Redundant equations are left out. If the analysis is not sure that an equation is redundant, u must satisfy it as well, to 1e-9 of its
//! terms and those of the equations that it depends on ([`EnforceError::Doubtful`]).

mod accuracy;
mod equations;
mod error;
mod matrix;
mod methods;
mod part;
mod problem;
mod reduced;
mod saddle;
mod scale;
mod singularity;
mod solve;
mod solver;
mod steps;
mod stiffness;
mod transform_noise;

pub use error::{EnforceError, FreeMotion};
pub use methods::BlockPlan;
pub use problem::{Method, Problem, Solution};
pub use reduced::reduced;
pub use solver::{Cholesky, Ldlt, Llt, Lu, Solver, SolverError, SolverMatrix};
pub use steps::Steps;
pub use stiffness::Stiffness;

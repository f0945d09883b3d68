//! `K u + C^T lambda = f` with `C u = b` (Eq. 1, 2, 10): the constraints on the stiffness equations of a model.
//!
//! | method | equations that are solved | what it leaves |
//! | --- | --- | --- |
//! | transformation | `T^T K T q = T^T (f - K u_0)`, `u = T q + u_0` (Eq. 6-9) | rounding |
//! | Lagrange | `[K C^T; C 0] [u; lambda] = [f; b]` (Eq. 10), scaled by powers of two | rounding |
//! | penalty | `(K + C^T D C) u = f + C^T D b`, `D` scaled from K (Eq. 11) | `C u - b = lambda / D`: at most the accuracy asked for, or refused |
//! | augmented Lagrange | penalty, and `lambda += D (C u - b)` until C u = b | the tolerance asked for |
//! | mixed | any of these, equation by equation ([`Problem::enforce`]) | as each of them |
//!
//! Springs that are too stiff to leave K digits, or too soft to be told from no support, are not guessed about: the part gets multipliers, which give
//! the exact solution, and a penalty is solved from that, `[K C^T; C -1/D]`. It is the same solution, at the cost of one more factorization.
//!
//! Parts that neither K nor C connects are solved one by one, in numbers of their own: what is found of one does not depend on another, to
//! the last bit.
//!
//! Only independent equations are enforced; without that Lagrange's matrix is singular, and no slave exists for some row.
//! K need not be symmetric, definite, nor regular without the constraints. Prescribed DOFs keep their values.
//!
//! # What is checked
//!
//! After every solve both equations are held against their terms, row by row, and refined: `|K u + C^T lambda - f|_i` is at most
//! 1e-10 of the terms of row i, or the solution is refused ([`EnforceError::OutOfBalance`]). A row whose terms are far smaller than
//! those of its connected part is measured against a thousandth of the largest, in units in which all numbers are square roots of energy.
//! MeasuredEquations are held against their own terms, unless those are rounding of the largest; but for penalties. What multipliers do not meet so
//! is solved by elimination, or refused.
//!
//! SolutionRounding of K moves u by a share of some `eps g`, where g is the condition number of Skeel and Bauer, estimated in every solve;
//! [`Solution::accuracy`] states it, or what rounding of this very solution leaves of u, if that is more. Where a motion is
//! held by no more than rounding, the model is refused and the motion named ([`EnforceError::Unsupported`]): also where `0.1 + 0.2 - 0.3` looks like a stiffness.
//!
//! An equation that follows from others is left out. Where it is in doubt whether it does, u has to meet it too, to 1e-9 of its terms and
//! those of the others ([`EnforceError::Doubtful`]).

mod condensation;
mod error;
mod matrix;
mod methods;
mod part;
mod problem;
mod reduced;
mod refinement;
mod saddle;
mod singularity;
mod solve;
mod solver;
mod steps;
mod stiffness;
mod units;

pub use error::EnforceError;
pub use error::FreeMotion;
pub use methods::BlockPlan;
pub use problem::Method;
pub use problem::Problem;
pub use problem::Solution;
pub use reduced::reduced;
pub use solver::Ldlt;
pub use solver::Llt;
pub use solver::Lu;
pub use solver::Solver;
pub use solver::SolverError;
pub use solver::SolverMatrix;
pub use steps::Steps;
pub use stiffness::Stiffness;

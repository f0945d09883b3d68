//! Constraints `C u = b` that a finite-element solver can trust.
//!
//! The input is m linear equations on n DOFs, some of which are prescribed. [`analyse`] finds which equations are redundant or
//! conflicting, and why. [`Analysis::reduction`] chooses slaves and computes `u_s = T u_q + G u_p + g` (Eq. 23-26), as numbers or as
//! factors. Equation and section numbers are those of the paper on over-constraints by Q-less sparse QR (Appl. Sci. 15 (2025) 13059).
//!
//! The stages: [`ConstraintSystem`] (validated input), scaling by powers of two, presolve (equations that need no factorization), blocks,
//! a [`backend::Backend`] per block, checks of the rank, classification with certificates ([`Analysis`]), and the [`Reduction`] on request.
//!
//! ```
//! use qless::{Kind, Options, SystemBuilder, analyse};
//! // Equations (12) to (14): the third is the sum of the others.
//! let mut builder = SystemBuilder::new(3);
//! builder.equation([(0, 1.0), (1, -1.0), (2, 2.0)], 1.0);
//! builder.equation([(0, 1.0), (1, 2.0), (2, -1.0)], 0.0);
//! builder.equation([(0, 2.0), (1, 1.0), (2, 1.0)], 1.0);
//! let system = builder.build()?;
//! let analysis = analyse(&system, &Options::default())?;
//! assert_eq!((analysis.rank(), analysis.kinds()[2]), (2, Kind::Redundant));
//! // (17) and (18): u1 = -u3 + 2/3, u2 = u3 - 1/3.
//! let reduction = analysis.reduction()?;
//! assert_eq!((reduction.slaves(), reduction.masters()), ([0, 1].as_slice(), [2].as_slice()));
//! assert!((reduction.g()[0] - 2.0 / 3.0).abs() < 1e-15);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod change;
pub mod common;
pub mod diagnosis;
pub mod elimination;
pub mod explanation;
mod factor;
mod input;
mod options;
mod presolve;
pub mod reduction;
pub mod report;

pub use change::ChangingSystem;
pub use common::argument::ArgumentError;
pub use diagnosis::certificate::CertificateTerm;
pub use diagnosis::classify::{Dependent, Kind};
pub use diagnosis::confidence::{Confidence, Doubt};
pub use diagnosis::exact;
pub use diagnosis::{Analysis, AnalysisError, NearDependence, analyse};
pub use elimination::Elimination;
pub use factor::backend;
pub use input::noise::Noise;
pub use input::preferences::{OptionError, Preferences};
pub use input::system::{ConstraintSystem, Csr, Place, SystemBuilder, SystemError};
pub use options::{BackendChoice, Effort, Options, Tolerance};
pub use reduction::{Form, Reduction, ReductionError};
pub use report::{Report, Status};

/// The examples of the README, as tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

//! What a caller can choose, with its default.

use crate::factor::backend::{Backend, BackendError};
use crate::input::noise::Noise;
use crate::input::preferences::{OptionError, Preferences};

/// How small is zero.
///
/// In words: an equation counts as a combination of others when what remains of it, after the others are subtracted, is at most
/// `tolerance` of the parts of every coefficient (presolve), or in 2-norm of the equation in balanced units (backend). A dependent
/// equation conflicts when its right-hand sides disagree by more than `tolerance` of the largest part.
///
/// As a formula, row k is dependent iff for some y `|c_kj - sum_i y_i c_ij| <= tolerance max_i |y_i c_ij|` for all free DOFs j, and
/// then conflicting iff `|b_k - sum_i y_i b_i| > tolerance max(|b_k|, max_i |y_i b_i|)`, prescribed DOFs being moved into b.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Tolerance {
    /// Relative, as above; the default is 1e-10.
    Relative(f64),
    /// The paper's rule (section 3.2): no scaling, absolute 1e-5. It changes its answer with the units.
    Paper,
}

impl Tolerance {
    pub(crate) fn value(self) -> f64 {
        match self {
            Self::Relative(value) => value,
            Self::Paper => 1e-5,
        }
    }

    /// Whether it counts in the units of the equations.
    pub(crate) fn is_absolute(self) -> bool {
        self == Self::Paper
    }
}

/// Which rank-revealing factorization works on what presolve leaves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum BackendChoice {
    /// Pure Rust, on the kernels of faer: dense QR with column pivoting for small blocks, multifrontal sparse QR for large ones.
    #[default]
    Faer,
    /// Pure Rust: multifrontal sparse QR for every block.
    Sparse,
    /// SuiteSparseQR; needs the cargo feature `spqr` (GPL-2.0-or-later).
    Spqr,
    /// The paper's block-wise Gauss elimination (section 3.1).
    Gauss,
}

impl BackendChoice {
    /// The backend itself, which may allocate `memory` bytes for a block where it can tell before ([`Options::memory`]).
    ///
    /// # Errors
    /// [`BackendError::NotCompiledIn`] for `Spqr` without the feature.
    pub fn get(self, memory: usize) -> Result<Box<dyn Backend>, BackendError> {
        match self {
            Self::Faer => Ok(Box::new(crate::factor::backend::dense_or_sparse::DenseOrSparse::new(memory))),
            Self::Sparse => Ok(Box::new(crate::factor::backend::sparse::Sparse { memory })),
            Self::Gauss => Ok(Box::new(crate::factor::backend::gauss::Gauss { memory })),
            #[cfg(feature = "spqr")]
            Self::Spqr => {
                let spqr = crate::factor::backend::spqr::Spqr::on(0);
                Ok(Box::new(crate::factor::backend::spqr::Spqr { memory, ..spqr }))
            }
            #[cfg(not(feature = "spqr"))]
            Self::Spqr => Err(BackendError::NotCompiledIn { backend: "spqr" }),
        }
    }
}

/// Settings of [`crate::analyse`].
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Which backend factors the blocks that presolve leaves. Default: `Faer`.
    pub backend: BackendChoice,
    /// How small is zero. Default: relative 1e-10.
    pub tolerance: Tolerance,
    /// Which numbers may be rounding of others. Default: `Auto`.
    pub noise: Noise,
    /// Whether equations that need no factorization are taken out first. Default: true.
    pub presolve: bool,
    /// Whether what presolve and the backend keep is checked for near dependence, and chosen anew where it is not sound. Default:
    /// true. Without, the rank can be wrong and nothing says so: [`crate::Confidence::distance`] is then 1 unseen.
    pub check: bool,
    /// Slaves and masters are exchanged until `max |T_ij|` is at most this. At least 1, which is met to 1e-9; default 4.
    /// The nearer to 1, the more exchanges.
    pub growth: f64,
    /// Bytes that the factorization of one block may allocate. More is refused: before the work by `faer`, `sparse` and `spqr`, as
    /// soon as rows have filled in beyond it by `gauss`. Default: 16 GiB.
    pub memory: usize,
    /// DOFs that should or should not be slaves, equations to keep. Default: none.
    pub preferences: Preferences,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            backend: BackendChoice::Faer,
            tolerance: Tolerance::Relative(1e-10),
            noise: Noise::Auto,
            presolve: true,
            check: true,
            growth: 4.0,
            memory: 16 << 30,
            preferences: Preferences::default(),
        }
    }
}

impl Options {
    /// Checks every range but those of the preferences, which depend on the system.
    ///
    /// # Errors
    /// [`OptionError`].
    pub fn validate(&self) -> Result<(), OptionError> {
        match self.tolerance {
            Tolerance::Relative(value) if !(value > 0.0 && value < 1.0) => Err(OptionError::Tolerance(value)),
            _ if !(self.growth >= 1.0 && self.growth.is_finite()) => Err(OptionError::Growth(self.growth)),
            _ => Ok(()),
        }
    }
}

//! Options of an analysis, with their defaults.

use crate::factor::backend::{Backend, BackendError};
use crate::input::noise::Noise;
use crate::input::preferences::{OptionError, Preferences};
use crate::input::reading::Reading;

/// The size below which a remainder counts as zero.
///
/// In words: an equation is a combination of others if at most the fraction `tolerance` remains after the others are subtracted. Presolve
/// measures each coefficient relative to its largest term; a backend measures the 2-norm of the equation in balanced units. A dependent
/// equation conflicts if its right-hand side differs from the same combination of the others by more than `tolerance` of the largest term.
///
/// As a formula: row k is dependent if there is a y with `|c_kj - sum_i y_i c_ij| <= tolerance max_i |y_i c_ij|` for all free DOFs j. It
/// then conflicts if `|b_k - sum_i y_i b_i| > tolerance max(|b_k|, max_i |y_i b_i|)`. Prescribed DOFs are moved into b.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Tolerance {
    /// The fraction of the terms that may remain; the default is 1e-10. Any other value settles the doubts
    /// [`Doubt::Near`](crate::Doubt::Near), [`Doubt::NoGap`](crate::Doubt::NoGap) and [`Doubt::Mismatch`](crate::Doubt::Mismatch):
    /// differences up to this value are rounding, and larger ones are meant.
    Relative(f64),
    /// The paper's rule (section 3.2): no scaling, absolute 1e-5. The result depends on the units.
    Paper,
}

impl Tolerance {
    const DEFAULT: f64 = 1e-10;

    pub(crate) fn value(self) -> f64 {
        match self {
            Self::Relative(value) => value,
            Self::Paper => 1e-5,
        }
    }

    /// The tolerance if it is not the default. It then decides which differences are rounding (up to the tolerance) and which are meant
    /// (larger ones), so no difference is in doubt.
    pub(crate) fn stated(self) -> Option<f64> {
        matches!(self, Self::Relative(value) if value != Self::DEFAULT).then(|| self.value())
    }

    /// Returns true if the tolerance is absolute, in the units of the equations.
    pub(crate) fn is_absolute(self) -> bool {
        self == Self::Paper
    }
}

/// The rank-revealing factorization of the equations that remain after presolve.
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
    /// The backend itself. It may allocate `memory` bytes for a block, if it can predict the need ([`Options::memory`]).
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

/// The certainty of a verdict, which determines its cost.
///
/// | effort | computes | guarantees |
/// | --- | --- | --- |
/// | `Quick` | rank by tolerance; no distance, no second reading of numbers | T, G and g satisfy the kept equations; rank may be wrong |
/// | `Checked` | rank, distance and error, by estimates | wrong only if an estimate over random signs fails; doubt is reported |
/// | `Proved` | bounds instead of estimates: [`crate::diagnosis::Proof`] | no verdict without a proof; an unproved verdict is ambiguous |
/// | `Exact` | the rank in exact arithmetic: [`crate::exact`] | true for the numbers as read; a verdict that differs is ambiguous |
///
/// ```
/// use qless::{Effort, Options, SystemBuilder, analyse};
/// let mut builder = SystemBuilder::new(2);
/// builder.equation([(0, 0.1), (1, 0.2)], 0.3);
/// builder.equation([(0, 0.2), (1, 0.4)], 0.6);
/// let options = Options { effort: Effort::Exact, ..Options::default() };
/// let analysis = analyse(&builder.build()?, &options)?;
/// let exact = analysis.exact_rank().expect("asked for");
/// assert_eq!((analysis.rank(), exact.rank, analysis.confidence().ambiguous), (1, 1, false));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "lowercase"))]
pub enum Effort {
    /// The rank is not checked.
    Quick,
    /// The rank is checked by estimates.
    #[default]
    Checked,
    /// The rank is proved, or ambiguous.
    Proved,
    /// The rank is proved or ambiguous, and is compared with the rank in exact arithmetic.
    Exact,
}

impl Effort {
    /// What this effort guarantees, in one sentence.
    pub fn promise(self) -> &'static str {
        match self {
            Self::Quick => "not checked: the rank may be wrong",
            Self::Checked => "by estimates; a doubtful rank is called ambiguous",
            Self::Proved => "by proofs that count rounding; a verdict without a proof is called ambiguous",
            Self::Exact => "by comparison with exact arithmetic; a difference is called ambiguous",
        }
    }

    /// The name of this effort on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Quick => "quick",
            Self::Checked => "checked",
            Self::Proved => "proved",
            Self::Exact => "exact",
        }
    }

    /// Returns true if the rank is checked.
    pub(crate) fn checks(self) -> bool {
        self > Self::Quick
    }
}

/// Settings of [`crate::analyse`].
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Backend for the blocks that remain after presolve. Default: `Faer`.
    pub backend: BackendChoice,
    /// Size below which a remainder counts as zero. Default: relative 1e-10.
    pub tolerance: Tolerance,
    /// Which numbers may be rounding errors of others. Default: `Auto`.
    pub noise: Noise,
    /// If true, equations that need no factorization are eliminated first. Default: true.
    pub presolve: bool,
    /// Certainty of the verdict. Default: `Checked`. With `Quick`, [`crate::Confidence::distance`] is 1 without a computation.
    pub effort: Effort,
    /// How [`Effort::Proved`] and [`Effort::Exact`] read a double. Default: `Typed`.
    pub numbers: Reading,
    /// Bound of growth: slaves and masters are exchanged until `max |T_ij|` is at most this, to 1e-9. At least 1; default 4. Bounds near
    /// 1 need more exchanges. If coefficients of very different units mix, slaves within the bound can be as good as dependent; then the
    /// bound holds in units in which the coefficients are similar, and T is larger in yours.
    pub growth: f64,
    /// Bytes that the factorization of one block, and exact arithmetic, may allocate. If more are needed, the analysis is refused: by
    /// `faer`, `sparse` and `spqr` before the work, by `gauss` as soon as fill exceeds the limit. Default: 16 GiB.
    pub memory: usize,
    /// DOFs that should or should not be slaves, and equations to keep. Default: none.
    pub preferences: Preferences,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            backend: BackendChoice::Faer,
            tolerance: Tolerance::Relative(Tolerance::DEFAULT),
            noise: Noise::Auto,
            presolve: true,
            effort: Effort::Checked,
            numbers: Reading::Typed,
            growth: 4.0,
            memory: 16 << 30,
            preferences: Preferences::default(),
        }
    }
}

impl Options {
    /// Checks every range except those of the preferences, which depend on the system.
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

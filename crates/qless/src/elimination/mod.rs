//! `u = L u_q + u_0`: the operations of a finite-element code on its constraints in every step.
//!
//! ```text
//! expand       u  = L u_q + u_0        u_q (masters) -> u (all DOFs)         O(n + nnz T)
//! increment    du = L du_q             expand without u_0                    O(n + nnz T)
//! restrict     f_q = L^T f             forces on all DOFs -> on masters      O(n + nnz T)
//! condense     K_q = L^T K L,  f_q = L^T (f - K u_0)                         O(nnz K + contributions of slaves)
//! multipliers  C_S^T lambda = (f - K u)_S                                    O(nnz of the LU of C_S), once factored
//! update       g for new b and u_p                                           O(nnz C)
//! ```
//!
//! The row of L is a row of the identity for a master, the row of T for a slave, and empty for a prescribed DOF. `u_0` contains `G u_p + g`
//! and the values of prescribed DOFs. The index S denotes the slaves.

mod apply;
mod condense;
mod error;
mod forces;
mod roles;
mod update;
mod view;

use std::sync::{Arc, OnceLock};

use crate::change::{Refreshed, Refresher};
use crate::common::argument::numbers;
use crate::common::identity::Identity;
use crate::{Analysis, ArgumentError, Confidence, ConstraintSystem, Form, Kind, Options, Reduction, analyse};
use error::refuse_conflicts;
use forces::MultiplierFactors;
use roles::{Role, Roles};

pub use apply::Operator;
pub use condense::{CondensedPattern, PrescribedDofs};
pub use error::EliminationError;
pub use view::{Index, Storage, View};

/// The constraints in the form `u = L u_q + u_0`. It owns its data and is `Send + Sync`: a finite-element code creates it once and stores
/// it.
///
/// ```
/// use qless::{Elimination, Options, SystemBuilder};
/// use qless::elimination::{PrescribedDofs, View};
/// // Three springs in a row, u0 = 0 prescribed, u3 = u2 + 0.5 given twice.
/// let mut builder = SystemBuilder::new(4);
/// builder.equation([(3, 1.0), (2, -1.0)], 0.5);
/// builder.equation([(3, 2.0), (2, -2.0)], 1.0);
/// builder.prescribe(0, 0.0);
/// let elimination = Elimination::new(&builder.build()?, &Options::default())?;
///
/// // K is in the caller's arrays. Its pattern is needed once, its values in every step.
/// let (starts, columns) = ([0, 2, 5, 8, 10], [0_u32, 1, 0, 1, 2, 1, 2, 3, 2, 3]);
/// let k = [1.0, -1.0, -1.0, 2.0, -1.0, -1.0, 2.0, -1.0, -1.0, 1.0];
/// let condensed = elimination.condensed(View::rows(&starts, &columns), PrescribedDofs::Eliminated)?;
/// let (mut k_q, mut f_q) = (vec![0.0; condensed.nnz()], vec![0.0; 2]);
/// condensed.condense_into(&elimination, &k, &[0.0, 0.0, 3.0, 0.0], &mut k_q, &mut f_q)?;
/// assert_eq!((elimination.masters(), k_q.as_slice()), ([1, 3].as_slice(), [2.0, -1.0, -1.0, 1.0].as_slice()));
/// assert_eq!(f_q, [-0.5, 3.5]);
///
/// // Any solver finds u_q = K_q^-1 f_q = (3, 6.5); expand it.
/// let mut u = vec![0.0; 4];
/// elimination.expand_into(&[3.0, 6.5], &mut u)?;
/// assert_eq!(u, [0.0, 3.0, 6.0, 6.5]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Elimination {
    identity: Identity,
    reduction: Reduction,
    roles: Roles,
    /// Current values of the prescribed DOFs.
    prescribed_values: Vec<f64>,
    /// The equations; None if the elimination was made from a reduction.
    equations: Option<EliminationSource>,
}

/// The equations of an elimination.
struct EliminationSource {
    analysis: Arc<Analysis>,
    /// Current right-hand sides.
    rhs: Vec<f64>,
    /// The verdicts on the current b and u_p; None until the first update.
    refreshed: Option<Refreshed>,
    /// The refresher, which is created on first use.
    refresher: OnceLock<Refresher>,
    multipliers: OnceLock<MultiplierFactors>,
}

impl std::fmt::Debug for Elimination {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [slaves, masters, prescribed] = [self.slaves(), self.masters(), self.prescribed()].map(<[usize]>::len);
        write!(f, "Elimination {{ slaves: {slaves}, masters: {masters}, prescribed: {prescribed} }}")
    }
}

impl Elimination {
    /// Analyses a system and solves it for its slaves, with all rows of T explicit.
    ///
    /// # Errors
    /// [`EliminationError::Conflicting`] if equations conflict; [`EliminationError::Analysis`],
    /// [`EliminationError::Reduction`].
    pub fn new(system: &ConstraintSystem, options: &Options) -> Result<Self, EliminationError> {
        Self::from_analysis(analyse(system, options)?, Form::Explicit)
    }

    /// Makes an elimination from an analysis, or from a shared `Arc` of one. Parts of T may be factored ([`Form`]).
    ///
    /// # Errors
    /// As [`Elimination::new`].
    pub fn from_analysis(analysis: impl Into<Arc<Analysis>>, form: Form) -> Result<Self, EliminationError> {
        let analysis = analysis.into();
        refuse_conflicts(analysis.kinds(), analysis.system())?;
        let reduction = analysis.reduction_in(form)?;
        let values = analysis.system().prescribed().iter().map(|&(_, value)| value).collect();
        let equations = EliminationSource {
            rhs: analysis.system().rhs().to_vec(),
            analysis,
            refreshed: None,
            refresher: OnceLock::new(),
            multipliers: OnceLock::new(),
        };
        Ok(Self::build(reduction, values, Some(equations)))
    }

    /// Makes an elimination from T, G and g that were computed elsewhere, and prescribed values in the order of [`Reduction::prescribed`].
    /// [`Elimination::multipliers`] and [`Elimination::update`] need the equations, so they return an error.
    ///
    /// ```
    /// use qless::{Csr, Elimination, Reduction};
    /// // u0 = 2 u1 + 3
    /// let t = Csr::from_parts(1, vec![0, 1], vec![0], vec![2.0])?;
    /// let g_matrix = Csr::from_parts(0, vec![0, 0], Vec::new(), Vec::new())?;
    /// let reduction = Reduction::from_parts([vec![0], vec![1], Vec::new()], t, g_matrix, vec![3.0])?;
    /// let elimination = Elimination::from_reduction(reduction, &[])?;
    /// let mut u = [0.0; 2];
    /// elimination.expand_into(&[5.0], &mut u)?;
    /// assert_eq!(u, [13.0, 5.0]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`ArgumentError`] for a wrong length or a number that is not finite.
    pub fn from_reduction(reduction: Reduction, prescribed: &[f64]) -> Result<Self, ArgumentError> {
        numbers("the list of prescribed values", prescribed, reduction.prescribed.len())?;
        Ok(Self::build(reduction, prescribed.to_vec(), None))
    }

    fn build(reduction: Reduction, prescribed_values: Vec<f64>, equations: Option<EliminationSource>) -> Self {
        let roles = Roles::new(&reduction, &prescribed_values);
        Self { identity: Identity::new(), roles, reduction, prescribed_values, equations }
    }

    /// The analysis: certificates, confidence, generated boundary conditions. None if the elimination was made from a reduction.
    pub fn analysis(&self) -> Option<&Arc<Analysis>> {
        self.equations.as_ref().map(|equations| &equations.analysis)
    }

    /// Current right-hand sides b; empty if the elimination was made from a reduction.
    pub fn rhs(&self) -> &[f64] {
        self.equations.as_ref().map_or(&[], |equations| &equations.rhs)
    }

    /// Kind of each equation, as of the last update, or of the analysis if there was none; empty if the elimination was made from a reduction.
    pub fn kinds(&self) -> &[Kind] {
        self.verdicts(|of| &of.kinds[..], Analysis::kinds).unwrap_or_default()
    }

    /// The certainty of the verdicts, as of the last update, or of the analysis if there was none; None if the elimination was made from a
    /// reduction.
    pub fn confidence(&self) -> Option<Confidence> {
        self.verdicts(|of| of.confidence, Analysis::confidence)
    }

    /// Free DOFs that the equations fix, and their values, ascending, as of the last update, or of the analysis if there was none. Empty if
    /// the elimination was made from a reduction.
    pub fn generated(&self) -> &[(usize, f64)] {
        self.verdicts(|of| &of.generated[..], Analysis::generated).unwrap_or_default()
    }

    /// A part of the verdicts: of the last update, or of the analysis if there was none.
    fn verdicts<'a, T>(&'a self, updated: impl Fn(&'a Refreshed) -> T, first: impl Fn(&'a Analysis) -> T) -> Option<T> {
        let EliminationSource { analysis, refreshed, .. } = self.equations.as_ref()?;
        Some(refreshed.as_ref().map_or_else(|| first(analysis), updated))
    }

    /// T, G and g for the current b and u_p.
    pub fn reduction(&self) -> &Reduction {
        &self.reduction
    }

    /// Number of DOFs n.
    pub fn dofs(&self) -> usize {
        self.roles.of.len()
    }

    /// The slaves u_s, ascending.
    pub fn slaves(&self) -> &[usize] {
        self.reduction.slaves()
    }

    /// The masters u_q, ascending.
    pub fn masters(&self) -> &[usize] {
        self.reduction.masters()
    }

    /// The prescribed DOFs u_p, ascending.
    pub fn prescribed(&self) -> &[usize] {
        self.reduction.prescribed()
    }

    /// Current values of the prescribed DOFs, in the order of [`Elimination::prescribed`].
    pub fn prescribed_values(&self) -> &[f64] {
        &self.prescribed_values
    }

    /// Returns true if a DOF is a slave; false for numbers from n on.
    pub fn is_slave(&self, dof: usize) -> bool {
        matches!(self.roles.of.get(dof), Some(Role::Slave(_)))
    }

    /// The row `u_dof = sum value u_j + g` of a slave: (j, value) for masters and prescribed DOFs, ascending, and g. None for DOFs that are
    /// not slaves, and for slaves of factored parts, whose rows [`Reduction::row`] computes.
    ///
    /// ```
    /// # use qless::{Elimination, Options, SystemBuilder};
    /// let mut builder = SystemBuilder::new(3);
    /// builder.equation([(0, 1.0), (1, -0.5), (2, -0.5)], 1.0);
    /// builder.prescribe(2, 4.0);
    /// let elimination = Elimination::new(&builder.build()?, &Options::default())?;
    /// let (terms, g) = elimination.row(0).expect("a slave");
    /// assert_eq!((terms, g), (vec![(1, 0.5), (2, 0.5)], 1.0));
    /// assert_eq!(elimination.masters_of(0), [1]);
    /// assert!(elimination.row(1).is_none());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn row(&self, dof: usize) -> Option<(Vec<(usize, f64)>, f64)> {
        let Some(&Role::Slave(i)) = self.roles.of.get(dof) else { return None };
        let (i, reduction) = (i as usize, &self.reduction);
        if self.roles.is_factored(i) {
            return None;
        }
        let of_masters = reduction.t.row(i).map(|(q, v)| (reduction.masters[q], v));
        let mut terms: Vec<_> = of_masters.collect();
        terms.extend(reduction.g_matrix.row(i).map(|(p, v)| (reduction.prescribed[p], v)));
        terms.sort_unstable_by_key(|&(j, _)| j);
        Some((terms, reduction.g[i]))
    }

    /// The masters in the row of a slave, ascending; empty for other DOFs.
    pub fn masters_of(&self, dof: usize) -> Vec<usize> {
        let Some(&Role::Slave(i)) = self.roles.of.get(dof) else { return Vec::new() };
        let row = self.reduction.row(i as usize).unwrap_or_default();
        row.into_iter().map(|(q, _)| self.reduction.masters[q]).collect()
    }
}

//! `u = L u_q + u_0`: what a finite-element code does with its constraints in every step.
//!
//! ```text
//! expand       u  = L u_q + u_0        u_q (masters) -> u (all DOFs)         O(n + nnz T)
//! increment    du = L du_q             the same without u_0                  O(n + nnz T)
//! restrict     f_q = L^T f             forces on all DOFs -> on masters      O(n + nnz T)
//! condense     K_q = L^T K L,  f_q = L^T (f - K u_0)                         O(nnz K + contributions of slaves)
//! multipliers  C_S^T lambda = (f - K u)_S                                    O(nnz of the LU of C_S), once factored
//! update       g for new b and u_p                                           O(nnz C)
//! ```
//!
//! L has a row of the identity for each master, the row of T for each slave and nothing for prescribed DOFs, which are in u_0 with g.

mod apply;
mod condense;
mod error;
mod forces;
mod operator;
mod roles;
mod view;

use std::sync::{Arc, OnceLock};

use crate::change::refresh::Refresher;
use crate::common::argument::numbers;
use crate::common::identity::Identity;
use crate::{Analysis, ArgumentError, ConstraintSystem, Form, Kind, Options, Reduction, analyse};
use forces::Multipliers;
use roles::{Role, Roles};

pub use condense::{CondensedPattern, PrescribedDofs};
pub use error::EliminationError;
pub use operator::Operator;
pub use view::{Index, Storage, View};

/// The constraints in the form `u = L u_q + u_0`: made once, owned, `Send + Sync`, kept beside the model.
///
/// ```
/// use qless::{Elimination, Options, SystemBuilder};
/// use qless::elimination::{PrescribedDofs, View};
/// // Three springs in a row, u0 = 0 prescribed, u3 tied to u2 by u3 = u2 + 0.5 (said twice).
/// let mut builder = SystemBuilder::new(4);
/// builder.equation([(3, 1.0), (2, -1.0)], 0.5);
/// builder.equation([(3, 2.0), (2, -2.0)], 1.0);
/// builder.prescribe(0, 0.0);
/// let elimination = Elimination::new(&builder.build()?, &Options::default())?;
///
/// // K in the caller's arrays; its pattern once, its values in every step.
/// let (starts, columns) = ([0, 2, 5, 8, 10], [0_u32, 1, 0, 1, 2, 1, 2, 3, 2, 3]);
/// let k = [1.0, -1.0, -1.0, 2.0, -1.0, -1.0, 2.0, -1.0, -1.0, 1.0];
/// let condensed = elimination.condensed(View::rows(&starts, &columns), PrescribedDofs::Eliminated)?;
/// let (mut k_q, mut f_q) = (vec![0.0; condensed.nnz()], vec![0.0; 2]);
/// condensed.condense_into(&elimination, &k, &[0.0, 0.0, 3.0, 0.0], &mut k_q, &mut f_q)?;
/// assert_eq!((elimination.masters(), k_q.as_slice()), ([1, 3].as_slice(), [2.0, -1.0, -1.0, 1.0].as_slice()));
/// assert_eq!(f_q, [-0.5, 3.5]);
///
/// // u_q = K_q^-1 f_q = (3, 6.5), by any solver, and back.
/// let mut u = vec![0.0; 4];
/// elimination.expand_into(&[3.0, 6.5], &mut u)?;
/// assert_eq!(u, [0.0, 3.0, 6.0, 6.5]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Elimination {
    identity: Identity,
    reduction: Reduction,
    roles: Roles,
    /// Values of the prescribed DOFs, as they are now.
    prescribed_values: Vec<f64>,
    /// None if it was made from a reduction alone.
    equations: Option<Equations>,
}

/// The equations behind an elimination.
struct Equations {
    analysis: Arc<Analysis>,
    /// b, as it is now.
    rhs: Vec<f64>,
    kinds: Vec<Kind>,
    /// Made when it is first needed.
    refresher: OnceLock<Refresher>,
    multipliers: OnceLock<Multipliers>,
}

impl std::fmt::Debug for Elimination {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [slaves, masters, prescribed] = [self.slaves(), self.masters(), self.prescribed()].map(<[usize]>::len);
        write!(f, "Elimination {{ slaves: {slaves}, masters: {masters}, prescribed: {prescribed} }}")
    }
}

impl Elimination {
    /// Analyses a system and solves it for its slaves; all of T as numbers.
    ///
    /// # Errors
    /// [`EliminationError::Conflicting`] if equations contradict one another; [`EliminationError::Analysis`],
    /// [`EliminationError::Reduction`].
    pub fn new(system: &ConstraintSystem, options: &Options) -> Result<Self, EliminationError> {
        Self::from_analysis(analyse(system, options)?, Form::Explicit)
    }

    /// From an analysis, or an `Arc` of one; parts of T may stay factors ([`Form`]).
    ///
    /// # Errors
    /// As [`Elimination::new`].
    pub fn from_analysis(analysis: impl Into<Arc<Analysis>>, form: Form) -> Result<Self, EliminationError> {
        let analysis = analysis.into();
        refuse_conflicts(analysis.kinds(), analysis.system())?;
        let reduction = analysis.reduction_in(form)?;
        let values = analysis.system().prescribed().iter().map(|&(_, value)| value).collect();
        let equations = Equations {
            rhs: analysis.system().rhs().to_vec(),
            kinds: analysis.kinds().to_vec(),
            analysis,
            refresher: OnceLock::new(),
            multipliers: OnceLock::new(),
        };
        Ok(Self::build(reduction, values, Some(equations)))
    }

    /// From T, G and g that were computed elsewhere, with values in the order of [`Reduction::prescribed`]. Without the equations there are
    /// no multipliers and no [`Elimination::update`].
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

    fn build(reduction: Reduction, prescribed_values: Vec<f64>, equations: Option<Equations>) -> Self {
        let roles = Roles::new(&reduction, &prescribed_values);
        Self { identity: Identity::new(), roles, reduction, prescribed_values, equations }
    }

    /// What is known of the equations: certificates, confidence, generated boundary conditions. None if it was made from a reduction.
    pub fn analysis(&self) -> Option<&Arc<Analysis>> {
        self.equations.as_ref().map(|equations| &equations.analysis)
    }

    /// b, as it is now; empty if it was made from a reduction.
    pub fn rhs(&self) -> &[f64] {
        self.equations.as_ref().map_or(&[], |equations| &equations.rhs)
    }

    /// Kind of each equation, for b and u_p as they are now; empty if it was made from a reduction.
    pub fn kinds(&self) -> &[Kind] {
        self.equations.as_ref().map_or(&[], |equations| &equations.kinds)
    }

    /// New right-hand sides b (length m) and prescribed values (in the order of [`Elimination::prescribed`]). Slaves and T stay as they are,
    /// to the last bit.
    ///
    /// ```
    /// # use qless::{Elimination, Options, SystemBuilder};
    /// let mut builder = SystemBuilder::new(3);
    /// builder.equation([(0, 1.0), (1, -1.0), (2, -1.0)], 0.0);
    /// builder.prescribe(2, 0.0);
    /// let mut elimination = Elimination::new(&builder.build()?, &Options::default())?;
    /// for step in 1..=3 {
    ///     let t = f64::from(step);
    ///     elimination.update(&[0.5 * t], &[t * t])?;
    ///     let mut u = [0.0; 3];
    ///     elimination.expand_into(&[0.0], &mut u)?;
    ///     assert_eq!(u[0] - u[1], t * t + 0.5 * t);
    /// }
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`EliminationError::Refresh`], and [`EliminationError::Conflicting`] if equations contradict one another now; nothing has changed then.
    pub fn update(&mut self, rhs: &[f64], prescribed: &[f64]) -> Result<(), EliminationError> {
        let Self { reduction, equations, prescribed_values, .. } = self;
        let Equations { analysis, rhs: old, kinds, refresher, .. } =
            equations.as_mut().ok_or(EliminationError::NoEquations)?;
        let g = reduction.g.clone();
        if refresher.get().is_none() {
            // Nobody else can have set it: this is the only reference.
            let _ = refresher.set(Refresher::new(Arc::clone(analysis)).map_err(EliminationError::Backend)?);
        }
        let Some(refresher) = refresher.get() else { return Ok(()) };
        let refreshed = refresher.refresh(rhs, prescribed, reduction)?;
        if let Err(error) = refuse_conflicts(&refreshed.kinds, analysis.system()) {
            refresher.refresh(old, prescribed_values, reduction)?;
            reduction.g = g;
            return Err(error);
        }
        *kinds = refreshed.kinds;
        old.copy_from_slice(rhs);
        self.prescribe(prescribed);
        Ok(())
    }

    /// [`Elimination::update`] by functions of the equation and of the prescribed DOF, at a time that they know.
    ///
    /// # Errors
    /// As [`Elimination::update`].
    pub fn update_with(
        &mut self,
        rhs: impl Fn(usize) -> f64,
        prescribed: impl Fn(usize) -> f64,
    ) -> Result<(), EliminationError> {
        let rhs: Vec<f64> = (0..self.rhs().len()).map(rhs).collect();
        let prescribed: Vec<f64> = self.prescribed().iter().map(|&dof| prescribed(dof)).collect();
        self.update(&rhs, &prescribed)
    }

    /// A new g and new values of the prescribed DOFs; T and G stay.
    ///
    /// # Errors
    /// [`ArgumentError`] for wrong lengths or numbers that are not finite; everything is then as it was.
    pub fn set(&mut self, g: &[f64], prescribed: &[f64]) -> Result<(), ArgumentError> {
        numbers("g", g, self.reduction.g.len())?;
        numbers("the list of prescribed values", prescribed, self.prescribed_values.len())?;
        self.reduction.g.copy_from_slice(g);
        self.prescribe(prescribed);
        Ok(())
    }

    fn prescribe(&mut self, prescribed: &[f64]) {
        self.prescribed_values.copy_from_slice(prescribed);
        self.roles.refresh(&self.reduction, prescribed);
    }

    /// T, G and g, for b and u_p as they are now.
    pub fn reduction(&self) -> &Reduction {
        &self.reduction
    }

    /// Number of DOFs n.
    pub fn dofs(&self) -> usize {
        self.roles.of.len()
    }

    /// u_s, ascending.
    pub fn slaves(&self) -> &[usize] {
        self.reduction.slaves()
    }

    /// u_q, ascending.
    pub fn masters(&self) -> &[usize] {
        self.reduction.masters()
    }

    /// u_p, ascending.
    pub fn prescribed(&self) -> &[usize] {
        self.reduction.prescribed()
    }

    /// Values of u_p, as they are now.
    pub fn prescribed_values(&self) -> &[f64] {
        &self.prescribed_values
    }

    /// Whether a DOF follows others; no DOF from n on does.
    pub fn is_slave(&self, dof: usize) -> bool {
        matches!(self.roles.of.get(dof), Some(Role::Slave(_)))
    }

    /// `u_dof = sum value u_j + g` of a slave: (j, value) for masters and prescribed DOFs, ascending, and g. None for other DOFs, and
    /// for slaves of factored parts ([`Reduction::row`]).
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
        if self.roles.is_held(i) {
            return None;
        }
        let of_masters = reduction.t.row(i).map(|(q, v)| (reduction.masters[q], v));
        let mut terms: Vec<_> = of_masters.collect();
        terms.extend(reduction.g_matrix.row(i).map(|(p, v)| (reduction.prescribed[p], v)));
        terms.sort_unstable_by_key(|&(j, _)| j);
        Some((terms, reduction.g[i]))
    }

    /// The masters that a slave follows, ascending; none for other DOFs.
    pub fn masters_of(&self, dof: usize) -> Vec<usize> {
        let Some(&Role::Slave(i)) = self.roles.of.get(dof) else { return Vec::new() };
        let row = self.reduction.row(i as usize).unwrap_or_default();
        row.into_iter().map(|(q, _)| self.reduction.masters[q]).collect()
    }
}

/// Equations that contradict others have no solution that a model could follow.
fn refuse_conflicts(kinds: &[Kind], system: &ConstraintSystem) -> Result<(), EliminationError> {
    let rows: Vec<usize> = (0..kinds.len()).filter(|&i| kinds[i] == Kind::Conflicting).collect();
    if rows.is_empty() {
        return Ok(());
    }
    let labels = rows.iter().map(|&row| system.equation_label(row)).collect();
    Err(EliminationError::Conflicting { rows, labels })
}

//! `u = L u_q + u_0`: what a finite-element code does with its constraints in every step.
//!
//! ```text
//! expand       u  = L u_q + u_0        u_q (masters) -> u (all DOFs)         O(n + nnz T)
//! increment    du = L du_q             the same without u_0                  O(n + nnz T)
//! project      f_q = L^T f             forces on all DOFs -> on masters      O(n + nnz T)
//! condense     K_q = L^T K L,  f_q = L^T (f - K u_0)                         O(nnz K + contributions of slaves)
//! multipliers  C_S^T lambda = (f - K u)_S                                    O(nnz of the LU of C_S), once factored
//! refresh      g for new b and u_p                                           O(nnz C)
//! ```
//!
//! L has a row of the identity for each master, the row of T for each slave and nothing for prescribed DOFs, which are in u_0 with g.

mod apply;
mod condense;
mod error;
mod forces;
mod operator;
mod roles;
mod transform;
mod view;

use std::sync::{Arc, OnceLock};

use crate::change::refresh::Refresher;
use crate::{Analysis, ConstraintSystem, Form, Kind, Options, analyse};
use forces::Multipliers;
use roles::Role;

pub use condense::{Condensed, Given};
pub use error::MapError;
pub use operator::Operator;
pub use transform::Transform;
pub use view::{Index, Storage, View};

/// A constraint system, analysed and solved for its slaves: owned, `Send + Sync`, made once and kept beside the model.
///
/// ```
/// use qless::{Given, Map, Options, SystemBuilder, View};
/// // Three springs in a row, u0 = 0 prescribed, u3 tied to u2 by u3 = u2 + 0.5 (said twice).
/// let mut builder = SystemBuilder::new(4);
/// builder.equation([(3, 1.0), (2, -1.0)], 0.5);
/// builder.equation([(3, 2.0), (2, -2.0)], 1.0);
/// builder.prescribe(0, 0.0);
/// let map = Map::new(&builder.build()?, &Options::default())?;
///
/// // K in the caller's arrays; its pattern once, its values in every step.
/// let (starts, columns) = ([0, 2, 5, 8, 10], [0_u32, 1, 0, 1, 2, 1, 2, 3, 2, 3]);
/// let k = [1.0, -1.0, -1.0, 2.0, -1.0, -1.0, 2.0, -1.0, -1.0, 1.0];
/// let condensed = map.condensed(View::rows(&starts, &columns), Given::Eliminated)?;
/// let (mut k_q, mut f_q) = (vec![0.0; condensed.nnz()], vec![0.0; 2]);
/// condensed.condense_into(&map, &k, &[0.0, 0.0, 3.0, 0.0], &mut k_q, &mut f_q)?;
/// assert_eq!((map.masters(), k_q.as_slice()), ([1, 3].as_slice(), [2.0, -1.0, -1.0, 1.0].as_slice()));
/// assert_eq!(f_q, [-0.5, 3.5]);
///
/// // u_q = K_q^-1 f_q = (3, 6.5), by any solver, and back.
/// let mut u = vec![0.0; 4];
/// map.expand_into(&[3.0, 6.5], &mut u)?;
/// assert_eq!(u, [0.0, 3.0, 6.0, 6.5]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Map {
    analysis: Arc<Analysis>,
    transform: Transform,
    /// b, as it is now.
    rhs: Vec<f64>,
    kinds: Vec<Kind>,
    /// Made when it is first needed.
    refresher: OnceLock<Refresher>,
    multipliers: OnceLock<Multipliers>,
}

impl std::fmt::Debug for Map {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.transform.write_as("Map", f)
    }
}

/// What a map does in every step, it does as its [`Transform`].
impl std::ops::Deref for Map {
    type Target = Transform;

    fn deref(&self) -> &Transform {
        &self.transform
    }
}

impl Map {
    /// Analyses a system and solves it for slaves; all of T as numbers.
    ///
    /// # Errors
    /// [`MapError::Conflicting`] where equations contradict one another; [`MapError::Analysis`], [`MapError::Reduction`].
    pub fn new(system: &ConstraintSystem, options: &Options) -> Result<Self, MapError> {
        Self::of(analyse(system, options)?, Form::Explicit)
    }

    /// From an analysis, or an `Arc` of one; parts of T may stay factors ([`Form`]).
    ///
    /// # Errors
    /// As [`Map::new`].
    pub fn of(analysis: impl Into<Arc<Analysis>>, form: Form) -> Result<Self, MapError> {
        let analysis = analysis.into();
        refuse_conflicts(analysis.kinds(), analysis.system())?;
        let reduction = analysis.reduction_in(form)?;
        let given: Vec<f64> = analysis.system().prescribed().iter().map(|&(_, value)| value).collect();
        Ok(Self {
            rhs: analysis.system().rhs().to_vec(),
            kinds: analysis.kinds().to_vec(),
            transform: Transform::of(reduction, given),
            analysis,
            refresher: OnceLock::new(),
            multipliers: OnceLock::new(),
        })
    }

    /// What is known of the equations: certificates, confidence, generated boundary conditions.
    pub fn analysis(&self) -> &Arc<Analysis> {
        &self.analysis
    }

    /// b, as it is now.
    pub fn rhs(&self) -> &[f64] {
        &self.rhs
    }

    /// What each equation is, for b and u_p as they are now.
    pub fn kinds(&self) -> &[Kind] {
        &self.kinds
    }

    /// New right-hand sides b (length m) and prescribed values (in the order of [`Transform::prescribed`]). Slaves and T stay as they are,
    /// to the last bit.
    ///
    /// ```
    /// # use qless::{Map, Options, SystemBuilder};
    /// let mut builder = SystemBuilder::new(3);
    /// builder.equation([(0, 1.0), (1, -1.0), (2, -1.0)], 0.0);
    /// builder.prescribe(2, 0.0);
    /// let mut map = Map::new(&builder.build()?, &Options::default())?;
    /// for step in 1..=3 {
    ///     let t = f64::from(step);
    ///     map.refresh(&[0.5 * t], &[t * t])?;
    ///     let mut u = [0.0; 3];
    ///     map.expand_into(&[0.0], &mut u)?;
    ///     assert_eq!(u[0] - u[1], t * t + 0.5 * t);
    /// }
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`MapError::Refresh`], and [`MapError::Conflicting`] where equations contradict one another now; the map is then as it was.
    pub fn refresh(&mut self, rhs: &[f64], prescribed: &[f64]) -> Result<(), MapError> {
        let Self { analysis, refresher, transform, .. } = self;
        let g = transform.reduction.g.clone();
        if refresher.get().is_none() {
            // Nobody else can have set it: this is the only reference.
            let _ = refresher.set(Refresher::new(Arc::clone(analysis)).map_err(MapError::Backend)?);
        }
        let Some(refresher) = refresher.get() else { return Ok(()) };
        let refreshed = refresher.refresh(rhs, prescribed, &mut transform.reduction)?;
        if let Err(error) = refuse_conflicts(&refreshed.kinds, analysis.system()) {
            refresher.refresh(&self.rhs, &transform.given, &mut transform.reduction)?;
            transform.reduction.g = g;
            return Err(error);
        }
        self.kinds = refreshed.kinds;
        self.rhs.copy_from_slice(rhs);
        transform.give(prescribed);
        Ok(())
    }

    /// [`Map::refresh`] by functions of the equation and of the prescribed DOF, at a time that they know.
    ///
    /// # Errors
    /// As [`Map::refresh`].
    pub fn refresh_with(
        &mut self,
        rhs: impl Fn(usize) -> f64,
        prescribed: impl Fn(usize) -> f64,
    ) -> Result<(), MapError> {
        let rhs: Vec<f64> = (0..self.kinds.len()).map(rhs).collect();
        let prescribed: Vec<f64> = self.prescribed().iter().map(|&dof| prescribed(dof)).collect();
        self.refresh(&rhs, &prescribed)
    }
}

/// Equations that contradict others have no solution that a model could follow.
fn refuse_conflicts(kinds: &[Kind], system: &ConstraintSystem) -> Result<(), MapError> {
    let rows: Vec<usize> = (0..kinds.len()).filter(|&i| kinds[i] == Kind::Conflicting).collect();
    if rows.is_empty() {
        return Ok(());
    }
    let labels = rows.iter().map(|&row| system.equation_label(row)).collect();
    Err(MapError::Conflicting { rows, labels })
}

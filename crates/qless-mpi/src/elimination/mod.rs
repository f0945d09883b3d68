//! `u = L u_q + u_0` across ranks; u_q and u are distributed.
//!
//! ```text
//! gather     u_q of all masters that the rows of a rank use, from their owners            one message to each neighbour
//! expand     u = L u_q + u_0 on local DOFs; rows that use only masters of this rank are computed during the transfer
//! restrict   f_q = L^T f: contributions of each rank's local DOFs, summed at the owners   one message to each neighbour
//! condense   K_q = L^T K L of each rank's own K on its local DOFs                         no messages
//! ```
//!
//! The local DOFs of a rank are those that it owns and needs, and the masters and prescribed DOFs in their rows.

mod ghosts;
mod local;

use qless::{Elimination, Options};

use crate::analysis::{Analysis, analyse};
use crate::error::{Error, agree};
use crate::ranks::Ranks;
use crate::share::Share;
use ghosts::Ghosts;

/// The constraints of a distributed model in the form `u = L u_q + u_0`, on one rank.
///
/// ```
/// use qless::Options;
/// use qless_mpi::{DistributedElimination, Share, on_threads};
/// // u2 of the second rank depends on u0 of the first: u2 = u0 / 2 + 1.
/// let sums = on_threads(2, |ranks| {
///     let first = ranks.rank() == 0;
///     let mut share = Share::new(if first { 0..2 } else { 2..4 });
///     if first {
///         share.equation(0, [(2, 1.0), (0, -0.5)], 1.0);
///     }
///     let elimination = DistributedElimination::new(ranks, &share, &Options::default()).expect("consistent");
///     let masters = vec![3.0; elimination.masters().len()];
///     let mut u = vec![0.0; elimination.dofs().len()];
///     elimination.expand_into(ranks, &masters, &mut u);
///     (elimination.dofs().to_vec(), u)
/// });
/// assert_eq!(sums[0], (vec![0, 1], vec![3.0, 3.0]));
/// assert_eq!(sums[1], (vec![0, 2, 3], vec![3.0, 2.5, 3.0]));
/// ```
#[derive(Debug)]
pub struct DistributedElimination {
    analysis: Analysis,
    /// The local DOFs, ascending.
    dofs: Vec<u64>,
    /// `u = L u_q + u_0` on the local DOFs.
    elimination: Elimination,
    /// The masters that this rank owns.
    masters: Vec<u64>,
    ghosts: Ghosts,
    /// Slaves whose rows use masters of this rank only; `outer` holds all other slaves. Both lists hold indices into the slaves of
    /// `elimination`.
    inner: Vec<u32>,
    outer: Vec<u32>,
    /// `G u_p + g` for each slave.
    constants: Vec<f64>,
}

impl DistributedElimination {
    /// Analyses the equations of all ranks and solves them for slaves. Collective.
    ///
    /// # Errors
    /// As [`analyse`]; [`Error::Conflicting`] if equations contradict one another. The same on all ranks.
    pub fn new(ranks: &dyn Ranks, share: &Share, options: &Options) -> Result<Self, Error> {
        Self::from_analysis(ranks, share, analyse(ranks, share, options)?)
    }

    /// Solves the equations of an [`analyse`] of the same share for slaves. Collective.
    ///
    /// # Errors
    /// [`Error::Conflicting`] if equations contradict one another; [`Error::Failed`] if a rank could not store T, G and g. The same on all
    /// ranks.
    pub fn from_analysis(ranks: &dyn Ranks, share: &Share, analysis: Analysis) -> Result<Self, Error> {
        refuse_conflicts(ranks, share, &analysis)?;
        let local = local::LocalDofs::new(ranks, share, &analysis);
        let elimination = local.elimination(&analysis).map_err(|failure| failure.on(ranks.rank()));
        let elimination = agree(ranks, elimination)?;
        let own = analysis.layout.owned(ranks.rank());
        let of_masters: Vec<u64> = elimination.masters().iter().map(|&j| local.dofs[j]).collect();
        let ghosts = Ghosts::new(ranks, &analysis.layout, &of_masters);
        let is_inner =
            |i: &u32| elimination.reduction().t().row(*i as usize).all(|(q, _)| own.contains(&of_masters[q]));
        let (inner, outer) = (0..elimination.slaves().len() as u32).partition(is_inner);
        let masters = of_masters[ghosts.own()].to_vec();
        let dofs = local.dofs;
        let constants = constants(&elimination);
        Ok(Self { analysis, dofs, elimination, masters, ghosts, inner, outer, constants })
    }

    /// The analysis: kinds of equations, certificates and rows of T.
    pub fn analysis(&self) -> &Analysis {
        &self.analysis
    }

    /// The local DOFs, ascending. Vectors u and f of this rank have one entry for each.
    pub fn dofs(&self) -> &[u64] {
        &self.dofs
    }

    /// The masters that this rank owns, ascending. The vector u_q of this rank has one entry for each.
    pub fn masters(&self) -> &[u64] {
        &self.masters
    }

    /// T, G and g on the local DOFs, numbered by their indices in [`DistributedElimination::dofs`]. Use it to condense the matrices of this
    /// rank ([`Elimination::condensed`]). The unknowns are [`Elimination::masters`], and the prescribed DOFs if they are kept.
    pub fn local(&self) -> &Elimination {
        &self.elimination
    }

    /// T, G and g on the local DOFs, for callers that keep nothing else.
    pub fn into_local(self) -> Elimination {
        self.elimination
    }

    /// Gathers u_q of all local masters from the ranks that own them. Calls `work` during the transfer. Collective.
    ///
    /// # Panics
    /// If `masters` has another length than [`DistributedElimination::masters`], or `local` another length than the masters of
    /// [`DistributedElimination::local`].
    pub fn gather_into(&self, ranks: &dyn Ranks, masters: &[f64], local: &mut [f64], work: &mut dyn FnMut()) {
        assert_eq!((masters.len(), local.len()), (self.masters.len(), self.elimination.masters().len()), "lengths");
        local[self.ghosts.own()].copy_from_slice(masters);
        self.ghosts.gather(ranks, local, work);
    }

    /// Each rank gives a value for each of its local masters. For each master, its owner receives the sum over all ranks. Collective.
    ///
    /// # Panics
    /// As [`DistributedElimination::gather_into`].
    pub fn sum_into(&self, ranks: &dyn Ranks, local: &[f64], masters: &mut [f64]) {
        assert_eq!((masters.len(), local.len()), (self.masters.len(), self.elimination.masters().len()), "lengths");
        masters.copy_from_slice(&local[self.ghosts.own()]);
        self.ghosts.sum(ranks, local, masters);
    }

    /// `u = L u_q + u_0` on the local DOFs. Collective.
    ///
    /// # Panics
    /// If `masters` has another length than [`DistributedElimination::masters`], or `u` another length than
    /// [`DistributedElimination::dofs`].
    pub fn expand_into(&self, ranks: &dyn Ranks, masters: &[f64], u: &mut [f64]) {
        let values = self.elimination.prescribed_values();
        self.elimination.prescribed().iter().zip(values).for_each(|(&j, &value)| u[j] = value);
        self.spread(ranks, masters, u, |i| self.constants[i]);
    }

    /// Computes increments, `du = L du_q`. Increments of prescribed DOFs are zero. Collective.
    ///
    /// # Panics
    /// As [`DistributedElimination::expand_into`].
    pub fn expand_increment_into(&self, ranks: &dyn Ranks, masters: &[f64], du: &mut [f64]) {
        self.elimination.prescribed().iter().for_each(|&j| du[j] = 0.0);
        self.spread(ranks, masters, du, |_| 0.0);
    }

    fn spread(&self, ranks: &dyn Ranks, masters: &[f64], u: &mut [f64], constant: impl Fn(usize) -> f64) {
        assert_eq!((masters.len(), u.len()), (self.masters.len(), self.dofs.len()), "lengths");
        let mut local = vec![0.0; self.elimination.masters().len()];
        local[self.ghosts.own()].copy_from_slice(masters);
        let own = local.clone();
        let t = self.elimination.reduction().t();
        let row = |i: &u32, q: &[f64]| {
            let sum: f64 = t.row(*i as usize).map(|(k, value)| value * q[k]).sum();
            (self.elimination.slaves()[*i as usize], constant(*i as usize) + sum)
        };
        self.ghosts.gather(ranks, &mut local, &mut || {
            self.inner.iter().map(|i| row(i, &own)).for_each(|(j, value)| u[j] = value);
        });
        self.outer.iter().map(|i| row(i, &local)).for_each(|(j, value)| u[j] = value);
        self.elimination.masters().iter().zip(&local).for_each(|(&j, &value)| u[j] = value);
    }

    /// `f_q = L^T f`: each rank gives its contribution to the forces on its local DOFs; the contributions of all ranks are summed.
    /// Collective.
    ///
    /// # Panics
    /// As [`DistributedElimination::expand_into`].
    pub fn restrict_into(&self, ranks: &dyn Ranks, forces: &[f64], masters: &mut [f64]) {
        assert_eq!(forces.len(), self.dofs.len(), "length of the forces");
        let mut local: Vec<f64> = self.elimination.masters().iter().map(|&j| forces[j]).collect();
        let t = self.elimination.reduction().t();
        for (i, &slave) in self.elimination.slaves().iter().enumerate() {
            t.row(i).for_each(|(q, value)| local[q] += value * forces[slave]);
        }
        self.sum_into(ranks, &local, masters);
    }

    /// Takes new right-hand sides and prescribed values from a share of the same equations ([`Share::set_rhs`],
    /// [`Share::set_prescribed`]). Condensed patterns stay valid if slaves, T and G stay the same; otherwise they must be made again. Costs
    /// an analysis. Collective.
    ///
    /// # Errors
    /// As [`DistributedElimination::new`]; then nothing changes.
    pub fn update(&mut self, ranks: &dyn Ranks, share: &Share, options: &Options) -> Result<(), Error> {
        let Self { analysis, dofs, elimination, masters, ghosts, inner, outer, constants } =
            Self::new(ranks, share, options)?;
        // Condensed patterns belong to the old elimination, so keep it unless roles, T or G have changed.
        if self.dofs == dofs && is_same(&self.elimination, &elimination) {
            let set = self.elimination.set(elimination.reduction().g(), elimination.prescribed_values());
            set.expect("lengths and numbers of an elimination");
        } else {
            self.elimination = elimination;
        }
        (self.analysis, self.dofs, self.masters, self.ghosts) = (analysis, dofs, masters, ghosts);
        (self.inner, self.outer, self.constants) = (inner, outer, constants);
        Ok(())
    }
}

/// Whether two eliminations differ at most in g and in prescribed values.
fn is_same(a: &Elimination, b: &Elimination) -> bool {
    let roles = |of: &Elimination| [of.slaves().to_vec(), of.masters().to_vec(), of.prescribed().to_vec()];
    let (left, right) = (a.reduction(), b.reduction());
    roles(a) == roles(b) && left.t() == right.t() && left.g_matrix() == right.g_matrix()
}

fn constants(elimination: &Elimination) -> Vec<f64> {
    let (reduction, u_p) = (elimination.reduction(), elimination.prescribed_values());
    let row = |i: usize| reduction.g_matrix().row(i).map(|(p, value)| value * u_p[p]).sum::<f64>() + reduction.g()[i];
    (0..elimination.slaves().len()).map(row).collect()
}

/// An error if equations conflict.
fn refuse_conflicts(ranks: &dyn Ranks, share: &Share, analysis: &Analysis) -> Result<(), Error> {
    let count = analysis.counts().conflicting;
    if count == 0 {
        return Ok(());
    }
    let conflicting = analysis.dependent().iter().filter(|d| d.kind == qless::Kind::Conflicting);
    let first = conflicting.map(|d| share.numbers()[d.equation]).min();
    let mut most = [first.map_or(0, |first| u64::MAX - first)];
    ranks.max(&mut most);
    Err(Error::Conflicting { count, first: u64::MAX - most[0] })
}

//! The analysis across ranks, stage by stage.

use qless::{Kind, OptionError, Options};

use super::attempt::{Attempt, AttemptInput};
use super::{Analysis, JobCounts};
use crate::components::{ConnectedComponent, ConnectedComponents, Directory, Layout, TouchedDofs};
use crate::distribute::{Sizes, sizes};
use crate::error::{Error, agree, agree_on_options};
use crate::ranks::Ranks;
use crate::share::{Share, check_numbers};
use crate::solve::request_rows;

/// Diagnoses the equations of all ranks and solves them for slaves. Collective: every rank passes its share and the same options, and
/// receives the results for its equations and DOFs.
///
/// The result is that of [`qless::analyse`] for all equations in the order of their numbers, for any distribution and any number of ranks.
/// Cost: a rank sends about 40 bytes for each DOF of its equations. In each attempt, it also sends each equation at most once, to the rank
/// that analyses its component. The number of communication rounds grows with the logarithm of the number of ranks that a component
/// crosses.
///
/// ```
/// use qless::{Kind, Options};
/// use qless_mpi::{Share, analyse, on_threads};
/// // u1 = u0 on one rank, u2 = u1 on the next. Both also hold their sum u2 = u0: redundant on the first rank, conflicting on the second.
/// let kinds = on_threads(2, |ranks| {
///     let (first, second) = (ranks.rank() == 0, ranks.rank() == 1);
///     let mut share = Share::new(if first { 0..2 } else { 2..3 });
///     if first {
///         share.equation(0, [(1, 1.0), (0, -1.0)], 0.0);
///         share.equation(2, [(2, 2.0), (0, -2.0)], 0.0);
///     } else if second {
///         share.equation(1, [(2, 1.0), (1, -1.0)], 0.0);
///         share.equation(3, [(2, 1.0), (0, -1.0)], 0.5);
///     }
///     analyse(ranks, &share, &Options::default()).expect("valid").kinds().to_vec()
/// });
/// assert_eq!(kinds, [[Kind::Independent, Kind::Redundant], [Kind::Independent, Kind::Conflicting]]);
/// ```
///
/// # Errors
/// [`Error`], the same on all ranks.
pub fn analyse(ranks: &dyn Ranks, share: &Share, options: &Options) -> Result<Analysis, Error> {
    agree_on_options(ranks, options)?;
    let layout = Layout::new(ranks, &share.owned)?;
    agree(ranks, check(ranks, &layout, share, options))?;
    let rows = &share.rows;
    agree(ranks, check_numbers(ranks, rows).map_err(Error::from))?;
    let touched = TouchedDofs::by(rows, &share.owned);
    let (directory, known) = Directory::new(ranks, &layout, &touched, &share.prescribed);
    let directory = agree(ranks, directory.map_err(Error::from))?;
    let job = AttemptInput { ranks, layout: &layout, rows, touched: &touched, known: &known, options };
    let whole = ConnectedComponents::find(ranks, &layout, (rows, &touched, &known), |_| true);
    let mut may_peel = peelable(&job, &whole);
    let mut attempts = 0;
    let attempt = loop {
        attempts += 1;
        let attempt = job.attempt(&whole, &may_peel)?;
        if !withdraw(ranks, &whole, &attempt, &mut may_peel) {
            break attempt;
        }
    };
    let Attempt { mut findings, confidence, mut work, .. } = attempt;
    work.attempts = attempts;
    let mut needed: Vec<u64> = share.needed.clone();
    needed.sort_unstable();
    needed.dedup();
    let reduction = findings.reduction.sort();
    let needed = request_rows(ranks, &layout, &reduction, &needed).sort();
    findings.generated.sort_unstable_by_key(|&(dof, _)| dof);
    findings.unmet.sort_unstable();
    let mut kinds = vec![Kind::Independent; rows.len()];
    findings.dependent.iter().for_each(|d| kinds[d.equation] = d.kind);
    let counted = |kind| kinds.iter().filter(|&&k| k == kind).count() as u64;
    let mut counts = [rows.len() as u64, counted(Kind::Redundant), counted(Kind::Conflicting)];
    ranks.sum(&mut counts);
    let [equations, redundant, conflicting] = counts;
    Ok(Analysis {
        counts: JobCounts { equations, redundant, conflicting, dofs: layout.dofs() },
        rank_of_job: ranks.rank(),
        layout,
        kinds,
        dependent: findings.dependent,
        generated: findings.generated,
        unmet_equations: findings.unmet,
        confidence,
        slaves: reduction.slaves().collect(),
        reduction,
        needed,
        directory,
        work,
    })
}

/// Checks the share and the options of this rank.
fn check(ranks: &dyn Ranks, layout: &Layout, share: &Share, options: &Options) -> Result<(), Error> {
    let (rank, dofs) = (ranks.rank(), layout.dofs());
    options.validate()?;
    let preferences = &options.preferences;
    let outside = |j: &&usize| **j as u64 >= dofs;
    if let Some(&found) = preferences.masters.iter().chain(&preferences.slaves).find(outside) {
        return Err(OptionError::Preference { what: "DOF", found, count: dofs as usize }.into());
    }
    if let Some(&dof) = preferences.slaves.iter().find(|j| preferences.masters.contains(j)) {
        return Err(OptionError::Contradiction(dof).into());
    }
    share.check(rank, dofs).map_err(Error::from)
}

/// For each fragment (the portion of a component on this rank), whether its equations may be peeled: the options must allow it, several
/// ranks must hold equations of the component, and the component must neither mix units nor hold numbers of extreme magnitude.
fn peelable(job: &AttemptInput, whole: &ConnectedComponents) -> Vec<bool> {
    let options = job.options;
    let plain = options.presolve && matches!(options.tolerance, qless::Tolerance::Relative(_));
    let allowed = plain && options.preferences == qless::Preferences::default();
    let own: Vec<[u64; 3]> = sizes(job.rows, job.touched, job.known, whole).into_iter().map(Sizes::words).collect();
    let combine = |total: &mut [u64; 3], own: &[u64; 3]| (0..3).for_each(|k| total[k] += own[k]);
    let components = whole.total(job.ranks, &own, combine);
    let own = job.ranks.rank();
    let may = |c: &ConnectedComponent<3>| u64::from(allowed && c.crosses(own) && Sizes::are_even(&c.total));
    let may_peel = whole.broadcast(job.ranks, &components, &components.iter().map(may).collect::<Vec<_>>());
    may_peel.into_iter().map(|word| word == 1).collect()
}

/// Forbids peeling in the components in which the attempt should not have peeled. Returns whether there are any.
fn withdraw(ranks: &dyn Ranks, whole: &ConnectedComponents, attempt: &Attempt, may_peel: &mut [bool]) -> bool {
    let own: Vec<[u64; 1]> = attempt.unsound.iter().map(|&unsound| [u64::from(unsound)]).collect();
    let mut any = [own.iter().map(|of| of[0]).sum()];
    ranks.sum(&mut any);
    if any[0] == 0 {
        return false;
    }
    let components = whole.total(ranks, &own, |total, own| total[0] |= own[0]);
    let unsound: Vec<u64> = components.iter().map(|component| component.total[0]).collect();
    let unsound = whole.broadcast(ranks, &components, &unsound);
    may_peel.iter_mut().zip(unsound).for_each(|(may, unsound)| *may &= unsound == 0);
    true
}

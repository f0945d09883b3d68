//! The analysis across ranks, stage by stage.

use qless::{Kind, OptionError, Options};

use super::attempt::{Attempt, AttemptInput};
use super::{Analysis, Counts};
use crate::distribute::{Sizes, sizes};
use crate::error::{Error, agree};
use crate::parts::{ConnectedComponent, ConnectedComponents, Directory, Layout, TouchedDofs};
use crate::ranks::Ranks;
use crate::share::{Share, check_numbers};
use crate::solve::ask;

/// Diagnoses the equations of all ranks and solves them for slaves. Collective: every rank gives its share and the same options, and
/// gets back what concerns its equations and DOFs.
///
/// The result is that of [`qless::analyse`] for all equations in the order of their numbers, whoever holds them and however many ranks
/// there are. Cost: about 40 bytes sent for each DOF of a rank's equations, and each equation at most once, to the rank that
/// analyses its component; rounds grow with the logarithm of the number of ranks that a component crosses.
///
/// ```
/// use qless::{Kind, Options};
/// use qless_mpi::{Share, analyse, together};
/// // u1 = u0 on one rank, u2 = u1 on the next, and on both the sum of the two, which is redundant there.
/// let kinds = together(2, |ranks| {
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
    let layout = Layout::new(ranks, &share.owned)?;
    agree(ranks, check(ranks, &layout, share, options))?;
    let rows = &share.rows;
    agree(ranks, check_numbers(ranks, rows).map_err(Error::from))?;
    let touched = TouchedDofs::by(rows, &share.owned);
    let (directory, known) = Directory::new(ranks, &layout, &touched, &share.prescribed);
    let directory = agree(ranks, directory.map_err(Error::from))?;
    let job = AttemptInput { ranks, layout: &layout, rows, touched: &touched, known: &known, options };
    let whole = ConnectedComponents::of(ranks, &layout, (rows, &touched, &known), |_| true);
    let mut may_peel = peelable(&job, &whole);
    let mut attempts = 0;
    let attempt = loop {
        attempts += 1;
        let attempt = job.attempt(&whole, &may_peel)?;
        if !withdraw(ranks, &whole, &attempt, &mut may_peel) {
            break attempt;
        }
    };
    let Attempt { mut findings, confidence, mut dealt, .. } = attempt;
    dealt.attempts = attempts;
    let mut needed: Vec<u64> = share.needed.clone();
    needed.sort_unstable();
    needed.dedup();
    let lines = findings.lines.sort();
    let needed = ask(ranks, &layout, &lines, &needed).sort();
    findings.generated.sort_unstable_by_key(|&(dof, _)| dof);
    findings.unmet.sort_unstable();
    let mut kinds = vec![Kind::Independent; rows.len()];
    findings.dependent.iter().for_each(|d| kinds[d.equation] = d.kind);
    let counted = |kind| kinds.iter().filter(|&&k| k == kind).count() as u64;
    let mut counts = [rows.len() as u64, counted(Kind::Redundant), counted(Kind::Conflicting)];
    ranks.sum(&mut counts);
    let [equations, redundant, conflicting] = counts;
    Ok(Analysis {
        counts: Counts { equations, redundant, conflicting, dofs: layout.dofs() },
        rank_of_job: ranks.rank(),
        layout,
        kinds,
        dependent: findings.dependent,
        generated: findings.generated,
        unmet_equations: findings.unmet,
        confidence,
        slaves: lines.slaves().collect(),
        lines,
        needed,
        directory,
        dealt,
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

/// The local parts in which equations may be peeled: their component crosses ranks and does not mix units.
fn peelable(job: &AttemptInput, whole: &ConnectedComponents) -> Vec<bool> {
    let options = job.options;
    let plain = options.presolve && matches!(options.tolerance, qless::Tolerance::Relative(_));
    let allowed = plain && options.preferences == qless::Preferences::default();
    let own: Vec<[u64; 3]> = sizes(job.rows, job.touched, job.known, whole).into_iter().map(Sizes::words).collect();
    let combine = |total: &mut [u64; 3], part: &[u64; 3]| (0..3).for_each(|k| total[k] += part[k]);
    let components = whole.total(job.ranks, &own, combine);
    let own = job.ranks.rank();
    let may = |c: &ConnectedComponent<3>| u64::from(allowed && c.crosses(own) && Sizes::are_even(&c.total));
    let told = whole.tell(job.ranks, &components, &components.iter().map(may).collect::<Vec<_>>());
    told.into_iter().map(|word| word == 1).collect()
}

/// Forbids peeling in the components in which the attempt should not have peeled. Returns whether there are any.
fn withdraw(ranks: &dyn Ranks, whole: &ConnectedComponents, attempt: &Attempt, may_peel: &mut [bool]) -> bool {
    let own: Vec<[u64; 1]> = attempt.troubled.iter().map(|&troubled| [u64::from(troubled)]).collect();
    let mut any = [own.iter().map(|of| of[0]).sum()];
    ranks.sum(&mut any);
    if any[0] == 0 {
        return false;
    }
    let components = whole.total(ranks, &own, |total, part| total[0] |= part[0]);
    let troubled: Vec<u64> = components.iter().map(|component| component.total[0]).collect();
    let told = whole.tell(ranks, &components, &troubled);
    may_peel.iter_mut().zip(told).for_each(|(may, troubled)| *may &= troubled == 0);
    true
}

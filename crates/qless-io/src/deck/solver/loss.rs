//! Finds what a load case loses because its solver drops equations and values.
//!
//! Let E be the equations and values that the solver keeps. A dropped equation or value is *implied* if it is a combination of E that
//! agrees with the right-hand sides of E. Then the result is the same without it. Otherwise it is *lost*. Each lost one that is independent
//! of E, and of the lost ones before it, sets one motion free.

use qless::{Analysis, Kind, Options, Preferences, analyse};

use super::{Finding, Outcome};
use crate::deck::faults::FaultKind;
use crate::deck::{Dof, LoadCase, Model, Solver};

/// Equations and values that a solver drops although the kept ones do not imply them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Loss {
    /// The lost equations, ascending.
    pub equations: Vec<usize>,
    /// The DOFs whose prescribed values are lost, ascending.
    pub values: Vec<Dof>,
    /// One DOF for each motion that becomes free: the slave of a lost equation, or a DOF with a lost value.
    pub freed: Vec<Dof>,
}

impl Loss {
    /// Whether the solver drops an equation or a value because of the finding, and this loss contains that equation or value.
    pub fn contains(&self, finding: &Finding) -> bool {
        let is_lost = |i| self.equations.binary_search(&i).is_ok();
        let is_value = |dof| self.values.binary_search(&dof).is_ok();
        finding.dropped().is_some_and(is_lost) || dropped_value(finding).is_some_and(is_value)
    }
}

/// The loss of a load case with these [`findings`](super::findings). If the analysis fails, everything that the solver drops counts as
/// lost.
///
/// ```
/// use qless_io::deck::{Solver, clean, read};
/// # let place = tempfile::tempdir()?;
/// let path = place.path().join("bodies.inp");
/// let nodes = "*NODE\n1,0.,0.,0.\n2,1.,0.,0.\n3,0.,1.,0.\n4,1.,1.,0.\n*NSET,NSET=A\n1\n";
/// let bodies = "*RIGID BODY,NSET=A,REF NODE=2,ROT NODE=3\n*RIGID BODY,NSET=A,REF NODE=4,ROT NODE=3\n";
/// std::fs::write(&path, format!("{nodes}{bodies}"))?;
/// let deck = read(&path)?;
/// let (model, case) = (deck.model(), &deck.model().cases()[0]);
/// let findings = clean::findings(model, case, Solver::Ccx);
/// let loss = clean::loss(model, case, &findings, Solver::Ccx, &qless::Options::default());
/// assert_eq!((loss.equations, loss.freed.len()), (vec![3, 4, 5], 3));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn loss(model: &Model, case: &LoadCase, findings: &[Finding], solver: Solver, options: &Options) -> Loss {
    let dropped = Dropped::collect(model, case, findings, solver);
    if dropped.rows.is_empty() {
        return Loss::default();
    }
    let mut is_dropped = vec![false; dropped.count];
    dropped.rows.iter().for_each(|&row| is_dropped[row] = true);
    let equations = (0..dropped.count).filter(|&row| !is_dropped[row]).collect();
    let options = Options { preferences: Preferences { equations, ..Preferences::default() }, ..options.clone() };
    let analysis = model.system(&dropped.case).ok().and_then(|system| analyse(&system, &options).ok());
    let mut loss = Loss::default();
    for &row in dropped.rows.iter().filter(|&&row| !analysis.as_ref().is_some_and(|it| implied(it, row, &is_dropped))) {
        let dof = dropped.add_to(&mut loss, model, row);
        if analysis.as_ref().is_some_and(|analysis| analysis.kinds()[row] == Kind::Independent) {
            loss.freed.extend(dof);
        }
    }
    loss.values.sort_unstable();
    loss
}

/// Whether the kept rows alone imply a dropped row. The analysis prefers kept rows for its basis, so the certificate of a row contains
/// dropped rows only if it needs them.
fn implied(analysis: &Analysis, row: usize, is_dropped: &[bool]) -> bool {
    let needs_dropped = || analysis.because(row).is_ok_and(|terms| terms.iter().any(|term| is_dropped[term.row]));
    analysis.kinds()[row] == Kind::Redundant && !needs_dropped()
}

/// The rows of a load case's system that the solver drops.
struct Dropped {
    /// The load case, with the values that the solver drops moved to `clashes`: there, each value is a row of the system.
    case: LoadCase,
    /// The indices of the equations in force. They are the first rows of the system.
    in_force: Vec<usize>,
    /// Number of rows of the system.
    count: usize,
    /// The rows that the solver drops, ascending.
    rows: Vec<usize>,
}

impl Dropped {
    fn collect(model: &Model, case: &LoadCase, findings: &[Finding], solver: Solver) -> Self {
        let in_force: Vec<usize> = model.in_force(case).collect();
        let equations = findings.iter().filter_map(Finding::dropped);
        let mut rows: Vec<usize> = equations.filter_map(|i| in_force.binary_search(&i).ok()).collect();
        let mut case = case.clone();
        let first_dropped = in_force.len() + if solver.prescribed_twice().ignores() { 0 } else { case.clashes.len() };
        keep_last_values(&mut case);
        for dof in findings.iter().filter_map(dropped_value) {
            if let Ok(at) = case.prescribed.binary_search_by_key(&dof, |given| given.dof) {
                case.clashes.push(case.prescribed.remove(at));
            }
        }
        let count = in_force.len() + case.clashes.len();
        rows.extend(first_dropped..count);
        rows.sort_unstable();
        rows.dedup();
        Self { case, in_force, count, rows }
    }

    /// Adds a lost row to the loss. Returns its DOF: the slave of the equation, or the DOF of the value.
    fn add_to(&self, loss: &mut Loss, model: &Model, row: usize) -> Option<Dof> {
        if let Some(&i) = self.in_force.get(row) {
            loss.equations.push(i);
            return model.nth(i).columns.first().map(|&j| model.dofs[j as usize]);
        }
        let dof = self.case.clashes[row - self.in_force.len()].dof;
        loss.values.push(dof);
        Some(dof)
    }
}

/// The DOF whose prescribed value the solver drops because of the finding; `None` if it drops no value.
fn dropped_value(finding: &Finding) -> Option<Dof> {
    let is_value = matches!(finding.fault.kind, FaultKind::SlavePrescribed { .. });
    (finding.outcome == Outcome::IgnoresSecond && is_value).then_some(finding.fault.slave)
}

/// Exchanges the values of each DOF that has several, such that the last value is prescribed and the others clash with it.
fn keep_last_values(case: &mut LoadCase) {
    for clash in &mut case.clashes {
        if let Ok(at) = case.prescribed.binary_search_by_key(&clash.dof, |given| given.dof) {
            std::mem::swap(&mut case.prescribed[at], clash);
        }
    }
}

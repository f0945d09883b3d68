//! What must change in a deck, and why.

use qless::{Analysis, Kind, Options, Preferences, analyse};
use rustc_hash::{FxHashMap, FxHashSet};

use super::CleanError;
use super::fault::{Fault, faults_of};
use super::parts::{parts, text_of};
use crate::deck::{Dof, LoadCase, Model, Origin};

/// What changes: equations that go, and those that come.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plan {
    /// Equations whose text goes, ascending.
    pub removed: Vec<Removed>,
    /// Equations that are written in their place.
    pub written: Vec<Written>,
}

/// An equation whose text goes.
#[derive(Clone, Debug, PartialEq)]
pub struct Removed {
    /// Its number, from 0.
    pub equation: usize,
    /// Why.
    pub reason: Reason,
}

/// Why an equation's text goes.
#[derive(Clone, Debug, PartialEq)]
pub enum Reason {
    /// It is this combination of others: equation from 0 and coefficient; empty where it holds no free DOF.
    Redundant(Vec<(usize, f64)>),
    /// It is written anew because of this fault.
    Fault(Fault),
    /// It is written anew because another one of its part is.
    Connected,
}

/// `slave + sum a_j u_j = rhs`.
#[derive(Clone, Debug, PartialEq)]
pub struct Written {
    /// The slave; its coefficient is 1.
    pub slave: Dof,
    /// The other terms: masters, then prescribed DOFs.
    pub terms: Vec<(Dof, f64)>,
    /// The right-hand side.
    pub rhs: f64,
}

impl Plan {
    /// Whether nothing changes.
    pub fn is_empty(&self) -> bool {
        self.removed.is_empty()
    }

    /// Equations that go are there, ascending, and so are those that explain why.
    pub(super) fn check(&self, model: &Model) -> Result<(), CleanError> {
        let count = model.equations();
        let mut next = 0;
        for removed in &self.removed {
            let because = match &removed.reason {
                Reason::Redundant(because) => because.iter().map(|&(i, _)| i).max(),
                Reason::Fault(_) | Reason::Connected => None,
            };
            let named = because.into_iter().chain([removed.equation]).find(|&i| i >= count);
            let outside = named.or((removed.equation < next).then_some(removed.equation));
            outside.map_or(Ok(()), |equation| Err(CleanError::Foreign { equation, count }))?;
            next = removed.equation + 1;
        }
        Ok(())
    }
}

/// Decides what must change so that the equations are independent, each slave once and never prescribed.
///
/// # Errors
/// [`CleanError`]: conflicting equations, load cases that no single set serves, or cards that cannot be replaced.
///
/// ```
/// # let place = tempfile::tempdir()?;
/// let path = place.path().join("tie.inp");
/// std::fs::write(&path, "*EQUATION\n2\n1,1,1.,2,1,-1.\n2\n2,1,3.,1,1,-3.\n")?;
/// let deck = qless_io::deck::read(&path)?;
/// let plan = qless_io::deck::clean::plan(&deck.model(), &qless::Options::default())?;
/// assert_eq!((plan.removed[0].equation, plan.written.len()), (1, 0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn plan(model: &Model, options: &Options) -> Result<Plan, CleanError> {
    let prescribed = prescribed_in(model, &model.cases);
    let before = faults_of(model, &prescribed, &vec![false; model.equations()]);
    let is_vanishing = |fault: &&Fault| matches!(fault, Fault::SlaveVanishes { .. });
    let vanishing: FxHashSet<usize> = before.iter().filter(is_vanishing).map(Fault::equation).collect();
    let common = Common::new(model, &prescribed, &vanishing, options)?;
    for (k, case) in model.cases.iter().enumerate() {
        if k == 0 || !case.constrains_as(&model.cases[k - 1]) {
            check(model, case, &common, options)?;
        }
    }
    let is_dependent: Vec<bool> =
        common.analysis.kinds()[..model.equations()].iter().map(|kind| *kind != Kind::Independent).collect();
    let after = faults_of(model, &prescribed, &is_dependent);
    let fault_of: FxHashMap<usize, Fault> = before.iter().rev().map(|fault| (fault.equation(), *fault)).collect();
    let part_of = parts(model, |j| prescribed.contains_key(&j));
    let count = part_of.iter().max().map_or(0, |last| last + 1);
    let mut rewrite = vec![false; count];
    after.iter().for_each(|fault| rewrite[part_of[fault.equation()]] = true);
    shared_text(model, &is_dependent).for_each(|i| rewrite[part_of[i]] = true);
    let removed: Vec<Removed> = (0..model.equations())
        .filter(|&i| is_dependent[i] || rewrite[part_of[i]])
        .map(|i| Removed { equation: i, reason: common.reason(i, &fault_of) })
        .collect();
    check_removable(model, &removed)?;
    let written = if rewrite.contains(&true) { common.written(model, &part_of, &rewrite)? } else { Vec::new() };
    Ok(Plan { removed, written })
}

/// Columns that are prescribed in any of these load cases, and where.
pub(super) fn prescribed_in<'a>(
    model: &Model,
    cases: impl IntoIterator<Item = &'a LoadCase>,
) -> FxHashMap<u32, Origin> {
    let mut prescribed = FxHashMap::default();
    for given in cases.into_iter().flat_map(|case| &case.prescribed) {
        if let Some(column) = model.column(given.dof) {
            prescribed.entry(column).or_insert(given.origin);
        }
    }
    prescribed
}

/// The equations with every DOF prescribed that is so in any load case.
struct Common {
    analysis: Analysis,
}

impl Common {
    fn new(
        model: &Model,
        prescribed: &FxHashMap<u32, Origin>,
        vanishing: &FxHashSet<usize>,
        options: &Options,
    ) -> Result<Self, CleanError> {
        let origin = |column: &u32| crate::deck::Prescribed {
            dof: model.dofs[*column as usize],
            value: 0.0,
            course: 0,
            origin: prescribed[column],
        };
        let case = LoadCase { prescribed: prescribed.keys().map(origin).collect(), ..LoadCase::default() };
        let system = model.system(&case)?;
        let fixed = |i: &usize| model.cards.nth(model.nth(*i).origin.card).is_fixed;
        // The deck's own slaves, but for those that would make others large.
        let first = |i: usize| model.nth(i).columns.first().copied().filter(|_| !vanishing.contains(&i));
        let mut slaves: Vec<usize> = (0..model.equations()).filter_map(first).map(|j| j as usize).collect();
        slaves.sort_unstable();
        slaves.dedup();
        slaves.retain(|&j| !prescribed.contains_key(&(j as u32)));
        let equations = (0..model.equations()).filter(fixed).collect();
        let preferences = Preferences { slaves, equations, ..Preferences::default() };
        let options = Options { preferences, ..options.clone() };
        let analysis = analyse(&system, &options)?;
        Ok(Self { analysis })
    }

    fn reason(&self, i: usize, fault_of: &FxHashMap<usize, Fault>) -> Reason {
        if self.analysis.dependent().binary_search_by_key(&i, |dependent| dependent.row).is_ok() {
            let because = self.analysis.because(i).unwrap_or_default();
            return Reason::Redundant(because.iter().map(|term| (term.row, term.coefficient)).collect());
        }
        fault_of.get(&i).map_or(Reason::Connected, |fault| Reason::Fault(*fault))
    }

    /// `u_s - T u_q - G u_p = g` for the slaves of the parts that are written anew.
    fn written(&self, model: &Model, part_of: &[usize], rewrite: &[bool]) -> Result<Vec<Written>, CleanError> {
        let mut concerned = vec![false; model.dofs.len()];
        for i in (0..model.equations()).filter(|&i| rewrite[part_of[i]]) {
            let equation = model.nth(i);
            let terms = equation.columns.iter().zip(equation.coefficients).filter(|(_, a)| **a != 0.0);
            terms.for_each(|(&j, _)| concerned[j as usize] = true);
        }
        let reduction = self.analysis.reduction()?;
        // What sums of right-hand sides leave by rounding is none.
        let rounding = 1e-14 * (0..model.equations()).fold(0.0, |size: f64, i| size.max(model.nth(i).rhs.abs()));
        let mut written = Vec::new();
        for (row, &slave) in reduction.slaves().iter().enumerate().filter(|(_, slave)| concerned[**slave]) {
            let masters = reduction.t().row(row).map(|(j, v)| (model.dofs[reduction.masters()[j]], -v));
            let given = reduction.g_matrix().row(row).map(|(j, v)| (model.dofs[reduction.prescribed()[j]], -v));
            let terms = masters.chain(given).filter(|term| term.1 != 0.0).collect();
            written.push(Written {
                slave: model.dofs[slave],
                terms,
                rhs: if reduction.g()[row].abs() <= rounding { 0.0 } else { reduction.g()[row] },
            });
        }
        Ok(written)
    }
}

/// Equations that are dependent where others written in the same lines are not.
fn shared_text<'a>(model: &'a Model, is_dependent: &'a [bool]) -> impl Iterator<Item = usize> + 'a {
    let mut independent = rustc_hash::FxHashSet::default();
    for i in (0..model.equations()).filter(|&i| !is_dependent[i]) {
        independent.insert(text_of(model.nth(i).origin));
    }
    (0..model.equations()).filter(move |&i| is_dependent[i] && independent.contains(&text_of(model.nth(i).origin)))
}

/// A load case must not conflict, and must need no more equations than can be kept.
fn check(model: &Model, case: &LoadCase, common: &Common, options: &Options) -> Result<(), CleanError> {
    let analysis = analyse(&model.system(case)?, options)?;
    if analysis.dependent().iter().any(|dependent| dependent.kind == Kind::Conflicting) {
        return Err(CleanError::Conflicting { case: case.name.clone() });
    }
    let (found, rank) = (analysis.rank(), common.analysis.rank());
    if found > rank || !case.removed.is_empty() && rank < model.equations() {
        return Err(CleanError::CasesDiffer { case: case.name.clone(), found, common: rank });
    }
    Ok(())
}

/// Cards that equations cannot stand in for must not be among those that go; what is said first is what is wrong itself.
fn check_removable(model: &Model, removed: &[Removed]) -> Result<(), CleanError> {
    let card = |removed: &Removed| model.nth(removed.equation).origin.card;
    let weight = |reason: &Reason| match reason {
        Reason::Fault(_) => 0,
        Reason::Redundant(_) => 1,
        Reason::Connected => 2,
    };
    let fixed = removed.iter().filter(|removed| model.cards.nth(card(removed)).is_fixed);
    let Some(first) = fixed.min_by_key(|removed| weight(&removed.reason)) else { return Ok(()) };
    let why = match &first.reason {
        Reason::Fault(fault) => fault.describe(model),
        Reason::Redundant(_) => "it repeats what other such cards say".to_owned(),
        Reason::Connected => "an equation that shares DOFs with it has to be".to_owned(),
    };
    Err(CleanError::Fixed { place: model.place(model.nth(first.equation).origin), why })
}

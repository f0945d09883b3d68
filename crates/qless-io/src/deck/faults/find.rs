//! Finds the faults of a deck's equations.

use qless::{Options, SystemBuilder, analyse};
use rustc_hash::{FxHashMap, FxHashSet};

use super::{EquationFault, FaultKind, keeps_slaves};
use crate::deck::{Dof, LoadCase, Model, Origin};

/// The coefficient of a slave counts as zero below this fraction of the largest coefficient. Dividing by so small a coefficient magnifies
/// rounding errors by up to the inverse of the fraction.
const SMALL: f64 = 1e-6;

/// The faults of a deck's equations, each only once, in the order of the load cases.
pub fn faults(model: &Model) -> Vec<EquationFault> {
    let mut all: Vec<EquationFault> = Vec::new();
    for (k, case) in model.cases.iter().enumerate() {
        if k == 0 || !case.constrains_as(&model.cases[k - 1]) {
            let known: FxHashSet<EquationFault> = all.iter().copied().collect();
            all.extend(faults_in(model, case).into_iter().filter(|fault| !known.contains(fault)));
        }
    }
    all
}

/// The faults of the equations in force in a load case.
///
/// ```
/// # let place = tempfile::tempdir()?;
/// let path = place.path().join("tie.inp");
/// std::fs::write(&path, "*BOUNDARY\n1,1\n*EQUATION\n2\n1,1,1.,2,1,-1.\n")?;
/// let deck = qless_io::deck::read(&path)?;
/// let faults = qless_io::deck::clean::faults_in(deck.model(), &deck.model().cases()[0]);
/// assert_eq!(
///     faults[0].describe(deck.model()),
///     "1:1 is the slave of line 4 *EQUATION, and prescribed in line 2 *BOUNDARY"
/// );
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn faults_in(model: &Model, case: &LoadCase) -> Vec<EquationFault> {
    let mut left_out = vec![false; model.equations()];
    case.removed.iter().for_each(|&i| left_out[i as usize] = true);
    faults_of(model, &model.prescribed_in([case]), &left_out)
}

/// The faults of the equations that are not left out. `prescribed` maps each prescribed column to its card.
pub fn faults_of(model: &Model, prescribed: &FxHashMap<u32, Origin>, left_out: &[bool]) -> Vec<EquationFault> {
    let kept = || (0..model.equations()).filter(|&i| !left_out[i] && model.has_slave(i));
    let mut slave_of: FxHashMap<u32, usize> = FxHashMap::default();
    let mut faults = Vec::new();
    for i in kept() {
        let equation = model.nth(i);
        let Some(&column) = equation.columns.first() else { continue };
        let slave = model.dofs[column as usize];
        let mut add = |kind| faults.push(EquationFault { equation: i, slave, kind });
        if let Some(why) = model.why_missing(i) {
            add(FaultKind::Missing { why });
        }
        let same = |&(j, _): &(&u32, &f64)| *j == column;
        let own: f64 = equation.columns.iter().zip(equation.coefficients).filter(same).map(|(_, a)| a).sum();
        let terms = equation.columns.iter().zip(equation.coefficients);
        let alike = |j: u32| unit_of(model.dofs[j as usize]) == unit_of(slave);
        let free = terms.filter(|(j, _)| !prescribed.contains_key(j) && alike(**j));
        let largest = free.fold(0.0_f64, |largest, (_, a)| largest.max(a.abs()));
        if own == 0.0 || own.abs() <= SMALL * largest {
            add(FaultKind::SlaveVanishes);
        }
        if let Some(&by) = prescribed.get(&column) {
            add(FaultKind::SlavePrescribed { by, since: since(model, slave) });
        }
        if let Some(by) = model.claimed(slave) {
            add(FaultKind::SlaveClaimed { by });
        }
        match slave_of.get(&column) {
            Some(&first) => add(FaultKind::SlaveTwice { first }),
            None => drop(slave_of.insert(column, i)),
        }
    }
    faults.extend(coupled_faults(model, prescribed, left_out));
    faults.extend(repeated_faults(model, prescribed, kept()));
    faults.extend(circles(model, &slave_of));
    faults
}

/// The index of the first load case that prescribes a DOF.
fn since(model: &Model, dof: Dof) -> usize {
    let prescribes = |case: &LoadCase| case.prescribed.binary_search_by_key(&dof, |given| given.dof).is_ok();
    model.cases.iter().position(prescribes).unwrap_or(0)
}

/// A number for the unit of a DOF. Coefficients of translations and of rotations cannot be compared, because their units differ.
fn unit_of(dof: Dof) -> u8 {
    match dof.component {
        1..=3 => 1,
        4..=6 => 4,
        other => other,
    }
}

/// Finds circles: slaves that depend on one another. A circle is a fault only if its equations do not determine the slaves, or if ccx
/// cannot insert the equations into one another.
fn circles(model: &Model, slave_of: &FxHashMap<u32, usize>) -> Vec<EquationFault> {
    let masters = |i: usize| {
        let equation = model.nth(i);
        let own = equation.columns.first().copied();
        let terms = equation.columns.iter().zip(equation.coefficients);
        terms.filter(move |(j, a)| Some(**j) != own && **a != 0.0).filter_map(|(j, _)| slave_of.get(j).copied())
    };
    let pairs = || slave_of.values().flat_map(|&i| masters(i).map(move |j| (i, j)));
    // An equation is in no circle if none of its masters is a slave of another equation, or if its slave is a master of none.
    let mut circle: FxHashSet<usize> = slave_of.values().copied().collect();
    keep_waiting(&mut circle, pairs());
    keep_waiting(&mut circle, pairs().map(|(i, j)| (j, i)));
    let mut circle: Vec<usize> = circle.into_iter().collect();
    circle.sort_unstable();
    // Only ccx keeps repeated terms, and only ccx inserts equations without pivoting.
    let cancels = || model.keeps_repeated_terms && keeps_slaves(model, &circle) == Some(false);
    if circle.is_empty() || determines_slaves(model, &circle) && !cancels() {
        return Vec::new();
    }
    let slave = |i: usize| model.dofs[model.nth(i).columns[0] as usize];
    circle.into_iter().map(|i| EquationFault { equation: i, slave: slave(i), kind: FaultKind::Circle }).collect()
}

/// A pair `(i, j)` says that equation i waits for equation j. Removes every equation from `left` that waits for no equation in `left`,
/// until all that remain wait for one.
fn keep_waiting(left: &mut FxHashSet<usize>, pairs: impl Iterator<Item = (usize, usize)>) {
    let mut waits: FxHashMap<usize, usize> = FxHashMap::default();
    let mut users: FxHashMap<usize, Vec<usize>> = FxHashMap::default();
    for (i, j) in pairs.filter(|(i, j)| left.contains(i) && left.contains(j)) {
        *waits.entry(i).or_default() += 1;
        users.entry(j).or_default().push(i);
    }
    let mut ready: Vec<usize> = left.iter().copied().filter(|i| !waits.contains_key(i)).collect();
    while let Some(done) = ready.pop() {
        left.remove(&done);
        for user in users.remove(&done).unwrap_or_default() {
            if let Some(count) = waits.get_mut(&user) {
                *count -= 1;
                if *count == 0 {
                    ready.push(user);
                }
            }
        }
    }
}

/// Whether the equations certainly determine their slaves: the square matrix of the slaves' coefficients has full rank.
fn determines_slaves(model: &Model, equations: &[usize]) -> bool {
    let slaves: FxHashMap<u32, usize> = equations.iter().map(|&i| model.nth(i).columns[0]).zip(0..).collect();
    let mut builder = SystemBuilder::new(equations.len());
    for &i in equations {
        let equation = model.nth(i);
        let terms = equation.columns.iter().zip(equation.coefficients);
        builder.equation(terms.filter_map(|(j, a)| Some((*slaves.get(j)?, *a))), 0.0);
    }
    let analysis = builder.build().ok().and_then(|system| analyse(&system, &Options::default()).ok());
    analysis.is_some_and(|analysis| analysis.rank() == equations.len() && !analysis.confidence().ambiguous)
}

/// A DOF of a coupled set of ANSYS, whose equations are `u_j - u_1 = 0`. No DOF may be in two sets, or be prescribed. This also holds for
/// the first DOF of a set, although it is no slave.
#[derive(Clone, Copy)]
struct CoupledDof {
    equation: usize,
    card: u32,
    is_first: bool,
}

/// Finds the faults of the first DOFs of coupled sets. The other DOFs of a set are slaves, which [`faults_of`] checks.
fn coupled_faults(model: &Model, prescribed: &FxHashMap<u32, Origin>, left_out: &[bool]) -> Vec<EquationFault> {
    let mut known: FxHashMap<u32, CoupledDof> = FxHashMap::default();
    let mut faults = Vec::new();
    let kept = (0..model.equations()).filter(|&i| !left_out[i]).map(|i| (i, model.nth(i).origin.card));
    for (equation, card) in kept.filter(|&(_, card)| model.cards.nth(card).name.is_numbered("CP")) {
        let [slave, first] = model.nth(equation).columns[..] else { continue };
        for (column, is_first) in [(slave, false), (first, true)] {
            let fault = |kind| EquationFault { equation, slave: model.dofs[column as usize], kind };
            let member = CoupledDof { equation, card, is_first };
            let before = *known.entry(column).or_insert(member);
            let is_new = before.equation == equation || before.card != card;
            if is_first && is_new {
                faults.extend(prescribed.get(&column).map(|&by| fault(FaultKind::CoupledPrescribed { by })));
            }
            if before.card != card && (is_first || before.is_first) {
                faults.push(fault(FaultKind::CoupledTwice { first: before.equation }));
                known.insert(column, member);
            }
        }
    }
    faults
}

/// Finds masters that an `*EQUATION` names twice. ccx 2.20 adds up such terms only if the slave is named twice too, or if it inserts
/// another equation into this one. Otherwise it continues with a wrong stiffness, without a message. Each term at a node with local axes
/// stands for three global DOFs, so two components of the node name these DOFs twice.
fn repeated_faults(
    model: &Model,
    prescribed: &FxHashMap<u32, Origin>,
    kept: impl Iterator<Item = usize> + Clone,
) -> Vec<EquationFault> {
    if !model.keeps_repeated_terms {
        return Vec::new();
    }
    let dof = |j: u32| model.dofs[j as usize];
    let slaves = kept.clone().filter_map(|i| model.nth(i).columns.first().map(|&j| (model.as_global(dof(j)), i)));
    let mut held: FxHashMap<Dof, usize> = slaves.collect();
    // A value prescribed along local axes counts as an equation here, because ccx treats it as one.
    let given = prescribed.keys().map(|&j| model.as_global(dof(j))).filter(|dof| dof.component == 0);
    held.extend(given.map(|dof| (dof, usize::MAX)));
    let is_equation = |i: &usize| model.cards.nth(model.nth(*i).origin.card).name == "*EQUATION";
    let fault = |i: usize| {
        let equation = model.nth(i);
        let terms = equation.columns.iter().zip(equation.coefficients).filter(|(_, a)| **a != 0.0);
        let mut terms = terms.map(|(&j, _)| dof(j));
        let slave = terms.next()?;
        let is_prescribed = |dof: &Dof| model.column(*dof).is_some_and(|j| prescribed.contains_key(&j));
        let masters: Vec<Dof> = terms.filter(|dof| !is_prescribed(dof)).collect();
        let own = model.as_global(slave);
        let is_inserted = |dof: &Dof| held.get(dof).is_some_and(|&by| by != i);
        if masters.iter().map(|dof| model.as_global(*dof)).any(|dof| dof == own || is_inserted(&dof)) {
            return None;
        }
        let mut seen = FxHashSet::default();
        let master = masters.into_iter().find(|dof| !seen.insert(model.as_global(*dof)))?;
        Some(EquationFault { equation: i, slave, kind: FaultKind::MasterTwice { master } })
    };
    kept.filter(is_equation).filter_map(fault).collect()
}

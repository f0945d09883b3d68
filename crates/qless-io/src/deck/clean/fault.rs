//! What a solver that eliminates the first DOF of each equation cannot take, besides dependent equations.

use qless::{Options, SystemBuilder, analyse};
use rustc_hash::{FxHashMap, FxHashSet};

use super::plan::prescribed_in;
use super::repeated::global;
use super::{coupled, repeated};
use crate::deck::{Dof, LoadCase, Model, Origin};

/// A fault of one equation. Equations are numbered from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Fault {
    /// The slave has a prescribed value.
    SlavePrescribed {
        /// The equation.
        equation: usize,
        /// Its slave.
        slave: Dof,
        /// Where the value is given.
        by: Origin,
        /// The first load case that prescribes it, from 0.
        since: usize,
    },
    /// The slave is that of an earlier equation too.
    SlaveTwice {
        /// The equation.
        equation: usize,
        /// Its slave.
        slave: Dof,
        /// The earlier equation.
        first: usize,
    },
    /// The slave's coefficient is zero, or vanishes beside the others.
    SlaveVanishes {
        /// The equation.
        equation: usize,
        /// Its slave.
        slave: Dof,
    },
    /// The slave is in a set that excludes slaves, such as Nastran's `ASET`.
    SlaveClaimed {
        /// The equation.
        equation: usize,
        /// Its slave.
        slave: Dof,
        /// Where it is put into the set.
        by: Origin,
    },
    /// A DOF of a coupled set of ANSYS is in an earlier one too, and the first of one of them.
    CoupledTwice {
        /// An equation of the set.
        equation: usize,
        /// The DOF.
        slave: Dof,
        /// An equation of the earlier set.
        first: usize,
    },
    /// The first DOF of a coupled set of ANSYS has a prescribed value.
    CoupledPrescribed {
        /// An equation of the set.
        equation: usize,
        /// The DOF.
        slave: Dof,
        /// Where the value is given.
        by: Origin,
    },
    /// A master is named twice, itself or through the axes of its node, and the solver does not add that up.
    MasterTwice {
        /// The equation.
        equation: usize,
        /// Its slave.
        slave: Dof,
        /// The master.
        master: Dof,
    },
    /// Slaves are expressed by each other in a circle, which leaves some of them next to undetermined.
    Circle {
        /// An equation of the circle.
        equation: usize,
        /// Its slave.
        slave: Dof,
    },
}

/// A slave's coefficient this much smaller than the largest one makes rounding errors as much larger.
const SMALL: f64 = 1e-6;

impl Fault {
    /// The equation at fault.
    pub fn equation(&self) -> usize {
        match *self {
            Self::SlavePrescribed { equation, .. }
            | Self::SlaveTwice { equation, .. }
            | Self::SlaveClaimed { equation, .. }
            | Self::SlaveVanishes { equation, .. }
            | Self::CoupledTwice { equation, .. }
            | Self::CoupledPrescribed { equation, .. }
            | Self::MasterTwice { equation, .. }
            | Self::Circle { equation, .. } => equation,
        }
    }

    /// Its slave, or the DOF of a coupled set.
    pub fn slave(&self) -> Dof {
        match *self {
            Self::SlavePrescribed { slave, .. }
            | Self::SlaveTwice { slave, .. }
            | Self::SlaveClaimed { slave, .. }
            | Self::SlaveVanishes { slave, .. }
            | Self::CoupledTwice { slave, .. }
            | Self::CoupledPrescribed { slave, .. }
            | Self::MasterTwice { slave, .. }
            | Self::Circle { slave, .. } => slave,
        }
    }

    /// In the deck's language: `1:3 is the slave of line 25 *EQUATION, and prescribed in line 19 *BOUNDARY`.
    pub fn describe(&self, model: &Model) -> String {
        let place =
            |i: usize| model.equation(i).map_or_else(|| format!("equation {}", i + 1), |e| model.place(e.origin));
        let name = |slave| model.dof_name(slave);
        match *self {
            Self::SlavePrescribed { equation, slave, by, since } => {
                let (equation, by, when) = (place(equation), model.place(by), when(model, since));
                format!("{} is the slave of {equation}, and prescribed in {by}{when}", name(slave))
            }
            Self::SlaveClaimed { equation, slave, by } => {
                let set = model.place(by);
                format!(
                    "{} is the slave of {}, and in the set of {set}, which excludes slaves",
                    name(slave),
                    place(equation)
                )
            }
            Self::SlaveTwice { equation, slave, first } => {
                format!("{} is the slave of {}, and of {}", name(slave), place(first), place(equation))
            }
            Self::SlaveVanishes { equation, slave } => {
                format!("{} is the slave of {}, where its coefficient is next to nothing", name(slave), place(equation))
            }
            Self::CoupledTwice { equation, slave, first } => {
                format!("{} is in the coupled sets of {}, and of {}", name(slave), place(first), place(equation))
            }
            Self::CoupledPrescribed { equation, slave, by } => {
                format!(
                    "{} is in the coupled set of {}, and prescribed in {}",
                    name(slave),
                    place(equation),
                    model.place(by)
                )
            }
            Self::MasterTwice { equation, master, .. } => {
                let place = place(equation);
                let through = if global(model, master) == master { "" } else { ", through the axes of its node" };
                format!("{} is named twice in {place}{through}, which the solver does not add up", name(master))
            }
            Self::Circle { equation, slave } => {
                format!(
                    "{}, the slave of {}, depends on itself through others and is left undetermined",
                    name(slave),
                    place(equation)
                )
            }
        }
    }
}

/// ` from step 2 on`, ` in subcase 2`; nothing where the first load case prescribes it.
fn when(model: &Model, since: usize) -> String {
    let case = model.cases.get(since).filter(|_| since > 0);
    let text = |case: &LoadCase| {
        if model.has_separate_cases { format!(" in {}", case.name) } else { format!(" from {} on", case.name) }
    };
    case.map(text).unwrap_or_default()
}

/// The faults of a deck's equations as they stand, each once, in the order of the load cases.
pub fn faults(model: &Model) -> Vec<Fault> {
    let mut all: Vec<Fault> = Vec::new();
    for (k, case) in model.cases.iter().enumerate() {
        if k == 0 || !case.constrains_as(&model.cases[k - 1]) {
            let known: FxHashSet<Fault> = all.iter().copied().collect();
            all.extend(faults_in(model, case).into_iter().filter(|fault| !known.contains(fault)));
        }
    }
    all
}

/// The faults of a deck's equations in force in a load case, as they stand.
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
pub fn faults_in(model: &Model, case: &LoadCase) -> Vec<Fault> {
    let mut left_out = vec![false; model.equations()];
    case.removed.iter().for_each(|&i| left_out[i as usize] = true);
    faults_of(model, &prescribed_in(model, [case]), &left_out)
}

/// The faults of the equations that are not left out; `prescribed` says where a column's value is given.
pub(super) fn faults_of(model: &Model, prescribed: &FxHashMap<u32, Origin>, left_out: &[bool]) -> Vec<Fault> {
    let kept = || (0..model.equations()).filter(|&i| !left_out[i] && model.has_slave(i));
    let mut slave_of: FxHashMap<u32, usize> = FxHashMap::default();
    let mut faults = Vec::new();
    for i in kept() {
        let equation = model.nth(i);
        let Some(&column) = equation.columns.first() else { continue };
        let slave = model.dofs[column as usize];
        let same = |&(j, _): &(&u32, &f64)| *j == column;
        let own: f64 = equation.columns.iter().zip(equation.coefficients).filter(same).map(|(_, a)| a).sum();
        let terms = equation.columns.iter().zip(equation.coefficients);
        let alike = |j: u32| unit_of(model.dofs[j as usize]) == unit_of(slave);
        let free = terms.filter(|(j, _)| !prescribed.contains_key(j) && alike(**j));
        let largest = free.fold(0.0_f64, |largest, (_, a)| largest.max(a.abs()));
        if own == 0.0 || own.abs() <= SMALL * largest {
            faults.push(Fault::SlaveVanishes { equation: i, slave });
        }
        if let Some(&by) = prescribed.get(&column) {
            faults.push(Fault::SlavePrescribed { equation: i, slave, by, since: since(model, slave) });
        }
        if let Some(by) = model.claimed(slave) {
            faults.push(Fault::SlaveClaimed { equation: i, slave, by });
        }
        match slave_of.get(&column) {
            Some(&first) => faults.push(Fault::SlaveTwice { equation: i, slave, first }),
            None => drop(slave_of.insert(column, i)),
        }
    }
    faults.extend(coupled::faults(model, prescribed, left_out));
    faults.extend(repeated::faults(model, prescribed, kept()));
    faults.extend(circles(model, &slave_of));
    faults
}

/// The first load case that prescribes a DOF which some case prescribes.
fn since(model: &Model, dof: Dof) -> usize {
    let prescribes = |case: &LoadCase| case.prescribed.binary_search_by_key(&dof, |given| given.dof).is_ok();
    model.cases.iter().position(prescribes).unwrap_or(0)
}

/// Translations and rotations have coefficients in different units, of which neither is large or small beside the other.
fn unit_of(dof: Dof) -> u8 {
    match dof.component {
        1..=3 => 1,
        4..=6 => 4,
        other => other,
    }
}

/// Slaves that depend on each other and are not determined by their equations: what remains when equations all of whose other DOFs are no slaves are taken away again and again.
fn circles(model: &Model, slave_of: &FxHashMap<u32, usize>) -> Vec<Fault> {
    let others = |i: usize| {
        let equation = model.nth(i);
        let own = equation.columns.first().copied();
        let terms = equation.columns.iter().zip(equation.coefficients);
        terms.filter(move |(j, a)| Some(**j) != own && **a != 0.0).filter_map(|(j, _)| slave_of.get(j).copied())
    };
    let mut waits: FxHashMap<usize, usize> = slave_of.values().map(|&i| (i, others(i).count())).collect();
    let mut users: FxHashMap<usize, Vec<usize>> = FxHashMap::default();
    slave_of.values().for_each(|&i| others(i).for_each(|j| users.entry(j).or_default().push(i)));
    let mut ready: Vec<usize> = waits.iter().filter(|(_, count)| **count == 0).map(|(&i, _)| i).collect();
    while let Some(done) = ready.pop() {
        waits.remove(&done);
        for &user in users.get(&done).map_or(&[][..], Vec::as_slice) {
            if let Some(count) = waits.get_mut(&user) {
                *count -= 1;
                if *count == 0 {
                    ready.push(user);
                }
            }
        }
    }
    let mut left: Vec<usize> = waits.into_keys().collect();
    left.sort_unstable();
    if left.is_empty() || determines_slaves(model, &left) {
        return Vec::new();
    }
    let slave = |i: usize| model.dofs[model.nth(i).columns[0] as usize];
    left.into_iter().map(|i| Fault::Circle { equation: i, slave: slave(i) }).collect()
}

/// Whether the equations determine their slaves: whether the square matrix of their coefficients has full rank for sure.
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

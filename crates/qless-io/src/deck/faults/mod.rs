//! Faults of equations other than dependence. They stop a solver that eliminates the first DOF of each equation.

mod find;
mod insertion;

pub(crate) use find::faults_of;
pub use find::{faults, faults_in};
pub(crate) use insertion::keeps_slaves;

use crate::deck::{Dof, LoadCase, Model, Origin};

/// A fault of an equation in a deck.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub struct EquationFault {
    /// The index of the equation, from 0. If a coupled set or a circle is at fault, this is one of its equations.
    pub equation: usize,
    /// The slave of the equation, or the faulty DOF of the coupled set.
    pub slave: Dof,
    /// The kind of the fault.
    pub kind: FaultKind,
}

/// The kinds of faults.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum FaultKind {
    /// The slave has a prescribed value.
    SlavePrescribed {
        /// The card that prescribes the value.
        by: Origin,
        /// The index of the first load case that prescribes the value, from 0.
        since: usize,
    },
    /// The slave is also the slave of an earlier equation.
    SlaveTwice {
        /// The index of the earlier equation.
        first: usize,
    },
    /// The coefficient of the slave is zero, or negligible beside the others.
    SlaveVanishes,
    /// The slave is in a set that excludes slaves, such as Nastran's `ASET`.
    SlaveClaimed {
        /// The card that puts the slave into the set.
        by: Origin,
    },
    /// A DOF is in two coupled sets of ANSYS, and it is the first DOF of one of them.
    CoupledTwice {
        /// The index of an equation of the coupled set that stands earlier in the deck.
        first: usize,
    },
    /// The first DOF of a coupled set of ANSYS has a prescribed value.
    CoupledPrescribed {
        /// The card that prescribes the value.
        by: Origin,
    },
    /// A master occurs twice, directly or through the local axes of its node. The solver does not add up the two coefficients.
    MasterTwice {
        /// The master that occurs twice.
        master: Dof,
    },
    /// The solver makes no equation from the card.
    Missing {
        /// Why the solver makes no equation.
        why: &'static str,
    },
    /// Slaves depend on one another in a circle. Their equations hardly determine them, or a slave cancels when the solver inserts the
    /// equations into one another.
    Circle,
}

impl EquationFault {
    /// Describes the fault in the deck's terms: `1:3 is the slave of line 25 *EQUATION, and prescribed in line 19
    /// *BOUNDARY`.
    pub fn describe(&self, model: &Model) -> String {
        let place =
            |i: usize| model.equation(i).map_or_else(|| format!("equation {}", i + 1), |e| model.place(e.origin));
        let (own, slave) = (place(self.equation), model.dof_name(self.slave));
        match self.kind {
            FaultKind::SlavePrescribed { by, since } => {
                format!("{slave} is the slave of {own}, and prescribed in {}{}", model.place(by), when(model, since))
            }
            FaultKind::SlaveClaimed { by } => {
                format!("{slave} is the slave of {own}, and in the set of {}, which excludes slaves", model.place(by))
            }
            FaultKind::SlaveTwice { first } => format!("{slave} is the slave of {}, and of {own}", place(first)),
            FaultKind::SlaveVanishes => format!("{slave} is the slave of {own}, but its coefficient is negligible"),
            FaultKind::CoupledTwice { first } => {
                format!("{slave} is in the coupled sets of {}, and of {own}", place(first))
            }
            FaultKind::CoupledPrescribed { by } => {
                format!("{slave} is in the coupled set of {own}, and prescribed in {}", model.place(by))
            }
            FaultKind::MasterTwice { master } => {
                let through = if model.as_global(master) == master { "" } else { ", through the axes of its node" };
                let master = model.dof_name(master);
                format!("{master} occurs twice in {own}{through}, and the solver does not add up the coefficients")
            }
            FaultKind::Missing { why } => {
                format!("{slave} is the slave of {own}, but the solver makes no equation: {why}")
            }
            FaultKind::Circle => {
                format!(
                    "{slave}, the slave of {own}, depends on itself through other slaves, and inserting their equations does not determine it"
                )
            }
        }
    }
}

/// Says when the fault begins: ` from step 2 on` or ` in subcase 2`. Empty if the first load case already prescribes the value.
fn when(model: &Model, since: usize) -> String {
    let case = model.cases.get(since).filter(|_| since > 0);
    let text = |case: &LoadCase| {
        if model.has_separate_cases { format!(" in {}", case.name) } else { format!(" from {} on", case.name) }
    };
    case.map(text).unwrap_or_default()
}

//! Faults of equations, other than dependence, that stop a solver which eliminates the first DOF of each equation.

mod find;
mod insertion;

pub(crate) use find::faults_of;
pub use find::{faults, faults_in};
pub(crate) use insertion::keeps_slaves;

use crate::deck::{Dof, LoadCase, Model, Origin};

/// A fault of one equation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub struct EquationFault {
    /// The equation, from 0. For a coupled set or a circle, one of its equations.
    pub equation: usize,
    /// Its slave, or the DOF of a coupled set.
    pub slave: Dof,
    /// The kind of the fault.
    pub kind: FaultKind,
}

/// The kind of a fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum FaultKind {
    /// The slave has a prescribed value.
    SlavePrescribed {
        /// Card that prescribes the value.
        by: Origin,
        /// The first load case that prescribes it, from 0.
        since: usize,
    },
    /// The slave is also the slave of an earlier equation.
    SlaveTwice {
        /// The earlier equation.
        first: usize,
    },
    /// The slave's coefficient is zero, or negligible beside the others.
    SlaveVanishes,
    /// The slave is in a set that excludes slaves, such as Nastran's `ASET`.
    SlaveClaimed {
        /// Card that puts it into the set.
        by: Origin,
    },
    /// A DOF is in two coupled sets of ANSYS, and is the first DOF of one of them.
    CoupledTwice {
        /// An equation of the earlier set.
        first: usize,
    },
    /// The first DOF of a coupled set of ANSYS has a prescribed value.
    CoupledPrescribed {
        /// Card that prescribes the value.
        by: Origin,
    },
    /// A master occurs twice, directly or through the local axes of its node, and the solver does not add up the
    /// coefficients.
    MasterTwice {
        /// The master.
        master: Dof,
    },
    /// The solver makes no equation of the card.
    Missing {
        /// Why it makes none.
        why: &'static str,
    },
    /// Slaves depend on each other in a circle. The equations hardly determine them, or a slave cancels when the solver
    /// inserts the equations into each other.
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
                    "{slave}, the slave of {own}, depends on itself through other slaves, and is not determined or cancels"
                )
            }
        }
    }
}

/// ` from step 2 on` or ` in subcase 2`; empty if the first load case prescribes it.
fn when(model: &Model, since: usize) -> String {
    let case = model.cases.get(since).filter(|_| since > 0);
    let text = |case: &LoadCase| {
        if model.has_separate_cases { format!(" in {}", case.name) } else { format!(" from {} on", case.name) }
    };
    case.map(text).unwrap_or_default()
}

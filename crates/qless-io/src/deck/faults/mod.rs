//! Faults of equations, besides dependence, that stop a solver which eliminates the first DOF of each equation.

mod find;

pub(crate) use find::faults_of;
pub use find::{faults, faults_in};

use crate::deck::{Dof, LoadCase, Model, Origin};

/// A fault of one equation. Equations count from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum EquationFault {
    /// The slave has a prescribed value.
    SlavePrescribed {
        /// The equation.
        equation: usize,
        /// Its slave.
        slave: Dof,
        /// Card that prescribes the value.
        by: Origin,
        /// The first load case that prescribes it, from 0.
        since: usize,
    },
    /// The slave is also the slave of an earlier equation.
    SlaveTwice {
        /// The equation.
        equation: usize,
        /// Its slave.
        slave: Dof,
        /// The earlier equation.
        first: usize,
    },
    /// The slave's coefficient is zero, or negligible beside the others.
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
        /// Card that puts it into the set.
        by: Origin,
    },
    /// A DOF is in two coupled sets of ANSYS, and is the first DOF of one of them.
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
        /// Card that prescribes the value.
        by: Origin,
    },
    /// A master occurs twice, directly or through the local axes of its node, and the solver does not add up the
    /// coefficients.
    MasterTwice {
        /// The equation.
        equation: usize,
        /// Its slave.
        slave: Dof,
        /// The master.
        master: Dof,
    },
    /// Slaves depend on each other in a circle, and the equations hardly determine them.
    Circle {
        /// An equation of the circle.
        equation: usize,
        /// Its slave.
        slave: Dof,
    },
}

impl EquationFault {
    /// The equation with the fault.
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

    /// Describes the fault in the deck's terms: `1:3 is the slave of line 25 *EQUATION, and prescribed in line 19
    /// *BOUNDARY`.
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
                let through = if model.as_global(master) == master { "" } else { ", through the axes of its node" };
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

/// ` from step 2 on` or ` in subcase 2`; empty if the first load case prescribes it.
fn when(model: &Model, since: usize) -> String {
    let case = model.cases.get(since).filter(|_| since > 0);
    let text = |case: &LoadCase| {
        if model.has_separate_cases { format!(" in {}", case.name) } else { format!(" from {} on", case.name) }
    };
    case.map(text).unwrap_or_default()
}

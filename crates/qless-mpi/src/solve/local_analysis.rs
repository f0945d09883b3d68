//! The serial analysis of the equations assigned to a rank. Components are independent, so the result equals that of one rank with all
//! equations.

use std::ops::Range;

use qless::{Analysis, Confidence, Options, Reduction, SystemBuilder, analyse};

use crate::components::TouchedDofs;
use crate::distribute::AssignedEquations;
use crate::error::Failure;

/// The serial analysis of the equations that this rank was assigned.
pub(crate) struct LocalAnalysis {
    pub assigned: AssignedEquations,
    /// For each DOF of the local analysis, its number in the job.
    pub dofs: Vec<u64>,
    pub analysis: Analysis,
    pub reduction: Reduction,
}

/// Sound if the result certainly equals that of an analysis of the whole components, including the equations that were peeled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Soundness {
    Sound,
    Unsound,
}

/// Largest residual of a sound reduction. With a larger one, the analysis of the whole component may choose other slaves.
pub(super) const LOSS: f64 = 1e-13;
/// A local result is sound only if the distance of its kept equations from dependence exceeds this. At a smaller distance, an analysis of
/// the whole component may keep other equations.
const NEAR: f64 = 1e-3;

impl LocalAnalysis {
    /// Analyses the assigned equations; `None` if there are none. DOFs in the range `near`, to which most DOFs usually belong, are looked
    /// up faster.
    pub fn new(assigned: AssignedEquations, near: Range<u64>, options: &Options) -> Result<Option<Self>, Failure> {
        if assigned.rows.len() == 0 {
            return Ok(None);
        }
        let touched = TouchedDofs::by(&assigned.rows, &near);
        // The builder needs at least one DOF, even if no equation has a term.
        let mut builder = SystemBuilder::new(touched.dofs.len().max(1));
        for (i, &rhs) in assigned.rows.rhs.iter().enumerate() {
            let places = touched.row(&assigned.rows, i).iter().map(|&j| j as usize);
            builder.equation(places.zip(assigned.rows.row(i).map(|(_, value)| value)), rhs);
        }
        for (dof, &value) in &assigned.prescribed {
            if let Ok(place) = touched.dofs.binary_search(dof) {
                builder.prescribe(place, value);
            }
        }
        let local = |dofs: &[usize]| -> Vec<usize> {
            dofs.iter().filter_map(|&j| touched.dofs.binary_search(&(j as u64)).ok()).collect()
        };
        let equations = options.preferences.equations.iter();
        let preferences = qless::Preferences {
            masters: local(&options.preferences.masters),
            slaves: local(&options.preferences.slaves),
            equations: equations.filter_map(|&i| assigned.rows.numbers.binary_search(&(i as u64)).ok()).collect(),
        };
        let system = builder.build().map_err(|error| Failure::of(&error))?;
        let analysis = analyse(&system, &Options { preferences, ..options.clone() });
        let analysis = analysis.map_err(|error| Failure::of(&error))?;
        let reduction = analysis.reduction().map_err(|error| Failure::of(&error))?;
        Ok(Some(Self { dofs: touched.dofs, assigned, analysis, reduction }))
    }

    pub fn confidence(&self) -> Confidence {
        self.analysis.confidence()
    }

    pub fn soundness(&self) -> Soundness {
        let Confidence { distance, error, ambiguous, .. } = self.confidence();
        // In a block, the order of the columns depends on all equations of its component, so a factorization may give another result.
        let presolved = self.analysis.presolve().blocks == 0;
        let plain = presolved && !ambiguous && error == 0.0 && distance > NEAR && self.reduction.exchanges() == 0;
        let is_sound = plain && self.analysis.residual(&self.reduction).is_ok_and(|residual| residual <= LOSS);
        if is_sound { Soundness::Sound } else { Soundness::Unsound }
    }
}

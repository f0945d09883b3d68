//! What is refused before anything is done: lists that are too short, numbers that are none, DOFs that are not there.

use qless::SystemBuilder;

use super::super::{EquilibriumError, Start, Target};
use qless_constraints::ConstraintSet;

/// Lengths, before anything else.
pub fn check(dofs: usize, set: &ConstraintSet, start: &Start, target: &Target) -> Result<(), EquilibriumError> {
    let (n, m) = (set.dofs(), set.equations());
    let lengths = [
        ("DOFs of the model", dofs, n),
        ("values of u at the start", start.u.len(), n),
        ("multipliers at the start", start.multipliers.len(), m),
        ("loads at the start", start.loads.len(), n),
        ("loads", target.loads.len(), n),
    ];
    if let Some((what, found, expected)) = lengths.into_iter().find(|(_, found, expected)| found != expected) {
        return Err(EquilibriumError::Size { what, found, expected });
    }
    let numbers =
        [("u", &start.u[..]), ("multiplier", &start.multipliers), ("load", &start.loads), ("load", target.loads)];
    for (what, list) in numbers {
        if let Some(at) = list.iter().position(|x| !x.is_finite()) {
            return Err(EquilibriumError::NotFinite { factor: 0.0, what, at });
        }
    }
    // DOFs out of range or named twice, and values that are not finite.
    let mut builder = SystemBuilder::new(set.dofs());
    target.prescribed.iter().for_each(|&(dof, value)| builder.prescribe(dof, value));
    let checked = builder.build().map(drop).map_err(qless_constraints::LineariseError::from);
    checked.map_err(|source| EquilibriumError::System { factor: 0.0, source })
}

//! Coefficients from which nothing was concluded.

use qless::Report;

use super::name;
use super::number::rough;
use crate::diagnose::Diagnosis;

/// One line, if there are any.
pub fn line(diagnosis: &Diagnosis, report: &Report) -> Option<String> {
    let first = report.ignored_coefficients.first()?;
    let equation = name::equation(&diagnosis.system, first.row - 1);
    let dof = diagnosis.system.dof_label(first.dof - 1);
    let (size, dof) = (rough(first.coefficient), name::label(&dof));
    Some(match report.ignored_coefficients.len() {
        1 => format!("One coefficient is no more than rounding and decided nothing: {size} of {dof} in {equation}."),
        count => format!(
            "{count} coefficients are no more than rounding and decided nothing, first {size} of {dof} in {equation}."
        ),
    })
}

//! The field `meant` of a report: near-dependences, and the rank if they count as dependences.

use super::{Certificate, Omitted, Report};
use crate::common::argument::within;
use crate::diagnosis::NearDependent;
use crate::{Analysis, ArgumentError, ConstraintSystem, NearDependence};

/// A [`NearDependence`] with 1-based numbers and labels.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct NearDependenceFinding {
    /// Rank if the near-dependent equations are dependent; [`Report::rank`] is the rank of the typed numbers.
    pub rank: usize,
    /// Number of decimals to which all near-dependent equations agree with their combinations.
    pub digits: u32,
    /// The near-dependent equations, ascending.
    pub equations: Vec<NearEquation>,
}

/// A nearly dependent equation, as [`NearDependent`], with 1-based numbers and labels.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct NearEquation {
    /// The row of the equation, from 1.
    pub row: usize,
    /// The label of the equation.
    pub label: String,
    /// Number of decimals to which the equation agrees with its combination.
    pub digits: u32,
    /// Estimate of the smallest relative change of one coefficient that makes the equation a combination of others.
    pub distance: f64,
    /// The combination of other equations that is nearly this equation. A serialized report has its keys in place of this field:
    /// `because` and, if they apply, `because_omitted` and `because_error`.
    #[cfg_attr(feature = "serde", serde(flatten))]
    pub certificate: Certificate,
}

impl Report {
    /// Adds the near-dependences, with combinations of at most `terms` terms in total.
    ///
    /// ```
    /// use qless::{Options, Report, SystemBuilder, analyse};
    /// let mut builder = SystemBuilder::new(2);
    /// builder.equation([(0, 1.234_567_891), (1, -1.0)], 0.0);
    /// builder.equation([(0, 1.234_568), (1, -1.0)], 0.0);
    /// let system = builder.build()?;
    /// let analysis = analyse(&system, &Options::default())?;
    /// let near = analysis.near_dependence()?.expect("nearly the same");
    /// let report = Report::new(&analysis, 0).with_near_dependence(&analysis, &near, Report::TERMS)?;
    /// let finding = report.meant.as_ref().expect("added");
    /// assert_eq!((report.rank, finding.rank, finding.equations[0].row), (2, 1, 2));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`ArgumentError::OutOfRange`] for an equation that the system does not have.
    pub fn with_near_dependence(
        mut self,
        analysis: &Analysis,
        near: &NearDependence,
        terms: usize,
    ) -> Result<Self, ArgumentError> {
        let system = analysis.system();
        let named = |equation: &NearDependent| {
            let rows = equation.because.iter().map(|term| term.row);
            rows.chain([equation.row]).try_for_each(|row| within("equation", row, system.equations()))
        };
        near.equations.iter().try_for_each(named)?;
        let mut left = terms;
        let equations = near.equations.iter().map(|equation| near_equation(system, equation, &mut left)).collect();
        self.meant = Some(NearDependenceFinding { rank: near.rank, digits: near.digits(), equations });
        Ok(self)
    }
}

fn near_equation(system: &ConstraintSystem, equation: &NearDependent, left: &mut usize) -> NearEquation {
    let because = &equation.because;
    let certificate = if because.len() > *left {
        Certificate::left_out(Omitted::Terms(because.len()))
    } else {
        *left -= because.len();
        Certificate::labelled(system, because)
    };
    let NearDependent { row, digits, distance, .. } = *equation;
    NearEquation { row: row + 1, label: system.equation_label(row), digits, distance, certificate }
}

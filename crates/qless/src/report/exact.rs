//! `exact_rank`: what exact arithmetic says of the same system, and of which parts the analysis says otherwise.

use super::Report;
use crate::common::argument::{long, within};
use crate::diagnosis::exact::{ExactRank, PartRank, Reading};
use crate::{Analysis, ArgumentError, ConstraintSystem, Kind};

/// An [`ExactRank`] beside the analysis.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct ExactFinding {
    /// What number a double was taken for.
    pub reading: Reading,
    /// Exact rank of the free part of C.
    pub rank: usize,
    /// Exact rank with the right-hand side as a further column.
    pub augmented_rank: usize,
    /// Whether the equations have a solution: whether the two ranks are equal.
    pub solvable: bool,
    /// The primes, as text: most readers of JSON round numbers of 61 bits.
    pub primes: [String; 2],
    /// Connected parts of which the analysis says otherwise, ascending by row.
    pub differences: Vec<ExactDifference>,
}

/// A connected part of which exact arithmetic and the analysis do not say the same.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct ExactDifference {
    /// Its first equation, from 1.
    pub row: usize,
    /// The label of that equation.
    pub label: String,
    /// Its number of equations.
    pub equations: usize,
    /// Its exact rank.
    pub rank: usize,
    /// Its rank in the analysis.
    pub analysis_rank: usize,
    /// Whether it has a solution exactly.
    pub solvable: bool,
    /// Whether it has one in the analysis.
    pub analysis_solvable: bool,
}

impl Report {
    /// Adds what exact arithmetic says; `analysis` is that of [`Report::new`], `exact` the rank of its system.
    ///
    /// ```
    /// use qless::exact::{self, Reading};
    /// use qless::{Options, Report, SystemBuilder, analyse};
    /// // Apart by 1e-13, which the tolerance takes for rounding and exact arithmetic does not.
    /// let mut builder = SystemBuilder::new(2);
    /// builder.equation([(0, 1.0), (1, 1.0)], 0.0);
    /// builder.equation([(0, 1.0), (1, 1.000_000_000_000_1)], 0.0);
    /// let system = builder.build()?;
    /// let analysis = analyse(&system, &Options::default())?;
    /// let exact = exact::rank(&system, Reading::Typed)?;
    /// let report = Report::new(&analysis, 0).with_exact(&analysis, &exact)?;
    /// let finding = report.exact_rank.as_ref().expect("added");
    /// assert_eq!((report.rank, finding.rank, finding.differences[0].row), (1, 2, 1));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`ArgumentError`] if `exact` is of a system with another number of equations.
    pub fn with_exact(mut self, analysis: &Analysis, exact: &ExactRank) -> Result<Self, ArgumentError> {
        long("the list of connected parts", exact.part_of.len(), analysis.kinds.len())?;
        exact.part_of.iter().try_for_each(|&part| within("connected part", part as usize, exact.parts.len()))?;
        self.exact_rank = Some(ExactFinding {
            reading: exact.reading,
            rank: exact.rank,
            augmented_rank: exact.augmented_rank,
            solvable: exact.is_solvable(),
            primes: exact.primes.map(|prime| prime.to_string()),
            differences: differences(analysis.system(), &analysis.kinds, exact),
        });
        Ok(self)
    }
}

fn differences(system: &ConstraintSystem, kinds: &[Kind], exact: &ExactRank) -> Vec<ExactDifference> {
    let found = analysed(kinds, exact);
    let mut told = vec![false; found.len()];
    let mut differences = Vec::new();
    for (row, &part) in exact.part_of.iter().enumerate() {
        let part = part as usize;
        if !std::mem::replace(&mut told[part], true) && found[part] != exact.parts[part] {
            let (exact, found) = (exact.parts[part], found[part]);
            differences.push(ExactDifference {
                row: row + 1,
                label: system.equation_label(row),
                equations: exact.equations,
                rank: exact.rank,
                analysis_rank: found.rank,
                solvable: exact.solvable,
                analysis_solvable: found.solvable,
            });
        }
    }
    differences
}

/// What the analysis says of each part.
fn analysed(kinds: &[Kind], exact: &ExactRank) -> Vec<PartRank> {
    let mut parts = vec![PartRank { equations: 0, rank: 0, solvable: true }; exact.parts.len()];
    for (&kind, &part) in kinds.iter().zip(&exact.part_of) {
        let part = &mut parts[part as usize];
        part.equations += 1;
        part.rank += usize::from(kind == Kind::Independent);
        part.solvable &= kind != Kind::Conflicting;
    }
    parts
}

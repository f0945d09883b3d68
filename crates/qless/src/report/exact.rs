//! `exact_rank`: the rank in exact arithmetic, and the parts for which the analysis has another result.

use super::Report;
use crate::common::argument::{long, within};
use crate::diagnosis::exact::{ExactRank, PartRank, Reading};
use crate::{Analysis, ArgumentError, ConstraintSystem, Kind};

/// An [`ExactRank`] and its differences from the analysis.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct ExactFinding {
    /// How doubles were converted to exact numbers.
    pub reading: Reading,
    /// Exact rank of the free part of C.
    pub rank: usize,
    /// Exact rank of C with the right-hand side as an additional column.
    pub augmented_rank: usize,
    /// Whether the equations have a solution, that is, the two ranks are equal.
    pub solvable: bool,
    /// The primes, as text, because most readers of JSON round numbers of 61 bits.
    pub primes: [String; 2],
    /// Parts for which the analysis has another result, ascending by row.
    pub differences: Vec<ExactDifference>,
}

/// A part for which exact arithmetic and the analysis have different results.
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
    /// Whether it has a solution in exact arithmetic.
    pub solvable: bool,
    /// Whether it has one in the analysis.
    pub analysis_solvable: bool,
}

impl Report {
    /// Adds the exact rank of the system; `analysis` is that of [`Report::new`].
    ///
    /// ```
    /// use qless::exact::{self, Reading};
    /// use qless::{Options, Report, SystemBuilder, analyse};
    /// // The equations differ by 1e-13, which is below the tolerance but not zero in exact arithmetic.
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
    /// [`ArgumentError`] if `exact` belongs to a system with another number of equations.
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
    let mut seen = vec![false; found.len()];
    let mut differences = Vec::new();
    for (row, &part) in exact.part_of.iter().enumerate() {
        let part = part as usize;
        if !std::mem::replace(&mut seen[part], true) && found[part] != exact.parts[part] {
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

/// The result of the analysis for each part.
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

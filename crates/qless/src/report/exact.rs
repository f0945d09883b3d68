//! `exact_rank`: the rank in exact arithmetic, and the parts for which the analysis has another result.

use super::sizes::from_one;
use crate::diagnosis::exact::{ExactRank, Reading};
use crate::diagnosis::{Proof, analysed_parts};
use crate::{Analysis, ConstraintSystem, Kind};

/// An [`ExactRank`] and its differences from the analysis.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct ExactFinding {
    /// How doubles were converted to exact numbers.
    pub reading: Reading,
    /// Exact rank of the free part of C.
    pub rank: usize,
    /// Exact rank of C with the right-hand side as an additional column.
    pub augmented_rank: usize,
    /// True if the equations have a solution, that is, if the two ranks are equal.
    pub solvable: bool,
    /// Bound of the probability that this rank is wrong: 0 if certificates prove it too.
    pub error_chance: f64,
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
    /// The first equation of the part, from 1.
    pub row: usize,
    /// The label of this first equation.
    pub label: String,
    /// Number of equations of the part.
    pub equations: usize,
    /// The rank of the part in exact arithmetic.
    pub rank: usize,
    /// The rank of the part in the analysis.
    pub analysis_rank: usize,
    /// True if the part has a solution in exact arithmetic.
    pub solvable: bool,
    /// True if the part has a solution in the analysis.
    pub analysis_solvable: bool,
}

impl ExactFinding {
    pub(super) fn new(analysis: &Analysis, exact: &ExactRank) -> Self {
        Self {
            reading: exact.reading,
            rank: exact.rank,
            augmented_rank: exact.augmented_rank,
            solvable: exact.is_solvable(),
            error_chance: analysis.exact_error_chance().unwrap_or_else(|| exact.error_chance()),
            primes: exact.primes.map(|prime| prime.to_string()),
            differences: differences(analysis.system(), &analysis.kinds, exact),
        }
    }
}

fn differences(system: &ConstraintSystem, kinds: &[Kind], exact: &ExactRank) -> Vec<ExactDifference> {
    let found = analysed_parts(kinds, exact);
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

/// A [`Proof`]: how many equations were proved in each way, and those that were not.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct ProofFinding {
    /// Number of equations proved by their triangular form: [`Proof::triangular`].
    pub triangular: usize,
    /// Number of equations proved to be independent by a bound: [`Proof::bounded`].
    pub bounded: usize,
    /// Number of equations proved to be independent modulo a prime: [`Proof::modular`].
    pub modular: usize,
    /// Number of dependent equations proved by an exact certificate: [`Proof::exact`].
    pub exact: usize,
    /// Number of dependent equations whose certificate holds to rounding: [`Proof::enclosed`].
    pub enclosed: usize,
    /// Rows of the equations without a proof, from 1.
    pub unproved: Vec<usize>,
}

impl ProofFinding {
    pub(super) fn new(proof: &Proof) -> Self {
        let &Proof { triangular, bounded, modular, exact, enclosed, .. } = proof;
        Self { triangular, bounded, modular, exact, enclosed, unproved: from_one(&proof.unproved) }
    }
}

//! The exact properties of a system from the oracle, and the results of an analysis.

use qless::{Analysis, ConstraintSystem, Kind};
use qless_scenes::oracle;

/// The exact properties of the free part of a system.
#[derive(Debug, PartialEq)]
pub struct Exact {
    pub rank: usize,
    pub dependent: usize,
    pub conflicting: bool,
    pub generated: Vec<usize>,
}

impl Exact {
    pub fn of(system: &ConstraintSystem) -> Self {
        let rank = oracle::rank_free(system).expect("within reach");
        Self {
            rank,
            dependent: system.equations() - rank,
            conflicting: !oracle::consistent(system).expect("within reach"),
            generated: oracle::generated(system).expect("within reach"),
        }
    }

    pub fn found(analysis: &Analysis, dofs: &[usize]) -> Self {
        let mut generated: Vec<usize> = analysis.generated().iter().map(|&(j, _)| dofs[j]).collect();
        generated.sort_unstable();
        Self {
            rank: analysis.rank(),
            dependent: analysis.dependent().len(),
            conflicting: analysis.kinds().contains(&Kind::Conflicting),
            generated,
        }
    }
}

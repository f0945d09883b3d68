//! How good a result is, against what is known by construction.
//!
//! | number | formula |
//! | --- | --- |
//! | false keeps | `|K| - rank C_K`, where K are the equations kept: dependent ones that were taken for independent |
//! | false drops | `rank C - rank C_K`: independent ones that were taken for dependent |
//! | residual | of T, G, g in the independent equations ([`qless::Analysis::residual`]) |
//! | error | `max |u - u*| / max |u*|` of a solved problem ([`Springs`]) |

use std::cell::RefCell;
use std::collections::BTreeMap;

use qless::{Analysis, ConstraintSystem, Kind, Options, SystemBuilder, analyse};
use qless_scenes::{Scene, oracle};

use super::measure::Measured;
use super::run::Done;
use super::spring::Springs;

/// A system with its truth and its solution.
pub struct Reference<'a> {
    scene: &'a Scene,
    rank: usize,
    analysis: Option<Analysis>,
    springs: Option<Springs>,
    /// Ranks of the sets of rows that were asked for.
    ranks: RefCell<BTreeMap<Vec<usize>, usize>>,
}

impl<'a> Reference<'a> {
    pub fn new(scene: &'a Scene) -> Self {
        let system = &scene.system;
        let rank = scene.truth.rank_free.unwrap_or(system.equations());
        let springs = Springs::new(system, rank);
        let analysis = analyse(system, &Options::default()).ok();
        Self { scene, rank, analysis, springs, ranks: RefCell::default() }
    }

    /// Everything but memory; other libraries do not name the rows that they keep, so that only their number counts.
    pub fn judge(&self, done: &Done) -> Measured {
        let Self { scene, rank, .. } = self;
        let found = done.reduction.slaves.len();
        let own = done.analysis.as_ref();
        let true_rank = own.map_or(found.min(*rank), |analysis| self.rank_of(kept(analysis)));
        let judge = own.or(self.analysis.as_ref());
        Measured {
            time: done.time,
            quartiles: (done.time, done.time),
            rank: found,
            ambiguous: own.is_some_and(|analysis| analysis.confidence.ambiguous),
            false_drops: rank - true_rank,
            false_keeps: found - true_rank,
            residual: judge.map_or(f64::NAN, |analysis| analysis.residual(&scene.system, &done.reduction)),
            growth: done.reduction.growth,
            error: self.springs.as_ref().and_then(|springs| springs.error(done)),
            memory: None,
        }
    }

    /// Rank of some equations; rounded coefficients can have a higher exact rank than what they stand for.
    fn rank_of(&self, rows: Vec<usize>) -> usize {
        let count = || oracle::rank_free(&part(&self.scene.system, &rows)).min(self.rank);
        if let Some(&rank) = self.ranks.borrow().get(&rows) {
            return rank;
        }
        let rank = count();
        self.ranks.borrow_mut().insert(rows, rank);
        rank
    }
}

fn kept(analysis: &Analysis) -> Vec<usize> {
    (0..analysis.kinds.len()).filter(|&i| analysis.kinds[i] == Kind::Independent).collect()
}

/// Some of the equations.
fn part(system: &ConstraintSystem, rows: &[usize]) -> ConstraintSystem {
    let mut builder = SystemBuilder::new(system.dofs());
    rows.iter().for_each(|&i| {
        builder.equation(system.matrix().row(i), system.rhs()[i]);
    });
    system.prescribed().iter().for_each(|&(dof, value)| builder.prescribe(dof, value));
    builder.build().expect("part of a valid system")
}

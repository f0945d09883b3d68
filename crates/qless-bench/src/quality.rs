//! The quality of a result, compared with the known truth.
//!
//! | number | formula |
//! | --- | --- |
//! | false keeps | `|K| - rank C_K`, where K are the equations kept: dependent ones that were taken for independent |
//! | false drops | `rank C - rank C_K`: independent ones that were taken for dependent |
//! | residual | of T, G, g in the independent equations ([`qless::Analysis::residual`]) |
//! | error | `max |u - u*| / max |u*|` of a solved problem ([`Springs`]) |

use std::cell::{OnceCell, RefCell};
use std::collections::BTreeMap;

use qless::{Analysis, Kind, Options, Reduction, analyse};
use qless_scenes::{Scene, oracle};

use super::run::Done;
use super::sample::Measured;
use super::spring::{Springs, with_rows};

/// A system with its true rank and the solution of its spring problem.
pub struct Reference<'a> {
    pub scene: &'a Scene,
    rank: usize,
    /// The analysis with default options, for methods that have none of their own.
    analysis: OnceCell<Option<Analysis>>,
    springs: Option<Springs>,
    /// Ranks that were already computed, by set of rows.
    ranks: RefCell<BTreeMap<Vec<usize>, usize>>,
}

impl<'a> Reference<'a> {
    pub fn new(scene: &'a Scene) -> Self {
        let system = &scene.system;
        let rank = scene.truth.rank_free.unwrap_or(system.equations());
        let springs = Springs::new(system, rank);
        Self { scene, rank, analysis: OnceCell::new(), springs, ranks: RefCell::default() }
    }

    /// Evaluates everything except memory. Other libraries do not name the rows that they keep, so only their number counts.
    pub fn judge(&self, done: &Done) -> Measured {
        let Self { scene, rank, .. } = self;
        let found = done.rank;
        let own = done.analysis.as_ref();
        let true_rank = own.map_or(found.min(*rank), |analysis| self.rank_of(kept(analysis)));
        let standard = || self.analysis.get_or_init(|| analyse(&scene.system, &Options::default()).ok()).as_ref();
        let judge = own.or_else(standard);
        Measured {
            time: done.time,
            quartiles: (done.time, done.time),
            rank: found,
            ambiguous: own.is_some_and(|analysis| analysis.confidence().ambiguous),
            false_drops: rank - true_rank,
            false_keeps: found - true_rank,
            residual: judge
                .zip(done.reduction.as_ref())
                .map(|(analysis, reduction)| analysis.residual(reduction).unwrap_or(f64::MAX)),
            growth: done.reduction.as_ref().map(Reduction::growth),
            error: self.springs.as_ref().and_then(|springs| springs.error(done)),
            memory: None,
        }
    }

    /// Rank of the equations `rows`, at most the true rank: rounded coefficients can have a higher exact rank.
    fn rank_of(&self, rows: Vec<usize>) -> usize {
        let count = || {
            let exact = oracle::rank_free(&with_rows(&self.scene.system, &rows));
            exact.expect("scenes are within reach of exact elimination").min(self.rank)
        };
        if let Some(&rank) = self.ranks.borrow().get(&rows) {
            return rank;
        }
        let rank = count();
        self.ranks.borrow_mut().insert(rows, rank);
        rank
    }
}

fn kept(analysis: &Analysis) -> Vec<usize> {
    (0..analysis.kinds().len()).filter(|&i| analysis.kinds()[i] == Kind::Independent).collect()
}

#[cfg(test)]
mod tests {
    use qless::{Options, Tolerance};
    use qless_scenes::families::{Near, near, path};

    use super::super::methods::{self, BenchMethod, Engine};
    use super::super::run::once;
    use super::Reference;

    #[test]
    fn equations_that_are_wrongly_dropped_are_counted() {
        let scene = near(10, 1e-5, Near::Shared).expect("a scene");
        let reference = Reference::new(&scene);
        let judge = |tolerance: f64| {
            let options = Options { tolerance: Tolerance::Relative(tolerance), ..Options::default() };
            let method = BenchMethod { engine: Engine::Qless(options), ..methods::all(&[]).swap_remove(0) };
            reference.judge(&once(&scene.system, &method).expect("small"))
        };
        let (right, wrong) = (judge(1e-10), judge(1e-4));
        assert_eq!((right.rank, right.false_drops, right.false_keeps), (30, 0, 0));
        assert_eq!((wrong.rank, wrong.false_drops, wrong.false_keeps), (20, 10, 0));
        let (right, wrong) = (right.error.expect("small"), wrong.error.expect("small"));
        assert!(right < 1e-9 && wrong > 1e-2, "{right:e} {wrong:e}");
    }

    #[test]
    fn equations_that_are_wrongly_kept_are_counted() {
        let scene = near(4, 0.0, Near::Shared).expect("a scene");
        let reference = Reference::new(&scene);
        assert_eq!(reference.rank, 8);
        assert_eq!(reference.rank_of((0..12).collect()), 8);
        // Of four triples of rank 2, eight rows are kept: two rows of each triple have rank 8, but all rows of two triples have rank 4.
        assert_eq!(reference.rank_of(vec![0, 1, 3, 4, 6, 7, 9, 10]), 8);
        assert_eq!(reference.rank_of((0..6).collect()), 4);
    }

    #[test]
    fn an_exact_reduction_has_no_error() {
        let scene = path(20).expect("a scene");
        let analysis = qless::analyse(&scene.system, &Options::default()).expect("valid");
        let reduction = analysis.reduction().expect("within the gate");
        let done = super::Done { time: 1.0, rank: 19, reduction: Some(reduction), analysis: Some(analysis) };
        let measured = Reference::new(&scene).judge(&done);
        assert!(measured.error.expect("small") < 1e-14 && measured.residual == Some(0.0));
    }
}

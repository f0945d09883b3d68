//! How good a result is, against what is known by construction.
//!
//! | number | formula |
//! | --- | --- |
//! | false keeps | `|K| - rank C_K`, where K are the equations kept: dependent ones that were taken for independent |
//! | false drops | `rank C - rank C_K`: independent ones that were taken for dependent |
//! | residual | of T, G, g in the independent equations ([`qless::Analysis::residual`]) |
//! | error | `max |u - u*| / max |u*|` of `K u + C^T lambda = f`, `C u = b`, `K = I + L` |
//!
//! L are springs of stiffness 1 from each DOF to the next, f_j is `1 + j mod 7`; u is solved by transformation with T, G and g
//! ([`reduced`]), u* with a multiplier for each equation ([`Problem::lagrange`]), which needs no T.

use std::cell::RefCell;
use std::collections::BTreeMap;

use faer::sparse::{SparseColMat, Triplet};
use qless::{Analysis, ConstraintSystem, Kind, Options, SystemBuilder, analyse};
use qless_constraints::enforce::{Problem, reduced};
use qless_scenes::{Scene, oracle};

use super::measure::Measured;
use super::run::Done;

/// Larger systems take the sparse LU of the multipliers minutes.
const MOST_DOFS: usize = 3_000;
/// Entries of T from which on `T^T K T` may be dense.
const MOST_ENTRIES: usize = 200_000;

/// A system with its truth and its solution.
pub struct Reference<'a> {
    scene: &'a Scene,
    rank: usize,
    analysis: Option<Analysis>,
    stiffness: Option<SparseColMat<usize, f64>>,
    /// u*, where there is one.
    solution: Option<Vec<f64>>,
    /// Ranks of the sets of rows that were asked for.
    ranks: RefCell<BTreeMap<Vec<usize>, usize>>,
}

impl<'a> Reference<'a> {
    pub fn new(scene: &'a Scene) -> Self {
        let system = &scene.system;
        let rank = scene.truth.rank_free.unwrap_or(system.equations());
        let stiffness = (system.dofs() <= MOST_DOFS).then(|| springs(system.dofs())).flatten();
        let solution = stiffness.as_ref().and_then(|k| solution(k, system, rank));
        let analysis = analyse(system, &Options::default()).ok();
        Self { scene, rank, analysis, stiffness, solution, ranks: RefCell::default() }
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
            error: self.error(done),
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

    fn error(&self, done: &Done) -> Option<f64> {
        let (k, exact) = (self.stiffness.as_ref()?, self.solution.as_ref()?);
        if done.reduction.t.nnz() > MOST_ENTRIES {
            return None;
        }
        let prescribed: Vec<f64> = self.scene.system.prescribed().iter().map(|&(_, value)| value).collect();
        let u = reduced(k, &loads(exact.len()), &done.reduction, &prescribed).ok()?;
        let largest = |x: &mut dyn Iterator<Item = f64>| x.fold(0.0_f64, |most, v| most.max(v.abs()));
        let off = largest(&mut u.iter().zip(exact).map(|(u, exact)| u - exact));
        Some(off / largest(&mut exact.iter().copied()))
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

/// `I + L`.
fn springs(dofs: usize) -> Option<SparseColMat<usize, f64>> {
    let ground = (0..dofs).map(|j| Triplet::new(j, j, 1.0));
    let springs = (1..dofs).flat_map(|j| {
        [(j - 1, j - 1, 1.0), (j, j, 1.0), (j - 1, j, -1.0), (j, j - 1, -1.0)].map(|(i, j, v)| Triplet::new(i, j, v))
    });
    SparseColMat::try_new_from_triplets(dofs, dofs, &ground.chain(springs).collect::<Vec<_>>()).ok()
}

fn loads(dofs: usize) -> Vec<f64> {
    (0..dofs).map(|j| 1.0 + (j % 7) as f64).collect()
}

/// u*, if the equations that it rests on are as many as there should be.
fn solution(k: &SparseColMat<usize, f64>, system: &ConstraintSystem, rank: usize) -> Option<Vec<f64>> {
    let f = loads(system.dofs());
    let problem = Problem::new(k, &f, system).ok()?;
    if problem.kept().len() != rank {
        return None;
    }
    problem.lagrange().ok().map(|solution| solution.u)
}

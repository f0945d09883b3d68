//! Runs one method on one system: the time of its verdict, and the results that are judged.

use std::time::Instant;

use qless::backend::BackendError;
use qless::{Analysis, BackendChoice, ConstraintSystem, Options, Reduction, analyse};
use rayon::prelude::*;

use super::figure_15::{FigureSide, blocks, factor};
use super::given_up::GivenUpReason;
use super::methods::{BenchMethod, Engine};

/// The result of one run of a method.
pub struct Done {
    /// Seconds of the analysis, of the bare factorization, or of the whole elimination by another library.
    pub time: f64,
    pub rank: usize,
    /// The reduction by the method; `None` for a bare factorization and for solvers that only find a rank.
    pub reduction: Option<Reduction>,
    /// The analysis by the method; `None` for a bare factorization and for other libraries.
    pub analysis: Option<Analysis>,
}

/// A run shorter than `SLOW` seconds is repeated at least once, and until all its runs together take `WARM` seconds. At most `REPEATS`
/// repetitions are made.
const SLOW: f64 = 0.25;
const WARM: f64 = 0.01;
/// Largest number of repetitions of a run.
const REPEATS: usize = 10;

/// As [`once`], but with warm caches. Without this, the first method of every round would seem slow.
pub fn warm(system: &ConstraintSystem, method: &BenchMethod) -> Result<Done, GivenUpReason> {
    warmed(once(system, method)?, system, method)
}

/// [`warm`] for a method that has run once, with the result `done`.
pub fn warmed(mut done: Done, system: &ConstraintSystem, method: &BenchMethod) -> Result<Done, GivenUpReason> {
    let mut total = done.time;
    for repeat in 0..REPEATS {
        if total >= if repeat == 0 { SLOW } else { WARM } {
            break;
        }
        // Free the memory of this run before the next.
        drop(done);
        done = once(system, method)?;
        total += done.time;
    }
    Ok(done)
}

/// One run. The error is that of the method, usually a lack of memory.
pub fn once(system: &ConstraintSystem, method: &BenchMethod) -> Result<Done, GivenUpReason> {
    match &method.engine {
        Engine::BareQr => bare(system),
        Engine::Qless(options) => qless(system, options),
        #[cfg(feature = "peers")]
        Engine::Peer(backend, tolerance) => {
            let start = Instant::now();
            let reduction = super::peers::eliminate::eliminate(system, backend.as_ref(), *tolerance)?;
            let time = start.elapsed().as_secs_f64();
            Ok(Done { time, rank: reduction.slaves().len(), reduction: Some(reduction), analysis: None })
        }
        #[cfg(feature = "peers")]
        Engine::Solver(solver) => {
            let mut answers = solver.ranks(&[system]).map_err(GivenUpReason::Failed)?;
            let (rank, time) = answers.swap_remove(0).map_err(GivenUpReason::Failed)?;
            Ok(Done { time, rank, reduction: None, analysis: None })
        }
    }
}

fn qless(system: &ConstraintSystem, options: &Options) -> Result<Done, GivenUpReason> {
    let start = Instant::now();
    let analysis = analyse(system, options)?;
    let time = start.elapsed().as_secs_f64();
    let reduction = analysis.reduction()?;
    Ok(Done { time, rank: analysis.rank(), reduction: Some(reduction), analysis: Some(analysis) })
}

/// The rank that a method finds, and whether it is in doubt.
pub type BenchVerdict = Result<(usize, bool), GivenUpReason>;

/// The ranks that a method finds, and whether they are in doubt; computes no reduction.
pub fn verdicts(systems: &[&ConstraintSystem], method: &BenchMethod) -> Result<Vec<BenchVerdict>, GivenUpReason> {
    #[cfg(feature = "peers")]
    if let Engine::Solver(solver) = &method.engine {
        let answers = solver.ranks(systems).map_err(GivenUpReason::Failed)?.into_iter();
        let sure = |(rank, _)| (rank, false);
        return Ok(answers.map(|answer| answer.map(sure).map_err(GivenUpReason::Failed)).collect());
    }
    Ok(systems.par_iter().map(|system| verdict(system, method)).collect())
}

fn verdict(system: &ConstraintSystem, method: &BenchMethod) -> BenchVerdict {
    let Engine::Qless(options) = &method.engine else {
        return once(system, method).map(|done| (done.rank, false));
    };
    let analysis = analyse(system, options)?;
    Ok((analysis.rank(), analysis.confidence().ambiguous))
}

/// The tolerance of the bare factorization: absolute as in the paper, but as small as the default.
const TOLERANCE: f64 = 1e-10;

/// Factors every block by QR, then the transpose of every block, and returns the faster of the two. The time to split into blocks is not
/// included.
fn bare(system: &ConstraintSystem) -> Result<Done, GivenUpReason> {
    let backend = BackendChoice::Sparse.get(Options::default().memory)?;
    let blocks = blocks(system);
    let factored = |side: FigureSide| -> Result<(f64, usize), BackendError> {
        let start = Instant::now();
        let rank = factor(&blocks, backend.as_ref(), side, TOLERANCE)?;
        Ok((start.elapsed().as_secs_f64(), rank))
    };
    let [of_c, transposed] = FigureSide::BOTH.map(factored);
    let (of_c, transposed) = (of_c?, transposed?);
    let (time, rank) = if of_c.0 < transposed.0 { of_c } else { transposed };
    Ok(Done { time, rank, reduction: None, analysis: None })
}

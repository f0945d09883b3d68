//! The whole elimination by one method, from the validated system to T, G, g.

use std::time::Instant;

use qless::{Analysis, ConstraintSystem, Options, Reduction, analyse};

use super::given_up::GivenUpReason;
use super::methods::{BenchMethod, Engine};

/// The result of one run of a method.
pub struct Done {
    /// Seconds.
    pub time: f64,
    pub reduction: Reduction,
    /// `None` for other libraries.
    pub analysis: Option<Analysis>,
}

/// A run shorter than `SLOW` is repeated once, and then until the total time is `WARM`; seconds.
const SLOW: f64 = 0.25;
const WARM: f64 = 0.01;
/// Limit for the repetitions.
const REPEATS: usize = 10;

/// As [`once`], but with warm caches: otherwise the first method of every round would seem slow.
pub fn warm(system: &ConstraintSystem, method: &BenchMethod) -> Result<Done, GivenUpReason> {
    warmed(once(system, method)?, system, method)
}

/// The same for a method that has run once.
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

/// One run. The error is that of the method, mostly insufficient memory.
pub fn once(system: &ConstraintSystem, method: &BenchMethod) -> Result<Done, GivenUpReason> {
    match &method.engine {
        Engine::Qless(options, None) => qless(system, options),
        Engine::Qless(options, Some(pool)) => pool.install(|| qless(system, options)),
        #[cfg(feature = "peers")]
        Engine::Peer(backend, tolerance) => {
            let start = Instant::now();
            let reduction = super::peers::eliminate::eliminate(system, backend.as_ref(), *tolerance)?;
            Ok(Done { time: start.elapsed().as_secs_f64(), reduction, analysis: None })
        }
    }
}

fn qless(system: &ConstraintSystem, options: &Options) -> Result<Done, GivenUpReason> {
    let start = Instant::now();
    let analysis = analyse(system, options)?;
    let reduction = analysis.reduction()?;
    Ok(Done { time: start.elapsed().as_secs_f64(), reduction, analysis: Some(analysis) })
}

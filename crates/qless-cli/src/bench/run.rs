//! The whole elimination by one method, from the validated system to T, G, g.

use std::time::Instant;

use qless::{Analysis, ConstraintSystem, Options, Reduction, analyse};

use super::methods::{Engine, Method};

/// What a method made of a system.
pub struct Done {
    /// Seconds.
    pub time: f64,
    pub reduction: Reduction,
    /// None for other libraries.
    pub analysis: Option<Analysis>,
}

/// None where the method fails (for want of memory).
pub fn once(system: &ConstraintSystem, method: &Method) -> Option<Done> {
    match &method.engine {
        Engine::Qless(options, None) => qless(system, options),
        Engine::Qless(options, Some(pool)) => pool.install(|| qless(system, options)),
        #[cfg(feature = "peers")]
        Engine::Peer(backend, tolerance) => {
            let start = Instant::now();
            let reduction = super::peers::eliminate::eliminate(system, backend.as_ref(), *tolerance).ok()?;
            Some(Done { time: start.elapsed().as_secs_f64(), reduction, analysis: None })
        }
    }
}

fn qless(system: &ConstraintSystem, options: &Options) -> Option<Done> {
    let start = Instant::now();
    let analysis = analyse(system, options).ok()?;
    let reduction = analysis.reduction(system);
    Some(Done { time: start.elapsed().as_secs_f64(), reduction, analysis: Some(analysis) })
}

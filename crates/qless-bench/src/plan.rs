//! Decides which methods run on a system, and in which process, from their times on a smaller system.

use super::given_up::GivenUpReason;
use super::methods::BenchMethod;
use crate::BenchArgs;

/// The result of a method on the previous system of its family.
#[derive(Clone, Copy)]
pub enum Past {
    Took { seconds: f64, equations: usize },
    Stopped { equations: usize },
}

/// The process in which a method runs.
pub enum MeasurementPlan {
    Here,
    /// In a process that can be stopped.
    Apart,
    Nowhere(GivenUpReason),
}

/// Time limit of a method in seconds.
pub fn limit(method: &BenchMethod, args: &BenchArgs) -> f64 {
    args.peer_limit.filter(|_| method.is_peer()).unwrap_or(args.limit)
}

/// Predicts the time as if it grew with the square of the number of equations: too much for sparse methods, too little for dense ones.
/// If the prediction exceeds the limit, methods of qless run in a process that can be stopped, and other libraries do not run.
pub fn plan(method: &BenchMethod, past: Option<Past>, equations: usize, limit: f64) -> MeasurementPlan {
    let square = |before: usize| (equations as f64 / before as f64).powi(2);
    match past {
        Some(Past::Stopped { equations }) => MeasurementPlan::Nowhere(GivenUpReason::Smaller { equations, limit }),
        Some(Past::Took { seconds, equations }) if seconds * square(equations) > limit => {
            let seconds = seconds * square(equations);
            if method.is_peer() {
                MeasurementPlan::Nowhere(GivenUpReason::Foreseen { seconds, limit })
            } else {
                MeasurementPlan::Apart
            }
        }
        _ if method.is_apart => MeasurementPlan::Apart,
        _ => MeasurementPlan::Here,
    }
}

#[cfg(test)]
mod tests {
    use super::super::methods;
    use super::{GivenUpReason, MeasurementPlan, Past, plan};

    /// Slow methods of qless run in a process of their own, unless they were stopped on a smaller system.
    #[test]
    fn ours_are_tried_where_time_is_foreseen_and_not_where_it_was_stopped() {
        let all = methods::all(&[]);
        let ours = all.iter().find(|method| method.name == "gauss alone").expect("ours");
        let took = |seconds| Some(Past::Took { seconds, equations: 100 });
        assert!(matches!(plan(ours, None, 100_000, 10.0), MeasurementPlan::Here));
        assert!(matches!(plan(ours, took(1.0), 300, 10.0), MeasurementPlan::Here));
        assert!(matches!(plan(ours, took(1.0), 400, 10.0), MeasurementPlan::Apart));
        let stopped = plan(ours, Some(Past::Stopped { equations: 100 }), 400, 10.0);
        assert!(matches!(stopped, MeasurementPlan::Nowhere(GivenUpReason::Smaller { equations: 100, .. })));
        let apart = all.iter().find(|method| method.is_apart).expect("one");
        assert!(matches!(plan(apart, None, 1, 10.0), MeasurementPlan::Apart));
        for peer in all.iter().filter(|method| method.is_peer()) {
            assert!(matches!(
                plan(peer, took(1.0), 400, 10.0),
                MeasurementPlan::Nowhere(GivenUpReason::Foreseen { .. })
            ));
            assert!(matches!(plan(peer, took(1.0), 300, 10.0), MeasurementPlan::Apart));
        }
    }
}

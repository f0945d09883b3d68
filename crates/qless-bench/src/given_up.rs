//! The reasons why a method has no result on a system, and their texts.

use qless::backend::BackendError;
use qless::{AnalysisError, ReductionError};

/// The reason why a method has no result.
#[derive(Clone, Debug, PartialEq)]
pub enum GivenUpReason {
    /// The time predicted from a smaller system of the same family exceeds the limit. Both are in seconds.
    Foreseen { seconds: f64, limit: f64 },
    /// The method was stopped on a smaller system with this number of equations.
    Smaller { equations: usize, limit: f64 },
    /// The process of the method was stopped.
    Stopped { limit: f64 },
    /// The process of the method ended without an answer.
    Ended,
    /// The error message of the method.
    Failed(String),
}

impl GivenUpReason {
    /// The text; `dense` is the size of the matrix of a dense method.
    pub fn words(&self, dense: Option<(usize, usize)>) -> String {
        let why = match self {
            Self::Foreseen { seconds, limit } => format!("{seconds:.0} s foreseen, limit of {limit} s"),
            Self::Smaller { equations, limit } => {
                format!("stopped on {} equations already, limit of {limit} s", thousands(*equations))
            }
            Self::Stopped { limit } => format!("stopped at the limit of {limit} s"),
            Self::Ended => "its process ended without an answer".to_owned(),
            Self::Failed(words) => words.clone(),
        };
        dense.map_or(why.clone(), |(rows, cols)| format!("{}; {why}", of_dense(rows, cols)))
    }
}

/// A text such as `dense 31,832 x 48,488 are 11.5 GiB`.
fn of_dense(rows: usize, cols: usize) -> String {
    let mib = 8.0 * rows as f64 * cols as f64 / f64::from(1 << 20);
    let size = if mib < 1024.0 { format!("{mib:.0} MiB") } else { format!("{:.1} GiB", mib / 1024.0) };
    format!("dense {} x {} are {size}", thousands(rows), thousands(cols))
}

/// The number with a comma before every three digits, such as `31,832`.
pub fn thousands(number: usize) -> String {
    let digits = number.to_string();
    let mut out = String::new();
    for (k, digit) in digits.chars().enumerate() {
        if k > 0 && (digits.len() - k).is_multiple_of(3) {
            out.push(',');
        }
        out.push(digit);
    }
    out
}

impl From<BackendError> for GivenUpReason {
    fn from(error: BackendError) -> Self {
        Self::Failed(match error {
            BackendError::OutOfMemory { .. } => "more memory than it may have".to_owned(),
            other => other.to_string(),
        })
    }
}

impl From<AnalysisError> for GivenUpReason {
    fn from(error: AnalysisError) -> Self {
        Self::Failed(error.to_string())
    }
}

impl From<ReductionError> for GivenUpReason {
    fn from(error: ReductionError) -> Self {
        Self::Failed(error.to_string())
    }
}

#[cfg(test)]
mod tests {
    use qless::backend::BackendError;

    use super::GivenUpReason;

    #[test]
    fn a_dense_method_says_how_large_it_would_be() {
        let dense = Some((31_832, 48_488));
        let words = |reason: GivenUpReason| reason.words(dense);
        let no_memory = BackendError::OutOfMemory { backend: "dgeqp3", rows: 31_832, cols: 48_488, advice: "" };
        assert_eq!(words(no_memory.into()), "dense 31,832 x 48,488 are 11.5 GiB; more memory than it may have");
        let stopped = GivenUpReason::Stopped { limit: 4.0 };
        assert_eq!(words(stopped.clone()), "dense 31,832 x 48,488 are 11.5 GiB; stopped at the limit of 4 s");
        assert_eq!(stopped.words(Some((1000, 1000))), "dense 1,000 x 1,000 are 8 MiB; stopped at the limit of 4 s");
        assert_eq!(stopped.words(None), "stopped at the limit of 4 s");
    }

    #[test]
    fn the_others_say_what_is_known() {
        let foreseen = GivenUpReason::Foreseen { seconds: 29.6, limit: 10.0 };
        assert_eq!(foreseen.words(None), "30 s foreseen, limit of 10 s");
        let smaller = GivenUpReason::Smaller { equations: 7_580, limit: 0.5 };
        assert_eq!(smaller.words(None), "stopped on 7,580 equations already, limit of 0.5 s");
        let limit = BackendError::OverLimit { backend: "gauss", rows: 1, cols: 2, needed: 3 << 20, limit: 1 << 20 };
        assert!(GivenUpReason::from(limit).words(None).starts_with("gauss: a block of 1 x 2 needs 3 MiB"));
    }
}

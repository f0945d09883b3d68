//! The measurements of each method on each system.

use super::systems::TIE;

/// A method on a system.
pub struct Sample {
    pub family: &'static str,
    pub size: String,
    pub equations: usize,
    pub method: &'static str,
    pub rank: usize,
    /// The error is the reason why the method was given up.
    pub result: Result<Measured, String>,
}

impl Sample {
    /// `None` if the method was given up.
    pub fn measured(&self) -> Option<Measured> {
        self.result.as_ref().ok().copied()
    }
}

/// Time and quality of the result; see `quality`.
#[derive(Clone, Copy, serde::Serialize, serde::Deserialize)]
pub struct Measured {
    /// Median and quartiles, seconds.
    pub time: f64,
    pub quartiles: (f64, f64),
    pub rank: usize,
    pub ambiguous: bool,
    pub false_drops: usize,
    pub false_keeps: usize,
    pub residual: f64,
    pub growth: f64,
    /// Error of the solved problem; `None` if it was not solved.
    pub error: Option<f64>,
    /// Peak memory in bytes beyond that before the run; `None` if it was not measured.
    pub memory: Option<u64>,
}

/// Whether the rank is right.
pub fn verdict(sample: &Sample, measured: &Measured) -> &'static str {
    match measured.rank.cmp(&sample.rank) {
        std::cmp::Ordering::Equal => "right",
        std::cmp::Ordering::Less => "drops",
        std::cmp::Ordering::Greater => "keeps",
    }
}

/// Sizes and times of a method on the paper's tie, and the exponent by least squares of logarithms.
pub fn series(samples: &[Sample], method: &str) -> (Vec<(f64, f64)>, Option<f64>) {
    let of = samples.iter().filter(|sample| sample.family == TIE && sample.method == method);
    let points: Vec<(f64, f64)> =
        of.filter_map(|sample| Some((sample.equations as f64, 1e3 * sample.measured()?.time))).collect();
    let n = points.len() as f64;
    let mean = |f: &dyn Fn(&(f64, f64)) -> f64| points.iter().map(f).sum::<f64>() / n;
    let (x, y) = (mean(&|p| p.0.ln()), mean(&|p| p.1.ln()));
    let (xy, xx) = (mean(&|p| (p.0.ln() - x) * (p.1.ln() - y)), mean(&|p| (p.0.ln() - x).powi(2)));
    let exponent = (xx > 0.0).then(|| xy / xx);
    (points, exponent)
}

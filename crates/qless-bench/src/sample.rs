//! The measurements of each method on each system.

use super::systems::TIE;

/// The measurement of a method on a system.
pub struct Sample {
    pub family: &'static str,
    pub size: String,
    pub equations: usize,
    pub method: &'static str,
    pub rank: usize,
    /// The measurements, or the reason why the method was given up.
    pub result: Result<Measured, String>,
}

impl Sample {
    /// The measurements; `None` if the method was given up.
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
    /// Of T, G and g; `None` for a method that computes no reduction.
    pub residual: Option<f64>,
    pub growth: Option<f64>,
    /// Error of the solved problem; `None` if it was not solved.
    pub error: Option<f64>,
    /// Peak memory in bytes beyond that before the run; `None` if it was not measured.
    pub memory: Option<u64>,
}

/// `right` if the rank is right, `drops` if it is too small, `keeps` if it is too large.
pub fn verdict(sample: &Sample, measured: &Measured) -> &'static str {
    match measured.rank.cmp(&sample.rank) {
        std::cmp::Ordering::Equal => "right",
        std::cmp::Ordering::Less => "drops",
        std::cmp::Ordering::Greater => "keeps",
    }
}

/// Times of a method on the paper's tie against the number of equations.
pub struct Series {
    /// Equations and milliseconds.
    pub points: Vec<(f64, f64)>,
    /// The exponent of the least-squares line through the logarithms, and its standard error; `None` if they are not meaningful.
    pub slope: Option<(f64, f64)>,
}

/// Least number of sizes for an exponent; a line fits two sizes exactly.
const SIZES: usize = 4;
/// Runs shorter than this, in milliseconds, are disturbed by other work of the machine.
const SHORT: f64 = 0.05;
/// With a larger standard error, an exponent does not distinguish linear from quadratic growth.
const VAGUE: f64 = 0.25;

impl Series {
    pub fn new(samples: &[Sample], method: &str) -> Self {
        let of = samples.iter().filter(|sample| sample.family == TIE && sample.method == method);
        let points: Vec<(f64, f64)> =
            of.filter_map(|sample| Some((sample.equations as f64, 1e3 * sample.measured()?.time))).collect();
        let is_short = points.iter().any(|&(_, time)| time < SHORT);
        let slope = slope(&points).filter(|&(_, error)| points.len() >= SIZES && !is_short && error <= VAGUE);
        Self { points, slope }
    }

    /// `exponent 1.02 ± 0.05`, or the reason why there is no exponent.
    pub fn words(&self) -> String {
        match self.slope {
            Some((exponent, error)) => format!("exponent {exponent:.2} ± {error:.2}"),
            None => "runs too short, few or noisy for an exponent".to_owned(),
        }
    }
}

fn slope(points: &[(f64, f64)]) -> Option<(f64, f64)> {
    let n = points.len() as f64;
    let mean = |f: &dyn Fn(&(f64, f64)) -> f64| points.iter().map(f).sum::<f64>() / n;
    let (x, y) = (mean(&|p| p.0.ln()), mean(&|p| p.1.ln()));
    let (xy, xx) = (mean(&|p| (p.0.ln() - x) * (p.1.ln() - y)), mean(&|p| (p.0.ln() - x).powi(2)));
    let exponent = xy / xx;
    let rest = mean(&|p| (p.1.ln() - y - exponent * (p.0.ln() - x)).powi(2));
    (n > 2.0 && xx > 0.0).then(|| (exponent, (rest / xx / (n - 2.0)).sqrt()))
}

//! Crossings of the times of Gauss elimination and of a QR, and a sentence about them; the paper's own times.

use super::super::given_up::thousands;
use super::{FigureLevel, FigureSide, GAUSS};

/// The times of Gauss elimination and of a QR on one system.
#[derive(Clone)]
pub struct Pair {
    pub size: String,
    pub equations: f64,
    /// Seconds of Gauss elimination.
    pub gauss: f64,
    pub qr: f64,
}

impl Pair {
    pub fn ratio(&self) -> f64 {
        self.gauss / self.qr
    }

    fn is_gauss_faster(&self) -> bool {
        self.gauss < self.qr
    }
}

/// A crossing between the pair with the index `after` and the next one: equations and seconds, interpolated linearly in logarithms.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    pub after: usize,
    pub equations: f64,
    pub time: f64,
}

/// All crossings of pairs in ascending size.
pub fn crossings(pairs: &[Pair]) -> Vec<Crossing> {
    let changes = |k: &usize| pairs[*k].is_gauss_faster() != pairs[k + 1].is_gauss_faster();
    (0..pairs.len().saturating_sub(1))
        .filter(changes)
        .map(|after| between(after, &pairs[after], &pairs[after + 1]))
        .collect()
}

fn between(after: usize, a: &Pair, b: &Pair) -> Crossing {
    let (before, behind) = (a.ratio().ln(), b.ratio().ln());
    let part = before / (before - behind);
    let along = |from: f64, to: f64| f64::exp(from.ln() + part * (to / from).ln());
    Crossing { after, equations: along(a.equations, b.equations), time: along(a.gauss, b.gauss) }
}

/// States which method is faster at which sizes, and the ratio at both ends; `None` for fewer than two pairs.
pub fn sentence(pairs: &[Pair]) -> Option<String> {
    let [first, .., last] = pairs else { return None };
    let found = crossings(pairs);
    let who = |pair: &Pair| if pair.is_gauss_faster() { "Gauss" } else { "QR" };
    let head = match found.as_slice() {
        [] => format!("{} is faster on every level", who(first)),
        [one] => format!(
            "{} is faster up to {}, {} from {} on; they cross at about {} equations",
            who(first),
            pairs[one.after].size,
            who(last),
            pairs[one.after + 1].size,
            rounded(one.equations)
        ),
        many => {
            let places: Vec<String> = many.iter().map(|crossing| rounded(crossing.equations)).collect();
            let (last_place, others) = places.split_last()?;
            format!(
                "they cross {} times, at about {} and {last_place} equations; from there on {} is faster",
                many.len(),
                others.join(", "),
                who(last)
            )
        }
    };
    Some(format!(
        "{head} (Gauss takes {:.2} times as long as QR at {}, {:.2} times at {})",
        first.ratio(),
        first.size,
        last.ratio(),
        last.size
    ))
}

/// Rounds to hundreds, since the measured levels do not determine a crossing more accurately.
fn rounded(equations: f64) -> String {
    thousands((equations / 100.0).round() as usize * 100)
}

/// The levels on which both methods were measured.
pub fn pairs(levels: &[FigureLevel], family: &str, side: FigureSide, qr: &str) -> Vec<Pair> {
    let pair = |level: &FigureLevel| {
        let (gauss, qr) = (level.time(GAUSS, side)?, level.time(qr, side)?);
        Some(Pair { size: level.size.clone(), equations: level.equations as f64, gauss, qr })
    };
    levels.iter().filter(|level| level.family == family).filter_map(pair).collect()
}

/// Table 1 of the paper: percent, equations, seconds of three trials of the block-wise Gauss elimination, and of three trials of the Q-less
/// sparse QR.
#[rustfmt::skip]
const TABLE_1: [(u32, u32, [f64; 3], [f64; 3]); 7] = [
    (50, 7_580, [1.807, 1.895, 1.818], [3.061, 3.127, 3.029]),
    (60, 10_300, [4.894, 4.926, 4.853], [5.929, 5.939, 5.992]),
    (70, 13_808, [10.239, 10.099, 10.149], [11.510, 11.475, 11.442]),
    (80, 17_408, [20.795, 20.799, 20.954], [20.999, 21.185, 20.908]),
    (90, 22_360, [42.539, 42.525, 43.309], [39.294, 38.614, 38.267]),
    (100, 26_888, [67.737, 68.974, 68.636], [60.456, 60.309, 61.426]),
    (110, 31_832, [126.666, 128.127, 128.739], [99.192, 96.681, 96.195]),
];

/// The paper's times on all levels.
pub fn papers_pairs() -> Vec<Pair> {
    let mean = |trials: [f64; 3]| trials.iter().sum::<f64>() / 3.0;
    let pair = |(percent, equations, gauss, qr): (u32, u32, [f64; 3], [f64; 3])| Pair {
        size: format!("{percent} %"),
        equations: f64::from(equations),
        gauss: mean(gauss),
        qr: mean(qr),
    };
    TABLE_1.map(pair).into()
}

//! Where the times of Gauss elimination and of a QR cross, and what to say of it.

use super::super::table::thousands;

/// Both on one system.
#[derive(Clone)]
pub struct Pair {
    pub size: String,
    pub equations: f64,
    /// Seconds.
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

/// A crossing after the k-th of the pairs: equations and seconds, on straight lines in logarithms.
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

/// Who is faster where, and by how much at both ends; nothing where nothing was measured.
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

/// To the next hundred, which is more than two levels tell.
fn rounded(equations: f64) -> String {
    thousands((equations / 100.0).round() as usize * 100)
}

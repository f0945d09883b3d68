//! The share of wrong verdicts without a warning for each effort, over seeded systems of known rank.

use std::fmt::Write;

use qless_scenes::families::{Near, near, planted, random_graph, rbe2, typed_twice};
use qless_scenes::{Scene, SceneError};
use rayon::prelude::*;

use super::methods::{BenchMethod, UNIT};
use super::run::{BenchVerdict, verdicts};

/// Number of seeded systems.
const COUNT: u64 = 2_000;
/// Number of seeded systems in the short form.
const SHORT: u64 = 200;

/// Counts of the verdicts of a method on seeded systems.
pub struct WrongShare {
    pub method: &'static str,
    pub systems: usize,
    /// Number of wrong ranks that are not in doubt, and of failures.
    pub wrong: usize,
    /// Number of ranks in doubt.
    pub doubtful: usize,
}

/// A system of a few dozen equations: combinations, rings, equations typed with 4 to 8 digits, rigid links, or triples at a distance of
/// 1e-2 to 1e-9 from dependence. Some have rows in other units.
fn scene(seed: u64) -> Result<Scene, SceneError> {
    let n = 6 + (seed / 6 % 20) as usize;
    match seed % 6 {
        0 => planted(n, 2 * n, n / 2, seed, seed % 12 == 6),
        1 => Ok(planted(n, 2 * n, n / 2, seed, false)?.scale_rows(40, seed)?.0),
        2 => random_graph(n, 2 * n, seed),
        3 => typed_twice(n, 4 + (seed / 6 % 5) as usize, seed),
        4 => near(1 + n / 4, 10_f64.powi(-2 - (seed / 6 % 8) as i32), Near::Shared),
        _ => rbe2(n, 1 + (seed / 6 % 2) as usize, seed),
    }
}

/// Measures all methods except the bare factorization; returns an error if a system cannot be generated.
pub fn measure(methods: &[BenchMethod], is_short: bool) -> Result<Vec<WrongShare>, String> {
    let count = if is_short { SHORT } else { COUNT };
    let scenes: Result<Vec<Scene>, SceneError> = (0..count).into_par_iter().map(scene).collect();
    let scenes = scenes.map_err(|error| error.to_string())?;
    methods.iter().filter(|method| method.name != UNIT).map(|method| share(method, &scenes)).collect()
}

fn share(method: &BenchMethod, scenes: &[Scene]) -> Result<WrongShare, String> {
    let systems: Vec<_> = scenes.iter().map(|scene| &scene.system).collect();
    let found = verdicts(&systems, method).map_err(|reason| format!("{}: {}", method.name, reason.words(None)))?;
    let is_wrong = |(scene, found): &(&Scene, &BenchVerdict)| match found {
        Ok((rank, is_doubtful)) => !is_doubtful && Some(*rank) != scene.truth.rank_free,
        Err(_) => true,
    };
    let wrong = scenes.iter().zip(&found).filter(is_wrong).count();
    let doubtful = found.iter().flatten().filter(|(_, is_doubtful)| *is_doubtful).count();
    Ok(WrongShare { method: method.name, systems: found.len(), wrong, doubtful })
}

/// A table in Markdown, which can be read as text too.
pub fn table(shares: &[WrongShare]) -> String {
    let mut text = "| method | wrong without a warning | in doubt | of |\n| --- | --- | --- | --- |\n".to_owned();
    for WrongShare { method, systems, wrong, doubtful } in shares {
        _ = writeln!(text, "| {method} | {wrong} | {doubtful} | {systems} |");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::super::methods;

    #[test]
    fn only_efforts_that_check_are_never_wrong_without_a_word() {
        let names = ["checked", "proved", "exact"].map(str::to_owned);
        for share in super::measure(&methods::all(&names), true).expect("scenes") {
            assert_eq!((share.wrong, share.systems), (0, 200), "{}", share.method);
        }
    }
}

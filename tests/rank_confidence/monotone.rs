//! If a system of a family that gets worse step by step is in doubt, all further ones are too.
//!
//! A family ends where some units in the last place of coefficients that are there make rows dependent exactly, as in `near` with
//! an eps of rounding: sums of decimals differ by that much, and an equation said twice is redundant without any doubt. Chains and
//! triangles are never in doubt: whatever is done to their coefficients one by one, square triangular equations stay independent and
//! have a solution, however small their singular values.

use std::fmt::Write;

use qless::{BackendChoice, ConstraintSystem, Kind, Noise, Options, SystemBuilder, analyse};
use qless_scenes::families::{self, Near};
use qless_scenes::oracle::{rank_free, singular_values};
use qless_scenes::{Rng, Scene};

use super::checks::text;
use super::scenes::triangle;
use crate::support::settings;

/// A name and systems from well-conditioned to nearly dependent.
type Family = (String, Vec<(String, ConstraintSystem)>);

on_each_backend!(
    near_dependence,
    chains_with_a_factor,
    chains_that_grow,
    recurrences,
    triangles,
    equations_typed_twice,
    near_dependence_beside_a_chain,
);

fn family(name: String, steps: impl Iterator<Item = (String, Scene)>) -> Family {
    (name, steps.map(|(step, scene)| (step, scene.system)).collect())
}

/// Once a step is flagged, all later ones must be, and the last one is.
fn check(backend: BackendChoice, families: &[Family], noise: &Noise) {
    let mut faults = Vec::new();
    for (name, steps) in families {
        for options in settings(backend) {
            let options = Options { noise: noise.clone(), ..options };
            let mut first: Option<&str> = None;
            let (mut lost, mut history) = (Vec::new(), String::new());
            for (step, system) in steps {
                let analysis = analyse(system, &options).unwrap_or_else(|e| panic!("{name}, {step}: {e}"));
                let conflict = analysis.kinds().contains(&Kind::Conflicting);
                let confidence = analysis.confidence();
                let flag = confidence.ambiguous;
                let marks = [(flag, "?"), (conflict, "!")].map(|(is, mark)| if is { mark } else { "" }).concat();
                write!(history, " {step}:{}{marks}", analysis.rank()).expect("text");
                match first {
                    None if flag => first = Some(step),
                    Some(first) if !flag => {
                        let sigma = singular_values(system).expect("within reach").last().copied().unwrap_or(0.0);
                        let rank = (analysis.rank(), rank_free(system).expect("within reach"));
                        let kept = confidence.distance;
                        lost.push(format!(
                            "{step} (doubt from {first}): sigma {sigma:.1e}, distance {kept:.1e}, rank and exact rank {rank:?}, conflicting {conflict}"
                        ));
                    }
                    _ => {}
                }
            }
            let what = format!("{name} [{}]", text(&options));
            if let Some(last) = lost.last() {
                faults.push(format!("{what}: {} steps without doubt, last {last};{history}", lost.len()));
            }
            if first.is_none() {
                faults.push(format!("{what}: never in doubt;{history}"));
            }
        }
    }
    assert!(faults.is_empty(), "{} faults:\n{}", faults.len(), faults.join("\n"));
}

/// Every step has full rank, without doubt.
fn check_sure(backend: BackendChoice, families: &[Family]) {
    let mut faults = Vec::new();
    for ((name, steps), options) in
        families.iter().flat_map(|family| settings(backend).map(|options| (family, options)))
    {
        for (step, system) in steps {
            let analysis = analyse(system, &options).unwrap_or_else(|e| panic!("{name}, {step}: {e}"));
            if analysis.rank() < system.equations() || analysis.confidence().ambiguous {
                let said = (analysis.rank(), analysis.confidence());
                faults.push(format!("{name}, {step} [{}]: {said:?}", text(&options)));
            }
        }
    }
    assert!(faults.is_empty(), "{} faults:\n{}", faults.len(), faults.join("\n"));
}

/// 10, 5 and 2 times each power of ten, down to 45 units in the last place.
fn distances() -> impl Iterator<Item = f64> {
    let decade = |digits: i32| [1.0, 0.5, 0.2].map(|part| part * 10_f64.powi(-digits));
    (1..=14).flat_map(decade).filter(|&eps| eps >= 0.99e-14)
}

fn near(triples: usize, column: Near) -> impl Iterator<Item = (String, Scene)> {
    distances().map(move |eps| (format!("{eps:.0e}"), families::near(triples, eps, column).expect("in range")))
}

fn near_dependence(backend: BackendChoice) {
    let each = [1, 3, 20].into_iter().flat_map(|triples| [Near::Own, Near::Shared].map(|column| (triples, column)));
    let all = each.map(|(triples, column)| family(format!("near({triples}, eps, {column:?})"), near(triples, column)));
    // Coefficients are typed with just the digits by which rows differ: as digits are read, every step is in doubt.
    check(backend, &all.collect::<Vec<_>>(), &Noise::None);
}

fn chain(n: usize, factor: f64) -> Scene {
    families::geometric_chain(n, factor).expect("in range")
}

/// Each DOF makes the smallest singular value smaller by the factor.
fn chains_that_grow(backend: BackendChoice) {
    let steps = |factor: f64| (2..120).map(move |n| (format!("{n}"), chain(n, factor)));
    let all = [1.5, 2.0, 10.0, -3.0, 1e3].map(|factor| family(format!("geometric_chain(n, {factor})"), steps(factor)));
    check_sure(backend, &all);
}

fn chains_with_a_factor(backend: BackendChoice) {
    let steps = |n: usize| (0..60).map(move |k| 1.25_f64.powi(k)).map(move |f| (format!("{f:.2}"), chain(n, f)));
    let all = [5, 10, 20, 60].map(|n| family(format!("geometric_chain({n}, factor)"), steps(n)));
    check_sure(backend, &all);
}

fn recurrences(backend: BackendChoice) {
    let steps = (1..150).map(|rows| (format!("{rows}"), families::recurrence(rows).expect("in range")));
    check_sure(backend, &[family("recurrence(rows)".into(), steps)]);
}

/// Square systems: n equations on n DOFs.
fn triangles(backend: BackendChoice) {
    let steps = |c: f64| (2..100).map(move |n| (format!("{n}"), triangle(n, c, false)));
    let all = [0.285, 0.5, 1.0].map(|c| family(format!("triangle(n, {c}, square)"), steps(c)));
    check_sure(backend, &all);
}

/// One equation in three is typed again with `digits` digits: like `families::typed_twice`, but beyond 8 digits.
fn typed_twice(seed: u64, digits: usize) -> ConstraintSystem {
    let (n, mut rng) = (20, Rng::new(seed));
    let mut builder = SystemBuilder::new(2 * n);
    for i in 0..n {
        let mut row: Vec<(usize, f64)> = (0..2).map(|k| (2 * i + k, rng.real())).collect();
        row.iter_mut().for_each(|(_, v)| *v += v.signum());
        let later = 2 * (n - 1 - i);
        let others = rng.distinct(3, later).expect("few");
        row.extend(others.into_iter().map(|k| (2 * i + 2 + k, 0.25 * rng.real())));
        if i % 3 == 0 {
            let typed = |v: f64| format!("{v:.*e}", digits - 1).parse::<f64>().expect("a number");
            builder.equation(row.iter().map(|&(j, v)| (j, typed(v))), 1.0);
        }
        builder.equation(row, 1.0);
    }
    builder.build().expect("valid")
}

fn equations_typed_twice(backend: BackendChoice) {
    let own = |seed| (4..=12).map(|digits| (format!("{digits}"), typed_twice(seed, digits))).collect();
    let all: Vec<Family> = (1..=10).map(|seed| (format!("monotone::typed_twice({seed}, digits)"), own(seed))).collect();
    check(backend, &all, &Noise::Auto);
    let scene = |seed, digits| families::typed_twice(30, digits, seed).expect("in range");
    let steps = |seed| (4..=8).map(move |digits| (format!("{digits}"), scene(seed, digits)));
    let all: Vec<Family> =
        (1..=10).map(|seed| family(format!("typed_twice(30, digits, {seed})"), steps(seed))).collect();
    check(backend, &all, &Noise::Auto);
}

/// Well-conditioned components of any length do not hide the doubt.
fn near_dependence_beside_a_chain(backend: BackendChoice) {
    let harmless: Vec<(String, Scene)> = vec![
        ("rotations(3)".into(), families::rotations(3).expect("in range")),
        ("rotations(50)".into(), families::rotations(50).expect("in range")),
        ("rotations(200)".into(), families::rotations(200).expect("in range")),
        ("path(400)".into(), families::path(400).expect("in range")),
        ("ladder(60)".into(), families::ladder(60).expect("in range")),
        ("spotted_band(64, 1)".into(), families::spotted_band(64, 1).expect("in range")),
    ];
    let mut faults = Vec::new();
    for column in [Near::Own, Near::Shared] {
        for digits in 7..=14 {
            let near = families::near(2, 10_f64.powi(-digits), column).expect("in range");
            for (name, other) in &harmless {
                for (place, scene) in [("before", near.beside(other)), ("after", other.beside(&near))] {
                    let scene = scene.expect("small");
                    let shuffled = scene.shuffle(1).expect("valid").0;
                    for (order, scene) in [("in order", &scene), ("shuffled (1)", &shuffled)] {
                        for options in settings(backend) {
                            let analysis = analyse(&scene.system, &options).expect("valid");
                            if !analysis.confidence().ambiguous {
                                let options = text(&options);
                                faults.push(format!(
                                    "near(2, 1e-{digits}, {column:?}) {place} {name}, {order} [{options}]: rank {}, {:?}",
                                    analysis.rank(),
                                    analysis.confidence()
                                ));
                            }
                        }
                    }
                }
            }
        }
    }
    assert!(faults.is_empty(), "{} faults:\n{}", faults.len(), faults.join("\n"));
}

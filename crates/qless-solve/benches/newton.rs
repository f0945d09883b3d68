//! How the time of a Newton step grows along open chains of bodies: `cargo bench -p qless-solve --bench newton` (`-- --test` for two small
//! sizes).
//!
//! A step consists of c and G at u, the analysis of `G du = -c`, its reduction in factored form, and du. All sizes take turns in one process;
//! exponents are fitted to the medians by least squares of logarithms. The same chains, and unconnected rods, are then solved from a slightly
//! disturbed configuration. `-- spherical`, `-- revolute` or `-- rods` selects one of them.
//!
//! The process keeps its memory between rounds; `-- --fresh` uses the defaults of glibc.

use std::array::from_fn;
use std::hint::black_box;
use std::process::ExitCode;
use std::time::Instant;

use qless::{Form, Options, analyse};
use qless_constraints::types::{Body, Distance, PlanarPoint, Revolute, Spherical};
use qless_constraints::{ConstraintSet, Evaluation, SetBuilder};
use qless_scenes::memory;
use qless_solve::newton::{NewtonOptions, solve};

/// Rounds; all sizes take turns in each.
const ROUNDS: usize = 9;
const STAGES: [&str; 4] = ["linearise", "analyse", "reduce", "expand"];

/// Name, constructor for a number of bodies, and sizes.
type Chain = (&'static str, fn(usize) -> ConstraintSet, &'static [usize]);

fn main() -> ExitCode {
    memory::kept(run)
}

fn run() {
    let short = std::env::args().any(|argument| argument == "--test");
    let chains: [Chain; 3] = [
        ("spherical", spherical, &[200, 400, 800, 1_600, 3_200, 6_400, 12_800]),
        ("revolute", revolute, &[250, 500, 1_000, 2_000, 4_000, 8_000]),
        ("rods", rods, &[1_000, 3_000, 10_000, 30_000, 100_000]),
    ];
    let wanted =
        |name: &str| std::env::args().all(|argument| !chains.iter().any(|(n, ..)| *n == argument) || argument == name);
    for &(name, make, sizes) in chains.iter().filter(|(name, ..)| wanted(name)) {
        growth(name, make, if short { &sizes[..2] } else { sizes });
    }
}

/// A number in [-0.5, 0.5], the same on every machine.
fn random(seed: usize) -> f64 {
    let z = (seed as u64 + 11).wrapping_mul(0x9E37_79B9_7F4A_7C15).rotate_left(29).wrapping_mul(0xD6E8_FEB8_6659_FD93);
    f64::from((z ^ (z >> 32)) as u32) / f64::from(u32::MAX) - 0.5
}

/// Position of joint i: along a line, with some scatter.
fn joint(i: usize) -> [f64; 3] {
    from_fn(|k| 0.6 * random(3 * i + k) + if k == 0 { i as f64 } else { 0.0 })
}

/// Half way between two joints.
fn centre(i: usize) -> [f64; 3] {
    let (p, q) = (joint(i - 1), joint(i));
    from_fn(|k| f64::midpoint(p[k], q[k]))
}

/// Bodies with rotation vectors, connected by ball joints; the first one is on the ground.
fn spherical(bodies: usize) -> ConstraintSet {
    let mut builder = ConstraintSet::builder(6 * bodies);
    let body = |i: usize| match i {
        0 => Body::ground(),
        _ => Body::with_vector(from_fn(|k| 6 * i - 6 + k), centre(i), from_fn(|k| 6 * i - 3 + k)),
    };
    let add = |builder: &mut SetBuilder, i: usize| {
        builder.add("", Spherical { a: body(i), b: body(i + 1), at: joint(i) }).map(drop).expect("valid");
    };
    (0..bodies).for_each(|i| add(&mut builder, i));
    builder.build().expect("few DOFs")
}

/// Bodies with Euler parameters, connected by hinges in different directions; the first one is on the ground.
fn revolute(bodies: usize) -> ConstraintSet {
    let mut builder = ConstraintSet::builder(7 * bodies);
    let body = |i: usize| match i {
        0 => Body::ground(),
        _ => Body::with_euler(from_fn(|k| 7 * i - 7 + k), centre(i), from_fn(|k| 7 * i - 4 + k)),
    };
    for i in 0..bodies {
        let axis = from_fn(|k| random(3 * i + k + 7_919) + if k == i % 3 { 1.0 } else { 0.0 });
        builder.add("", Revolute { a: body(i), b: body(i + 1), at: joint(i), axis }).expect("valid");
    }
    builder.build().expect("few DOFs")
}

/// As many connected parts as rods.
fn rods(rods: usize) -> ConstraintSet {
    let mut builder = ConstraintSet::builder(4 * rods);
    for i in 0..rods {
        let end = |k: usize| PlanarPoint::new([4 * i + 2 * k, 4 * i + 2 * k + 1], [k as f64, random(2 * i + k)]);
        builder.add("", Distance::new(end(0), end(1))).expect("valid");
    }
    builder.build().expect("few DOFs")
}

/// A configuration slightly off the constraints.
fn disturbed(set: &ConstraintSet) -> Vec<f64> {
    (0..set.dofs()).map(|j| 1e-3 * random(j)).collect()
}

/// Seconds of each stage of a step.
fn step(set: &ConstraintSet, u: &[f64], evaluation: &mut Evaluation) -> [f64; 4] {
    let mut marks = vec![Instant::now()];
    set.evaluate(u, evaluation).expect("of this set");
    let system = set.linearised(evaluation, &[]).expect("finite");
    marks.push(Instant::now());
    // As in `newton::solve`.
    let analysis = analyse(&system, &Options { growth: 1e6, ..Options::default() }).expect("analysed");
    marks.push(Instant::now());
    let reduction = analysis.reduction_in(Form::Factored).expect("within the gate");
    marks.push(Instant::now());
    black_box(reduction.expand(&vec![0.0; reduction.masters().len()], &[]).expect("of its lengths"));
    marks.push(Instant::now());
    from_fn(|k| (marks[k + 1] - marks[k]).as_secs_f64())
}

/// Prints a table of all sizes, and the exponents.
fn growth(name: &str, make: fn(usize) -> ConstraintSet, sizes: &[usize]) {
    let sets: Vec<ConstraintSet> = sizes.iter().map(|&bodies| make(bodies)).collect();
    let mut times = vec![Vec::new(); sets.len()];
    for _ in 0..ROUNDS {
        for (set, times) in sets.iter().zip(&mut times) {
            times.push(step(set, &disturbed(set), &mut set.allocate()));
        }
    }
    println!(
        "{:>10} {:>7} {:>9} {:>42} {:>10} {:>18}",
        "joints",
        "bodies",
        "equations",
        STAGES.join(", "),
        "step",
        "solve"
    );
    let mut points = [Vec::new(), Vec::new()];
    for ((set, times), &bodies) in sets.iter().zip(times).zip(sizes) {
        let stages: [f64; 4] = from_fn(|k| median(times.iter().map(|stages| stages[k]).collect()));
        let whole = median(times.iter().map(|stages| stages.iter().sum()).collect());
        let list = stages.map(|seconds| format!("{:.2}", 1e3 * seconds)).join(", ");
        let (solved, steps) = solved(set);
        print!("{name:>10} {bodies:>7} {:>9} {list:>39} ms {:>7.2} ms ", set.equations(), 1e3 * whole);
        println!("{:>7.2} ms in {steps} steps", 1e3 * solved);
        points[0].push((bodies as f64, whole));
        points[1].push((bodies as f64, solved / steps as f64));
    }
    println!("exponents: step {:.2}, solve by steps {:.2}", exponent(&points[0]), exponent(&points[1]));
}

/// Seconds from the disturbed configuration to a consistent one, and the number of iterates.
fn solved(set: &ConstraintSet) -> (f64, usize) {
    let start = Instant::now();
    let solution = solve(set, &disturbed(set), &[], &NewtonOptions::default()).expect("a solution");
    (start.elapsed().as_secs_f64(), solution.iterates.len())
}

/// Slope in doubly logarithmic scale.
fn exponent(points: &[(f64, f64)]) -> f64 {
    let logarithms: Vec<(f64, f64)> = points.iter().map(|(x, y)| (x.ln(), y.ln())).collect();
    let count = points.len() as f64;
    let (x, y) = logarithms.iter().fold((0.0, 0.0), |(a, b), (x, y)| (a + x / count, b + y / count));
    let of = |f: fn(f64, f64) -> f64| logarithms.iter().map(|(a, b)| f(a - x, b - y)).sum::<f64>();
    of(|a, b| a * b) / of(|a, _| a * a)
}

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

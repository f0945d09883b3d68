//! Construction and changes of a set, in units of one evaluation: `cargo bench -p qless-constraints --bench setup` (`-- --test` for a small
//! size, `-- rods` for one kind).
//!
//! Construction: all constraints are added and the arrays of c and G are allocated; the first evaluation of H makes its plan. Limit: 10 times
//! one evaluation of c, G and H.
//! A change: one constraint is deactivated and activated again, gets other parameters, or another right-hand side. Measured: the change
//! itself, and the extra time of the next evaluation.
//!
//! Constraints are added one by one, or in bulk by all threads. Measured on two quiet cores, in bulk: rods 4.6 evaluations for c and G, 15
//! with the plan of H; linear equations 20 and 24, of 2 ms each; equal DOFs 18 and 22. For linear equations more than half of this is the
//! system's time: it provides pages of 4 kB, at about 2 us each, when they are first touched, and construction touches all arrays.

mod model;

use std::time::Instant;

use qless_constraints::types::{Distance, Equal};
use qless_constraints::{ConstraintSet, Evaluation, SetBuilder};

use model::{equal, linear, one_equal, one_linear, one_rod, point, rod};

const ROUNDS: usize = 5;
const EVALUATIONS: usize = 20;

/// A function that adds so many constraints on so many nodes.
type AddAll = fn(&mut SetBuilder, usize, usize);

/// Names, and how to add constraints one by one or in bulk.
const KINDS: [(&str, model::Add, AddAll); 3] = [
    ("rods", rod, |builder, count, nodes| {
        builder.add_all("rod", count, |i| one_rod(i / 2, nodes)).expect("valid");
    }),
    ("linear equations", linear, |builder, count, nodes| {
        builder.add_all("equation", count, |i| one_linear(i / 2, nodes)).expect("valid");
    }),
    ("equal DOFs", equal, |builder, count, nodes| {
        builder.add_all("tie", count, |i| one_equal(i / 2, nodes)).expect("valid");
    }),
];

fn main() {
    let short = std::env::args().any(|argument| argument == "--test");
    let constraints = if short { 10_000 } else { 1_000_000 };
    println!("load before: {}", load());
    let wanted = std::env::args().skip(1).find(|argument| !argument.starts_with('-'));
    for (name, one, all) in KINDS.iter().filter(|kind| wanted.as_ref().is_none_or(|wanted| kind.0.contains(wanted))) {
        set_up(&format!("{name}, at once"), constraints, *all);
        set_up(&format!("{name}, one by one"), constraints, |builder, count, nodes| {
            (0..count).for_each(|i| one(builder, i / 2, nodes));
        });
    }
    if wanted.is_none() {
        changes(constraints);
    }
    println!("load after: {}", load());
}

fn load() -> String {
    std::fs::read_to_string("/proc/loadavg").unwrap_or_else(|_| "not known".into()).trim().into()
}

/// CPU time of this program in milliseconds, in steps of 10; other programs do not count.
fn busy() -> f64 {
    let text = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let fields: Vec<&str> = text.rsplit(')').next().unwrap_or_default().split_whitespace().collect();
    let ticks = |k: usize| fields.get(k).and_then(|ticks| ticks.parse::<f64>().ok()).unwrap_or(0.0);
    10.0 * (ticks(11) + ticks(12))
}

fn filled(constraints: usize, add: impl Fn(&mut SetBuilder, usize, usize)) -> SetBuilder {
    let nodes = constraints / 2 + 200;
    let mut builder = ConstraintSet::builder(6 * nodes);
    add(&mut builder, constraints, nodes);
    builder
}

fn set_up(name: &str, constraints: usize, add: impl Fn(&mut SetBuilder, usize, usize)) {
    let [mut adding, mut allocating, mut planning, mut evaluating] = [const { Vec::new() }; 4];
    let (mut work, mut evaluations) = ([0.0; 3], 0.0);
    for _ in 0..ROUNDS {
        let mut until = vec![busy()];
        let (time, set) = timed(|| filled(constraints, &add).build().expect("few DOFs"));
        adding.push(time);
        until.push(busy());
        let (time, mut evaluation) = timed(|| set.allocate());
        allocating.push(time);
        until.push(busy());
        let (u, w) = (vec![1e-3; set.dofs()], vec![1.0; set.equations()]);
        let mut once = || timed(|| set.assemble(&u, &w, &mut evaluation).expect("of this set")).0;
        let before = busy();
        planning.push(once());
        let spent = [until[1] - until[0], until[2] - until[1], busy() - before];
        work.iter_mut().zip(spent).for_each(|(work, spent)| *work += spent / ROUNDS as f64);
        let start = busy();
        evaluating.push(median(std::iter::repeat_with(once).take(EVALUATIONS).collect()));
        evaluations += busy() - start;
    }
    let all = [adding, allocating, planning, evaluating].map(median);
    report(name, all);
    report("processor time", [work[0], work[1], work[2], evaluations / (ROUNDS * EVALUATIONS) as f64]);
}

/// Prints a row; the first evaluation includes the plan of H.
fn report(name: &str, [adding, allocating, first, evaluation]: [f64; 4]) {
    let (of_values, planning) = (adding + allocating, (first - evaluation).max(0.0));
    print!(
        "{name:>28}: adding {adding:.1} ms, c and G {allocating:.1} ms, H {planning:.1} ms; one evaluation {evaluation:.1} ms; "
    );
    let (of_values, all) = (of_values / evaluation, (of_values + planning) / evaluation);
    println!("set-up for c and G {of_values:.1} times that, for H too {all:.1}");
}

/// Milliseconds of one evaluation.
fn evaluate(set: &ConstraintSet, evaluation: &mut Evaluation) -> f64 {
    let (u, w) = (vec![1e-3; set.dofs()], vec![1.0; set.equations()]);
    timed(|| set.assemble(&u, &w, evaluation).expect("of this set")).0
}

/// Changes of single constraints in a set of rods and equal DOFs.
fn changes(constraints: usize) {
    let nodes = constraints / 2 + 200;
    let mut builder = ConstraintSet::builder(6 * nodes);
    let rod =
        |i: usize, length: f64| Distance { length: Some(length), ..Distance::new(point(i), point((i + 1) % nodes)) };
    let rods: Vec<_> = (0..constraints / 2).map(|i| builder.add("", rod(i, 1.0)).expect("valid")).collect();
    let ties: Vec<_> =
        (0..constraints / 2).map(|i| builder.add("", Equal::new([3 * i, 3 * i + 4])).expect("valid")).collect();
    let mut set = builder.build().expect("few DOFs");
    let mut evaluation = set.allocate();
    let still = median((0..21).map(|_| evaluate(&set, &mut evaluation)).collect());
    println!("{constraints} rods and equal DOFs, one evaluation: {still:.2} ms");
    let names = ["rod rests and returns", "tie rests and returns", "other length of a rod", "other right-hand side"];
    for (kind, name) in names.into_iter().enumerate() {
        let (mut change, mut after) = (Vec::new(), Vec::new());
        for k in 0..42 {
            let place = (k / 2 * 7919 + 13) % rods.len();
            let (rests, id) = (k % 2 == 0, if kind == 1 { ties[place] } else { rods[place] });
            change.push(
                timed(|| match (kind, rests) {
                    (0 | 1, true) => set.deactivate(id).expect("there"),
                    (0 | 1, false) => set.activate(id).expect("there"),
                    (2, _) => set.replace(id, rod(place, 2.0)).expect("there"),
                    _ => set.set_rhs(ties[place], &[0.5]).expect("there"),
                })
                .0,
            );
            after.push(evaluate(&set, &mut evaluation));
        }
        println!("{name:>24}: {:.1} us, evaluation after it {:.2} ms", 1e3 * median(change), median(after));
    }
}

/// The result and its time in milliseconds.
fn timed<T>(work: impl FnOnce() -> T) -> (f64, T) {
    let start = Instant::now();
    let result = work();
    (1e3 * start.elapsed().as_secs_f64(), result)
}

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

//! Set-up and changes of a set, in units of one evaluation, `cargo bench -p qless-constraints --bench setup` (`-- --test` small).
//!
//! Set-up: all constraints are added, the patterns made, the arrays allocated. Wanted: at most 10 times one evaluation of c, G and H.
//! A change: one constraint deactivated and activated again, given other parameters, or another right-hand side; and what the next
//! evaluation takes longer than one without a change.
//!
//! Constraints are added one by one, and at once by all threads; who adds a million writes the latter. By both clocks a million rods then
//! take 10 to 11 evaluations: 3 to be added, 5 for the plan of H, 2 for the arrays; one by one 14.

mod model;

use std::time::Instant;

use qless_constraints::types::{Distance, Equal};
use qless_constraints::{ConstraintSet, Quantities, SetBuilder};

use model::{equal, linear, one_equal, one_linear, one_rod, point, rod};

const ROUNDS: usize = 5;
const EVALUATIONS: usize = 20;

/// Adds so many constraints on so many nodes.
type AddAll = fn(&mut SetBuilder, usize, usize);

/// What is added, one by one, or all at once.
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
    for (name, one, all) in KINDS {
        set_up(&format!("{name}, at once"), constraints, all);
        set_up(&format!("{name}, one by one"), constraints, |builder, count, nodes| {
            (0..count).for_each(|i| one(builder, i / 2, nodes));
        });
    }
    changes(constraints);
    println!("load after: {}", load());
}

fn load() -> String {
    std::fs::read_to_string("/proc/loadavg").unwrap_or_else(|_| "not known".into()).trim().into()
}

/// Milliseconds that processors worked for this program: other programs do not enter. In steps of 10.
fn busy() -> f64 {
    let text = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let fields: Vec<&str> = text.rsplit(')').next().unwrap_or_default().split_whitespace().collect();
    let ticks = |k: usize| fields.get(k).and_then(|ticks| ticks.parse::<f64>().ok()).unwrap_or(0.0);
    10.0 * (ticks(11) + ticks(12))
}

fn filled(constraints: usize, add: impl Fn(&mut SetBuilder, usize, usize)) -> SetBuilder {
    let nodes = constraints / 2 + 200;
    let mut builder = ConstraintSet::builder(3 * nodes);
    add(&mut builder, constraints, nodes);
    builder
}

fn set_up(name: &str, constraints: usize, add: impl Fn(&mut SetBuilder, usize, usize)) {
    let [mut adding, mut building, mut allocating, mut evaluating] = [const { Vec::new() }; 4];
    let (mut work, mut evaluations) = ([0.0; 3], 0.0);
    for _ in 0..ROUNDS {
        let mut until = vec![busy()];
        let (time, builder) = timed(|| filled(constraints, &add));
        adding.push(time);
        until.push(busy());
        let (time, set) = timed(|| builder.build().expect("few DOFs"));
        building.push(time);
        until.push(busy());
        let (time, mut quantities) = timed(|| set.allocate());
        allocating.push(time);
        until.push(busy());
        work.iter_mut().zip(until.windows(2)).for_each(|(work, at)| *work += (at[1] - at[0]) / ROUNDS as f64);
        let (u, w) = (vec![1e-3; set.dofs()], vec![1.0; set.equations()]);
        let start = busy();
        let once = || timed(|| set.assemble(&u, &w, &mut quantities).expect("of this set")).0;
        let once = std::iter::repeat_with(once).take(EVALUATIONS).collect();
        evaluations += busy() - start;
        evaluating.push(median(once));
    }
    let [adding, building, allocating, evaluating] = [adding, building, allocating, evaluating].map(median);
    let ratio = (adding + building + allocating) / evaluating;
    print!("{name:>28}: adding {adding:.1} ms, patterns {building:.1} ms, arrays {allocating:.1} ms; ");
    println!("one evaluation {evaluating:.1} ms; set-up {ratio:.1} times that");
    let ([adding, building, allocating], evaluation) = (work, evaluations / (ROUNDS * EVALUATIONS) as f64);
    let ratio = (adding + building + allocating) / evaluation;
    print!("{:>28}  processor time: {adding:.1} ms, {building:.1} ms, {allocating:.1} ms; ", "");
    println!("{evaluation:.1} ms; {ratio:.1} times");
}

/// Milliseconds of one evaluation.
fn evaluate(set: &ConstraintSet, quantities: &mut Quantities) -> f64 {
    let (u, w) = (vec![1e-3; set.dofs()], vec![1.0; set.equations()]);
    timed(|| set.assemble(&u, &w, quantities).expect("of this set")).0
}

/// Changes of single constraints in a set of rods and equal DOFs.
fn changes(constraints: usize) {
    let nodes = constraints / 2 + 200;
    let mut builder = ConstraintSet::builder(3 * nodes);
    let rod =
        |i: usize, length: f64| Distance { length: Some(length), ..Distance::new(point(i), point((i + 1) % nodes)) };
    let rods: Vec<_> = (0..constraints / 2).map(|i| builder.add("", rod(i, 1.0)).expect("valid")).collect();
    let ties: Vec<_> =
        (0..constraints / 2).map(|i| builder.add("", Equal::new([3 * i, 3 * i + 4])).expect("valid")).collect();
    let mut set = builder.build().expect("few DOFs");
    let mut quantities = set.allocate();
    let still = median((0..21).map(|_| evaluate(&set, &mut quantities)).collect());
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
            after.push(evaluate(&set, &mut quantities));
        }
        println!("{name:>24}: {:.1} us, evaluation after it {:.2} ms", 1e3 * median(change), median(after));
    }
}

/// Milliseconds.
fn timed<T>(work: impl FnOnce() -> T) -> (f64, T) {
    let start = Instant::now();
    let result = work();
    (1e3 * start.elapsed().as_secs_f64(), result)
}

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

//! Killed runs leave the old or the new output, complete; signals that can be caught leave no temporary files.
//!
//! `QLESS_KILLS` sets the number of kills for each command; the default is small. A seed determines their times.

mod folder;

use std::os::unix::process::ExitStatusExt;
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

use rustix::process::{Pid, Signal, kill_process};

use super::harness::{Place, lines};
use folder::{content, hidden, numbers};

const SIGNALS: [Signal; 3] = [Signal::KILL, Signal::TERM, Signal::INT];

/// A command with two inputs, `old` and `new`, whose results differ, and the name of its output.
struct Case {
    name: &'static str,
    old: &'static str,
    new: &'static str,
    output: &'static str,
}

const CASES: [Case; 5] = [
    Case { name: "reduce", old: "reduce a -o out -q", new: "reduce b -o out -q", output: "out" },
    Case { name: "generate", old: "generate path -o gen -q", new: "generate cycle --gap 1 -o gen -q", output: "gen" },
    Case { name: "clean", old: "clean a.inp -o sets/c.inp -q", new: "clean b.inp -o sets/c.inp -q", output: "sets" },
    Case { name: "check", old: "check a -q -o sets/c.txt", new: "check b -q -o sets/c.txt", output: "sets" },
    Case {
        name: "bench",
        old: "bench --short -q --runs 1 --family ring --method default -o trade",
        new: "bench --short -q --runs 1 --family grid --method default -o trade",
        output: "trade",
    },
];

#[test]
fn what_is_killed_leaves_the_old_or_the_new_output() {
    let count = std::env::var("QLESS_KILLS").map_or(12, |count| count.parse().expect("a number"));
    for case in &CASES {
        let place = Place::new();
        prepare(&place, case);
        let seen = (0..count).map(|k| kill(&place, case, k)).fold([0; 3], |mut seen, ended| {
            seen[ended] += 1;
            seen
        });
        println!(
            "{}: {} kills found the old output, {} the new one; {} came too late",
            case.name, seen[0], seen[1], seen[2]
        );
    }
}

/// A folder with models, and an output folder with files and folders of the user.
fn prepare(place: &Place, case: &Case) {
    for (name, seed) in [("a", 1), ("b", 2)] {
        let run = place.run(&format!("generate planted --rows 60 --dofs 90 --combos 6 --seed {seed} -o {name} -q"));
        assert_eq!(run.code, 0, "{}", run.err);
        let nodes = lines((1..9).map(|k| format!("{k},{k}.,0.,0.\n")));
        let tie = format!("*EQUATION\n2\n1,{seed},1.,2,{seed},-1.\n");
        place.file(&format!("{name}.inp"), format!("*NODE\n{nodes}{tie}{tie}"));
    }
    place.file(&format!("{}/notes", case.output), "mine").file(&format!("{}/deep/notes", case.output), "mine too");
}

/// Kills one run. Returns whether the output is the old or the new one, or whether the run had ended.
fn kill(place: &Place, case: &Case, k: usize) -> usize {
    let signal = SIGNALS[k / 4 % 3];
    let number = signal.as_raw();
    let start_of_old = Instant::now();
    let run = place.run(case.old);
    let took = start_of_old.elapsed();
    assert!(run.code < 2, "{}", run.err);
    let folder = place.path(case.output);
    let (old, old_numbers) = (content(&folder), numbers(&folder));
    // The temporary files that earlier kills left; a run removes them after a minute.
    let before = [hidden(&place.path("")), hidden(&folder)];
    let is_more_above = || !hidden(&place.path("")).is_subset(&before[0]);
    let is_more = || is_more_above() || !hidden(&folder).is_subset(&before[1]);
    let is_one = case.output == "sets";
    let mut child = start(place, case.new);
    wait(k, took, || if is_one { is_more() } else { is_more_above() }, is_more);
    let sent = kill_process(Pid::from_child(&child), signal);
    assert!(sent.is_ok(), "a child that was not waited for can be sent signals");
    let status = child.wait().expect("it ends");
    let found = content(&folder);
    let what = format!("{} with {signal:?} at kill {k} ({status})", case.name);
    assert!(status.signal() == Some(number) || status.code().is_some_and(|code| code < 2), "{what}");
    assert!(signal == Signal::KILL || !is_more(), "{what}: temporary folders are left");
    if numbers(&folder) == old_numbers {
        assert!(found == old, "{what}: the old files have changed");
        return if status.signal().is_some() { 0 } else { 2 };
    }
    // What the new output is, another run says; times are its own, but every file is another one than before.
    for path in ["notes", "deep/notes"] {
        assert_eq!(found.get(path), old.get(path), "{what}");
    }
    let numbers = numbers(&folder);
    let kept: Vec<_> = numbers.iter().filter(|(name, number)| old_numbers.get(*name) == Some(number)).collect();
    assert!(kept.iter().all(|(name, _)| *name == "notes"), "{what}: of the old output are {kept:?}");
    assert!(place.run(case.new).code < 2);
    let new = content(&folder);
    assert!(new.keys().eq(found.keys()), "{what}: {:?} instead of {:?}", found.keys(), new.keys());
    if !matches!(case.name, "bench" | "check") {
        assert!(new == found, "{what}: the new output differs");
    }
    if status.signal().is_some() { 1 } else { 2 }
}

/// Commits are short and come late: every other kill waits for temporary folders, half of them for those of a switch, which are in
/// the folder above. The others come at any time.
fn wait(k: usize, took: Duration, is_switch: impl Fn() -> bool, is_stage: impl Fn() -> bool) {
    let (of, is_due): (Duration, &dyn Fn() -> bool) = match k % 4 {
        0 => (Duration::from_micros(500), &is_switch),
        2 => (took / 5, &is_stage),
        _ => (took * 4 / 5, &|| true),
    };
    let start = Instant::now();
    while !is_due() && start.elapsed() < 2 * took {}
    std::thread::sleep(of.mul_f64(random(k) as f64 / 1e6));
}

fn start(place: &Place, arguments: &str) -> Child {
    place.command(arguments).stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("the program starts")
}

/// Below a million, the same for the same `k`.
fn random(k: usize) -> u64 {
    let mut x = (k as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    (x ^ (x >> 31)) % 1_000_000
}

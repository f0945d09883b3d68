//! Killed runs leave the old or the new file, and the old or the new set of files or one whose manifest says that it is incomplete; the
//! next run needs no help. Signals that can be caught leave no temporary files. Runs into one folder at once leave the set of one of
//! them. No file of the user is touched.
//!
//! `QLESS_KILLS` sets the number of points at which each command is killed or delayed, spread over all points; the default is small, and a
//! large number means all.

mod folder;
mod points;

use std::fs;
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Child, Stdio};

use qless_io::Manifest;

use super::harness::{Place, lines};
use folder::{content, hidden, numbers};
use points::{Point, points};

/// Names and numbers of signals.
const SIGNALS: [(&str, i32); 3] = [("KILL", 9), ("TERM", 15), ("INT", 2)];

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
        old: "bench --short -q --runs 1 --family ring --method checked -o trade",
        new: "bench --short -q --runs 1 --family grid --method checked -o trade",
        output: "trade",
    },
];

#[test]
fn what_is_killed_leaves_the_old_or_the_new_output_or_says_so() {
    for case in &CASES {
        let place = Place::new();
        prepare(&place, case);
        assert!(place.run(case.old).code < 2);
        let mut seen = [0; 4];
        for (k, point) in spread(points(&place, case.new)).iter().enumerate() {
            for (name, signal) in [SIGNALS[0], SIGNALS[1 + k % 2]] {
                seen[kill(&place, case, point, name, signal) as usize] += 1;
            }
        }
        let [old, new, incomplete, late] = seen;
        println!(
            "{}: {old} kills found the old output, {new} the new one, {incomplete} an incomplete set; {late} came too late",
            case.name
        );
        assert!(old > 0 && late < old + new + incomplete, "{}: kills come during the run", case.name);
    }
}

/// Both models have their own files; the folder ends with all files of one of them, and with all of the user's. One run of each group is
/// delayed at one point by longer than the others take.
#[test]
fn runs_into_one_folder_at_once_leave_the_set_of_one_of_them() {
    let place = Place::new();
    let case = &CASES[0];
    prepare(&place, case);
    let folder = place.path(case.output);
    let sets = [case.old, case.new].map(|command| {
        assert_eq!(place.run(command).code, 0);
        set(&folder)
    });
    let user =
        || (content(&folder.join("deep")), fs::read(folder.join("notes")).expect("there"), numbers(&folder)["notes"]);
    let before = user();
    for (k, point) in spread(points(&place, case.new)).iter().enumerate() {
        let runs = [2, 4, 8][k % 3];
        let delayed = point.start(&place, case.new, "delay_enter=100000");
        let others = (1..runs).map(|k| start(&place, [case.old, case.new][k % 2]));
        for mut child in [delayed].into_iter().chain(others) {
            assert!(child.wait().expect("it ends").success(), "{runs} at once, {point:?}");
        }
        assert!(sets.contains(&set(&folder)), "{runs} at once, {point:?}");
        assert_eq!(user(), before);
        assert!(hidden(&folder).is_empty());
    }
}

/// As many of the points as `QLESS_KILLS` says.
fn spread(points: Vec<Point>) -> Vec<Point> {
    let count: usize = std::env::var("QLESS_KILLS").map_or(6, |count| count.parse().expect("a number"));
    let step = points.len().div_ceil(count);
    // The end of the run is where most happens.
    points.into_iter().rev().step_by(step).collect()
}

/// The files of the set in a folder, whose manifest is right.
fn set(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let manifest = Manifest::check(folder).expect("a whole set");
    manifest
        .files
        .into_iter()
        .map(|file| (file.name.clone(), fs::read(folder.join(file.name)).expect("there")))
        .collect()
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

/// What a kill found.
#[derive(Clone, Copy)]
enum Found {
    Old,
    New,
    Incomplete,
    /// The run had ended.
    Late,
}

/// Kills one run, and runs it again.
fn kill(place: &Place, case: &Case, point: &Point, name: &str, signal: i32) -> Found {
    let run = place.run(case.old);
    assert!(run.code < 2, "{}", run.err);
    let folder = place.path(case.output);
    let (old, old_numbers) = (content(&folder), numbers(&folder));
    assert!(hidden(&folder).is_empty(), "a run removes what a killed one left");
    let is_one = case.output == "sets";
    let mut child = point.start(place, case.new, &format!("signal={name}"));
    let status = child.wait().expect("it ends");
    let found = content(&folder);
    let what = format!("{} with {name} at {point:?} ({status})", case.name);
    assert!(status.signal() == Some(signal) || status.code().is_some_and(|code| code < 2), "{what}");
    let is_whole = is_one || !is_incomplete(&folder);
    assert!(name == "KILL" || hidden(&folder).is_empty() && is_whole, "{what}: it was not ended in order");
    for path in ["notes", "deep/notes"] {
        assert_eq!(found.get(path), old.get(path), "{what}");
    }
    assert_eq!(numbers(&folder)["notes"], old_numbers["notes"], "{what}");
    if is_whole && !is_one {
        Manifest::check(&folder).unwrap_or_else(|error| panic!("{what}: {error}"));
    }
    let is_old = numbers(&folder) == old_numbers;
    assert!(!is_old || found == old, "{what}: the old files have changed");
    // What the new output is, another run says; times are its own.
    assert!(place.run(case.new).code < 2);
    let new = content(&folder);
    assert!(hidden(&folder).is_empty(), "{what}: temporary files are left");
    if is_whole && !is_old && !matches!(case.name, "bench" | "check") {
        assert!(new == found, "{what}: the new output differs");
    }
    match status.signal() {
        _ if !is_whole => Found::Incomplete,
        None => Found::Late,
        Some(_) if is_old => Found::Old,
        Some(_) => Found::New,
    }
}

/// Whether the manifest of a folder says that its set is incomplete.
fn is_incomplete(folder: &Path) -> bool {
    Manifest::read(folder).expect("a manifest").is_some_and(|manifest| !manifest.complete)
}

fn start(place: &Place, arguments: &str) -> Child {
    place.command(arguments).stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("the program starts")
}

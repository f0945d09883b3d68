//! Programs that are killed: the output is the old one or the new one, whole, and signals that can be caught leave nothing behind.
//!
//! `QLESS_KILLS` says how often, for each command; by default few times. Times of the kills follow a seed.

use std::collections::BTreeMap;
use std::fs;
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use super::harness::Place;

const SIGNALS: [(&str, i32); 3] = [("KILL", 9), ("TERM", 15), ("INT", 2)];

/// Each file of a folder that is no temporary one.
type Content = BTreeMap<String, Vec<u8>>;

/// A command with two results: that of `old` and that of `new`, in what `output` names.
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

/// Models, and an output folder with files and folders of the user.
fn prepare(place: &Place, case: &Case) {
    for (name, seed) in [("a", 1), ("b", 2)] {
        let run = place.run(&format!("generate planted --rows 60 --dofs 90 --combos 6 --seed {seed} -o {name} -q"));
        assert_eq!(run.code, 0, "{}", run.err);
        let nodes: String = (1..9).map(|k| format!("{k},{k}.,0.,0.\n")).collect();
        let tie = format!("*EQUATION\n2\n1,{seed},1.,2,{seed},-1.\n");
        place.file(&format!("{name}.inp"), format!("*NODE\n{nodes}{tie}{tie}"));
    }
    place.file(&format!("{}/notes", case.output), "mine").file(&format!("{}/deep/notes", case.output), "mine too");
}

/// Kills one run; whether the old output is found, the new one, or the run was over.
fn kill(place: &Place, case: &Case, k: usize) -> usize {
    let (signal, number) = SIGNALS[k % 3];
    let run = place.run(case.old);
    assert!(run.code < 2, "{}", run.err);
    let folder = place.path(case.output);
    let old = content(&folder);
    let mut child = start(place, case.new);
    let start = Instant::now();
    // Commits are short and come late: half of the kills wait until new files do.
    let stage =
        || fs::read_dir(&folder).into_iter().flatten().flatten().any(|e| is_hidden(&e.file_name().to_string_lossy()));
    if k % 2 == 0 {
        while !stage() && child.try_wait().expect("known").is_none() {}
        std::thread::sleep(Duration::from_micros(random(k) % 3000));
    } else {
        let whole = Duration::from_millis(if case.name == "bench" { 300 } else { 15 });
        std::thread::sleep(whole.mul_f64(random(k) as f64 / 1e6).saturating_sub(start.elapsed()));
    }
    let sent = Command::new("kill").args([format!("-{signal}"), child.id().to_string()]).status().expect("kill runs");
    assert!(sent.success(), "a child that was not waited for can be sent signals");
    let status = child.wait().expect("it ends");
    let found = content(&folder);
    let what = format!("{} with {} at kill {k} ({status})", case.name, signal);
    assert!(status.signal() == Some(number) || status.code().is_some_and(|code| code < 2), "{what}");
    let hidden = hidden(place.path("").as_path()) + hidden(&folder);
    assert!(number == 9 || hidden == 0, "{what}: temporary folders are left");
    clear(place.path("").as_path());
    clear(&folder);
    if found == old {
        return if status.signal().is_some() { 0 } else { 2 };
    }
    // What the new output is, another run says; times that a bench took are its own.
    for path in ["notes", "deep/notes"] {
        assert_eq!(found.get(path), old.get(path), "{what}");
    }
    if case.name == "bench" {
        let families = |text: &str| ["ring,", "grid,"].map(|family| text.contains(family));
        let csv = String::from_utf8_lossy(&found["trade.csv"]);
        assert!(families(&csv) == [false, true] && found["trade.md"] != old["trade.md"], "{what}: a mixture");
        for name in ["trade.svg", "growth.svg", "trade.md", "trade.csv"] {
            assert!(found[name] != old[name] && !found[name].is_empty(), "{what}: {name} is not new");
        }
    } else {
        assert!(place.run(case.new).code < 2);
        let new = content(&folder);
        let differ: Vec<_> =
            new.iter().filter(|(name, text)| found.get(*name) != Some(text)).map(|(name, _)| name).collect();
        assert!(
            found.len() == new.len() && (differ.is_empty() || case.name == "check"),
            "{what}: {differ:?} are not new"
        );
    }
    if status.signal().is_some() { 1 } else { 2 }
}

fn start(place: &Place, arguments: &str) -> std::process::Child {
    place.command(arguments).stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("the program starts")
}

/// Below a million, the same for the same `k`.
fn random(k: usize) -> u64 {
    let mut x = (k as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    (x ^ (x >> 31)) % 1_000_000
}

fn is_hidden(name: &str) -> bool {
    name.starts_with(".qless-")
}

fn content(folder: &Path) -> Content {
    let mut all = Content::new();
    collect(folder, "", &mut all);
    all
}

fn collect(folder: &Path, prefix: &str, all: &mut Content) {
    for entry in fs::read_dir(folder).expect("a folder").flatten() {
        let (path, name) = (entry.path(), entry.file_name().to_string_lossy().into_owned());
        if is_hidden(&name) {
            continue;
        } else if path.is_dir() {
            collect(&path, &format!("{prefix}{name}/"), all);
        } else {
            all.insert(format!("{prefix}{name}"), fs::read(path).expect("readable"));
        }
    }
}

fn hidden(folder: &Path) -> usize {
    fs::read_dir(folder).expect("a folder").flatten().filter(|e| is_hidden(&e.file_name().to_string_lossy())).count()
}

/// Removes temporary folders, but for one that links of the output lead to.
fn clear(folder: &Path) {
    for entry in fs::read_dir(folder).expect("a folder").flatten() {
        if is_hidden(&entry.file_name().to_string_lossy()) && !entry.path().join("README").exists() {
            fs::remove_dir_all(entry.path()).expect("removed");
        }
    }
}

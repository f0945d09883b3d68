//! Little memory, by `--memory` and `ulimit -v`. A run succeeds, or ends with exit code 3 and states the memory needed and allowed; nothing
//! stays behind.

#![cfg(target_os = "linux")]

use std::process::{Command, Stdio};
use std::time::Duration;

use super::harness::{Place, Run};

/// Scenes that need presolve only, dense blocks, sparse factors, or a lot of each.
const SCENES: [&str; 6] = [
    "path --nodes 200000",
    "spider --legs 50000",
    "planted --rows 500 --dofs 700 --combos 50",
    "windows --nx 30 --ny 30",
    "fssi --equations 4000 --coupling mortar",
    "grid --nx 60 --ny 60",
];

#[cfg(not(feature = "spqr"))]
const BACKENDS: [&str; 3] = ["faer", "sparse", "gauss"];
#[cfg(feature = "spqr")]
const BACKENDS: [&str; 4] = ["faer", "sparse", "gauss", "spqr"];

/// A temporary folder with the scene in `scene`.
fn scene(name: &str) -> Place {
    let place = Place::new();
    assert_eq!(place.run(&format!("generate {name} -o scene -q")).code, 0, "{name}");
    place
}

/// Each scene, generated once for all backends.
fn scenes() -> Vec<(&'static str, Place)> {
    SCENES.iter().map(|name| (*name, scene(name))).collect()
}

/// `qless reduce scene -o out` with more arguments, within so many KiB of address space.
fn within(place: &Place, kib: usize, arguments: &str) -> Run {
    ended(limited(place, kib, arguments))
}

fn limited(place: &Place, kib: usize, arguments: &str) -> std::process::Output {
    let program = place.command(&format!("reduce scene -o out -q --form auto {arguments}"));
    let mut shell = Command::new("sh");
    shell
        .args(["-c", &format!("ulimit -v {kib}; exec \"$0\" \"$@\"")])
        .arg(program.get_program())
        .args(program.get_args());
    shell.current_dir(place.path("")).stdin(Stdio::null());
    shell.output().expect("the shell starts")
}

fn ended(output: std::process::Output) -> Run {
    let text = |bytes| String::from_utf8(bytes).expect("UTF-8");
    let code = output.status.code().unwrap_or_else(|| panic!("{}: {:?}", output.status, output.stderr));
    Run { code, out: text(output.stdout), err: text(output.stderr) }
}

/// Checks that the run succeeded, or failed with both numbers and left no files. Returns whether it succeeded.
fn is_done(place: &Place, run: &Run, what: &str) -> bool {
    let done = place.path("out").is_dir();
    assert_eq!(run.code, if done { 0 } else { 3 }, "{what}: {}", run.err);
    let names: Vec<String> = std::fs::read_dir(place.path(""))
        .expect("a folder")
        .map(|entry| entry.expect("an entry").file_name().into_string().expect("UTF-8"))
        .collect();
    assert_eq!(names.len(), if done { 2 } else { 1 }, "{what}: {names:?}");
    if !done {
        let sizes = run.err.matches(" MiB").count();
        let allowed = ["allow", "gave no more"].iter().any(|word| run.err.contains(word));
        assert!(run.err.contains("error: ") && sizes >= 2 && allowed, "{what}: {}", run.err);
    }
    if done {
        std::fs::remove_dir_all(place.path("out")).expect("removed");
    }
    done
}

/// Limits from the smallest to enough for all. Below about 70 MB the system cannot load a program with OpenBLAS.
const STEPS: &[usize] =
    if cfg!(feature = "spqr") { &[80, 90, 120, 160, 220, 8000] } else { &[60, 75, 90, 120, 160, 220, 8000] };

/// A few steps for each scene and backend.
#[test]
fn within_any_address_space_a_run_is_done_or_says_what_it_needs() {
    for ((name, place), backend) in scenes().iter().flat_map(|one| BACKENDS.iter().map(move |backend| (one, backend))) {
        let mut counts = [0, 0];
        for &mib in STEPS {
            let what = format!("{name}, {backend}, {mib} MiB");
            let run = within(place, mib << 10, &format!("--backend {backend}"));
            counts[usize::from(is_done(place, &run, &what))] += 1;
        }
        assert!(counts[1] > 0, "{name}, {backend}: never enough");
    }
}

/// Between a thread's stack and what it takes beside it, there is no limit that aborts the process: all limits of one stack, in steps that
/// are smaller than what a thread takes.
#[test]
fn every_thread_has_all_that_it_needs_to_begin() {
    let place = scene("equations");
    let arguments = format!("--backend {}", BACKENDS[BACKENDS.len() - 1]);
    let is_started = |mib: &usize| {
        let code = limited(&place, mib << 10, &arguments).status.code();
        matches!(code, Some(0 | 3))
    };
    let first = (40..200).find(is_started).expect("it starts in 200 MiB") + 1;
    for kib in (first << 10..(first + 5) << 10).step_by(8) {
        let run = ended(limited(&place, kib, &arguments));
        let _ = std::fs::remove_dir_all(place.path("out"));
        assert!(run.code == 0 || run.code == 3, "{kib} KiB: {}", run.err);
    }
}

/// The peak of the resident memory of a run in KiB, as last read before its end, and the result of the run.
fn measured(place: &Place, arguments: &str) -> (u64, Run) {
    let mut command = place.command(&format!("reduce scene -o out -q --form auto {arguments}"));
    // A backtrace would load symbols.
    command.env("RUST_BACKTRACE", "0");
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().expect("it starts");
    let status = format!("/proc/{}/status", child.id());
    let mut most = 0;
    while child.try_wait().expect("a child").is_none() {
        let text = std::fs::read_to_string(&status).unwrap_or_default();
        let seen = text.lines().find_map(|line| line.strip_prefix("VmHWM:")?.trim().strip_suffix(" kB")?.parse().ok());
        most = most.max(seen.unwrap_or(0));
        std::thread::sleep(Duration::from_micros(500));
    }
    (most, ended(child.wait_with_output().expect("it ended")))
}

/// Pages of C libraries (code, and allocations within a call) are counted only afterwards: up to 4.9 MiB were seen.
const UNSEEN: u64 = if cfg!(feature = "spqr") { 6 << 10 } else { 0 };

/// Limits from too small for the program to sufficient. A run that starts exceeds its limit by at most a tenth.
#[test]
fn a_run_stays_within_its_memory_or_says_what_it_needs() {
    for ((name, place), backend) in scenes().iter().flat_map(|one| BACKENDS.iter().map(move |backend| (one, backend))) {
        let mut counts = [0, 0];
        for mib in [8, 16, 24, 40, 70, 4000] {
            let what = format!("{name}, {backend}, {mib} MiB");
            let (kib, run) = measured(place, &format!("--backend {backend} --memory {mib}MiB"));
            counts[usize::from(is_done(place, &run, &what))] += 1;
            let refused_at_the_start = run.err.contains("the smallest run");
            assert!(refused_at_the_start || kib <= (mib << 10) * 11 / 10 + UNSEEN, "{what}: {kib} KiB: {}", run.err);
        }
        assert!(counts.iter().all(|&count| count > 0), "{name}, {backend}: {counts:?}");
    }
}

/// The peak of a run is sufficient as its limit.
#[test]
fn a_run_is_done_with_a_tenth_more_than_it_takes() {
    // Dense products reserve much more than they touch.
    for name in ["path --nodes 200000", "spider --legs 100000", "windows --nx 60 --ny 60"] {
        let place = scene(name);
        let (kib, run) = measured(&place, "");
        assert!(is_done(&place, &run, name));
        let (_, run) = measured(&place, &format!("--memory {}KiB", kib * 11 / 10));
        assert!(is_done(&place, &run, name), "{name}: {kib} KiB: {}", run.err);
    }
}

#[test]
fn a_limit_below_the_program_itself_is_refused_before_it_starts() {
    let place = scene("equations");
    for memory in ["1", "2MiB", "4096KiB"] {
        // The input does not exist, so a run that starts would report that.
        let run = place.run(&format!("check nowhere --memory {memory}"));
        assert!(run.code == 3 && run.err.contains("the smallest run needs"), "{}", run.err);
        assert!(run.err.contains("--memory allows"), "{}", run.err);
    }
    for memory in ["0", "-1", "1.5GiB", "8MB", "much"] {
        let run = place.run(&format!("check scene --memory={memory}"));
        assert!(run.code == 2 && run.err.contains("512MiB"), "{}", run.err);
    }
}

/// A run works with fewer threads if some cannot be started.
#[test]
fn more_threads_than_there_is_address_space_for_are_fewer_threads() {
    let place = scene("path --nodes 1000");
    let run = within(&place, 120 << 10, "--threads 64");
    assert!(is_done(&place, &run, "64 threads"), "{}", run.err);
}

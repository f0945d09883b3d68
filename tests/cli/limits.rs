//! Endless input, too many threads, names that select nothing.

use std::os::unix::fs::symlink;
use std::time::{Duration, Instant};

use super::harness::{HEADER, Place};

/// The error comes after a megabyte, with both numbers.
#[cfg(target_os = "linux")]
#[test]
fn what_never_ends_is_not_read_to_its_end() {
    let place = Place::new();
    place.paper("case", 1.0).file("lone.mtx", format!("{HEADER}1 1 1\n1 1 1\n"));
    place.file("a.inp", "*INCLUDE,INPUT=/dev/zero\n").file("a.bdf", "BEGIN BULK\nINCLUDE '/dev/zero'\n");
    for name in ["zero.mtx", "zero.inp", "zero.bdf", "zero.cdb", "case/rows.txt"] {
        symlink("/dev/zero", place.path(name)).expect("linked");
    }
    for arguments in [
        "check a.inp",
        "check a.bdf",
        "clean a.inp -o b.inp",
        "check zero.mtx",
        "check zero.inp",
        "check zero.bdf",
        "check zero.cdb",
        "check case",
        "check lone.mtx --rhs /dev/zero",
        "reduce lone.mtx --prescribed /dev/zero -o out",
    ] {
        let start = Instant::now();
        // The run would exceed this memory limit if it read more.
        let mut command = std::process::Command::new("prlimit");
        let program = env!("CARGO_BIN_EXE_qless");
        command.args(["--data=268435456", program]).args(arguments.split(' ')).env("RAYON_NUM_THREADS", "1");
        let run = command.current_dir(place.path("")).output().expect("prlimit of util-linux");
        let words = String::from_utf8_lossy(&run.stderr);
        assert_eq!(run.status.code(), Some(3), "`{arguments}`: {words}");
        assert!(
            words.contains("no line ends within 1114112 bytes, but a line may have at most 1048576"),
            "`{arguments}`: {words}"
        );
        assert!(start.elapsed() < Duration::from_secs(5), "`{arguments}`: {:?}", start.elapsed());
    }
}

#[test]
fn more_threads_than_the_machine_has_are_not_started() {
    let place = Place::new();
    place.paper("case", 1.0);
    let run = place.run("check case --threads 999 --format json");
    let most = std::thread::available_parallelism().expect("known").get();
    assert_eq!(run.code, 0, "{}", run.err);
    assert!(run.err.contains(&format!("--threads 999: this machine runs {most} at a time")), "{}", run.err);
    assert_eq!(run.json()["backend"]["threads"], most);
    assert!(place.run("check case --threads 1").err.is_empty());
}

#[test]
fn a_bench_names_what_there_is_where_one_name_is_wrong() {
    for (arguments, wrong, known) in [
        ("--method checked --method nosuch", "no method is called `nosuch`", "gauss alone"),
        ("--family nosuch", "no family is called `nosuch`", "tie; mortar; chain"),
        ("--family tie --family ring --family Tie", "no family is called `Tie`", "tie; mortar; chain"),
    ] {
        let run = Place::new().run(&format!("bench --short -q {arguments}"));
        assert_eq!(run.code, 2, "{arguments}");
        assert!(run.err.contains(wrong) && run.err.contains(known) && run.out.is_empty(), "{arguments}: {}", run.err);
    }
}

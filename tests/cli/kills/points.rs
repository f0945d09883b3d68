//! The system calls of a run that change files or locks. Between two of them a kill finds the same files, so these are all points at which
//! a run can be killed. `strace` stops a run there.

use std::collections::HashMap;
use std::fs;
use std::process::{Child, Command, Stdio};

use super::super::harness::Place;

/// System calls that change files, folders or locks, or end the run. Those of `openat` count only if they create.
const CHANGES: &str = "openat,write,pwrite64,rename,renameat,renameat2,link,linkat,unlink,unlinkat,mkdir,mkdirat,rmdir,ftruncate,\
fsync,fdatasync,fchmod,flock,close,exit_group";

/// What a run needs.
const STRACE: &str = "strace is there: scripts/install installs it";

/// The point before the `count`-th call of a thread, counted from 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    call: String,
    count: usize,
}

impl Point {
    /// Starts a run to which `what` happens at this point, as `strace` writes it: `signal=KILL`, `delay_enter=1000`.
    pub fn start(&self, place: &Place, arguments: &str, what: &str) -> Child {
        let inject = format!("--inject={}:{what}:when={}", self.call, self.count);
        let mut command = traced(place, arguments, &["-o", "/dev/null", &inject]);
        command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect(STRACE)
    }
}

/// All points of a run, in order.
pub fn points(place: &Place, arguments: &str) -> Vec<Point> {
    let trace = place.path("trace");
    let only = format!("--trace={CHANGES}");
    let run = traced(place, arguments, &["-o", "trace", &only]).output().expect(STRACE);
    assert!(run.status.code().is_some_and(|code| code < 2), "{}", String::from_utf8_lossy(&run.stderr));
    let text = fs::read_to_string(&trace).expect("a trace");
    fs::remove_file(trace).expect("a file");
    let mut counts = HashMap::new();
    let mut points = Vec::new();
    for (thread, call, arguments) in text.lines().filter_map(called) {
        let count = counts.entry((thread, call)).or_insert(0);
        *count += 1;
        let point = Point { call: call.to_owned(), count: *count };
        if (call != "openat" || arguments.contains("O_CREAT")) && !points.contains(&point) {
            points.push(point);
        }
    }
    assert!(points.iter().any(|point| point.call.starts_with("rename")), "{text}");
    points
}

/// Thread, name and arguments of a line `12 rename("a", "b") = 0`.
fn called(line: &str) -> Option<(&str, &str, &str)> {
    let (thread, rest) = line.split_once(' ')?;
    let (call, arguments) = rest.trim_start().split_once('(')?;
    call.bytes().all(|c| c.is_ascii_alphanumeric() || c == b'_').then_some((thread, call, arguments))
}

/// The program below `strace`, which ends as the program does.
fn traced(place: &Place, arguments: &str, options: &[&str]) -> Command {
    let program = place.command(arguments);
    let mut command = Command::new("strace");
    command.args(["-f", "-qq"]).args(options).arg(program.get_program()).args(program.get_args());
    command.current_dir(program.get_current_dir().expect("a folder")).stdin(Stdio::null());
    command
}

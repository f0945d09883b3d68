//! Runs a method in a child process, which can be stopped and whose memory can be measured.
//!
//! The parent runs `qless bench --child SIZE --family F --method M`. The child prints `ready` when it has the system, `done` after
//! the first elimination, and then its result as one line of JSON (only the memory for methods that the parent runs itself), or
//! the reason for a failure. The time limit applies between `ready` and `done`. The child ends when its standard input ends, so it ends
//! with the parent.

use std::io::{BufRead, BufReader, Write, copy, sink, stdin};
use std::process::{Child, Command, Stdio, exit};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::Duration;

use qless_scenes::Scene;
use serde::de::DeserializeOwned;

use super::given_up::GivenUpReason;
use super::methods::BenchMethod;
use super::quality::Reference;
use super::run::{once, warmed};
use super::sample::Measured;

/// Time limit for generating the system and for evaluating the result, in seconds.
const AROUND: f64 = 600.0;

/// Prefix of an answer that is the reason for a failure.
const FAILED: &str = "failed: ";

/// Measures a method in a child process that is stopped after `limit` seconds.
pub fn measure(family: &str, size: &str, method: &BenchMethod, limit: f64) -> Result<Measured, GivenUpReason> {
    ask(family, size, method, limit, &["--apart"])
}

/// Peak memory of a method in bytes; `None` if it fails or exceeds the time limit.
pub fn memory(family: &str, size: &str, method: &BenchMethod, limit: f64) -> Option<u64> {
    ask::<Option<u64>>(family, size, method, limit, &[]).ok().flatten()
}

fn ask<T: DeserializeOwned>(
    family: &str,
    size: &str,
    method: &BenchMethod,
    limit: f64,
    more: &[&str],
) -> Result<T, GivenUpReason> {
    let failed = |error: std::io::Error| GivenUpReason::Failed(format!("its process does not start: {error}"));
    let mut command = Command::new(std::env::current_exe().map_err(failed)?);
    command.args(["bench", "--child", size, "--family", family, "--method", method.name]).args(more);
    command.env("OPENBLAS_NUM_THREADS", rayon::current_num_threads().to_string());
    let mut child =
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::inherit()).spawn().map_err(failed)?;
    let measured = read(&mut child, limit);
    // `kill` fails only if the child has already ended.
    _ = child.kill();
    _ = child.wait();
    measured
}

fn read<T: DeserializeOwned>(child: &mut Child, limit: f64) -> Result<T, GivenUpReason> {
    let lines = lines(child).ok_or(GivenUpReason::Ended)?;
    let next = |seconds: f64| match lines.recv_timeout(Duration::from_secs_f64(seconds)) {
        Ok(line) => {
            line.strip_prefix(FAILED).map_or(Ok(line.clone()), |why| Err(GivenUpReason::Failed(why.to_owned())))
        }
        Err(RecvTimeoutError::Timeout) => Err(GivenUpReason::Stopped { limit: seconds }),
        Err(RecvTimeoutError::Disconnected) => Err(GivenUpReason::Ended),
    };
    let (_ready, _done) = (next(AROUND)?, next(limit)?);
    serde_json::from_str(&next(AROUND)?).map_err(|_| GivenUpReason::Ended)
}

/// A channel that receives the lines of the child's standard output.
fn lines(child: &mut Child) -> Option<Receiver<String>> {
    let out = BufReader::new(child.stdout.take()?);
    let (send, receive) = channel();
    std::thread::spawn(move || out.lines().map_while(Result::ok).try_for_each(|line| send.send(line)));
    Some(receive)
}

/// Runs in the child. With `is_apart` it measures everything, otherwise only the memory. Returns errors of standard output.
pub fn answer(scene: &Scene, method: &BenchMethod, is_apart: bool, out: &mut dyn Write) -> std::io::Result<()> {
    std::thread::spawn(|| {
        // The parent writes nothing, so this returns only when the parent ends.
        let _ = copy(&mut stdin(), &mut sink());
        exit(3)
    });
    say(out, "ready")?;
    match found(scene, method, is_apart, out) {
        Ok(json) => say(out, &json?),
        // An answer must be one line.
        Err(reason) => say(out, &format!("{FAILED}{}", reason.words(None).replace('\n', " "))),
    }
}

/// Runs the method, prints `done`, and returns the answer.
fn found(
    scene: &Scene,
    method: &BenchMethod,
    is_apart: bool,
    out: &mut dyn Write,
) -> Result<std::io::Result<String>, GivenUpReason> {
    let start = reset_peak();
    let done = once(&scene.system, method)?;
    // The memory of a solver is that of its own process, which is gone.
    let peak = peak_since(start).filter(|_| !method.is_solver());
    if let Err(error) = say(out, "done") {
        return Ok(Err(error));
    }
    if !is_apart {
        return Ok(serde_json::to_string(&peak).map_err(Into::into));
    }
    let done = warmed(done, &scene.system, method)?;
    let measured = Measured { memory: peak, ..Reference::new(scene).judge(&done) };
    Ok(serde_json::to_string(&measured).map_err(Into::into))
}

fn say(out: &mut dyn Write, line: &str) -> std::io::Result<()> {
    writeln!(out, "{line}")?;
    out.flush()
}

/// Resets the peak of the resident memory; returns the resident bytes, or `None` if the system has no reset.
fn reset_peak() -> Option<u64> {
    // 5 sets VmHWM back to VmRSS: see proc_pid_clear_refs(5).
    std::fs::write("/proc/self/clear_refs", "5").ok()?;
    status("VmRSS:")
}

/// Peak of the resident bytes since the reset, minus the resident bytes `start` at that time.
fn peak_since(start: Option<u64>) -> Option<u64> {
    Some(status("VmHWM:")?.saturating_sub(start?))
}

fn status(name: &str) -> Option<u64> {
    let text = std::fs::read_to_string("/proc/self/status").ok()?;
    let kib = text.lines().find_map(|line| line.strip_prefix(name)?.trim().strip_suffix(" kB")?.trim().parse().ok());
    kib.map(|kib: u64| kib << 10)
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    #[test]
    fn the_peak_is_what_was_allocated_though_it_is_gone() {
        let Some(start) = super::reset_peak() else {
            println!("this system does not set the peak back: nothing was tested");
            return;
        };
        let block = std::hint::black_box(vec![1_u8; 64 << 20]);
        drop(block);
        let peak = super::peak_since(Some(start)).expect("Linux tells it");
        // Concurrent tests allocate too, so the upper limit is loose.
        assert!((60 << 20..2 << 30).contains(&peak), "{peak}");
    }
}

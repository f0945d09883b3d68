//! A method in a process of its own: it can be stopped, and its memory is its own.
//!
//! The parent runs `qless bench --child SIZE --family F --method M`. The child says `ready` when the system is there, `done` after
//! the elimination, and then what it found, as one line of JSON; or ends. The limit counts between the first two.

use std::io::{BufRead, BufReader, Write};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

use qless_scenes::Scene;

use super::measure::Measured;
use super::memory;
use super::methods::Method;
use super::quality::Reference;
use super::run::once;

/// Seconds for making the system and for judging the result.
const AROUND: f64 = 600.0;

/// A run shorter than this is done twice, the first one to warm the caches; seconds.
const SHORT: f64 = 0.05;

/// What the child of a system measures; none where it fails or takes more than `limit` seconds.
pub fn measure(family: &str, size: &str, method: &Method, limit: f64) -> Option<Measured> {
    let mut command = Command::new(std::env::current_exe().ok()?);
    command.args(["bench", "--child", size, "--family", family, "--method", method.name]);
    command.env("OPENBLAS_NUM_THREADS", rayon::current_num_threads().to_string());
    let mut child = command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::inherit()).spawn().ok()?;
    let measured = read(&mut child, limit);
    // It may have ended by itself.
    _ = child.kill();
    _ = child.wait();
    measured
}

fn read(child: &mut Child, limit: f64) -> Option<Measured> {
    let lines = lines(child)?;
    let next = |seconds: f64| lines.recv_timeout(Duration::from_secs_f64(seconds)).ok();
    next(AROUND).filter(|line| line == "ready")?;
    next(limit).filter(|line| line == "done")?;
    serde_json::from_str(&next(AROUND)?).ok()
}

/// The lines, as they come.
fn lines(child: &mut Child) -> Option<Receiver<String>> {
    let out = BufReader::new(child.stdout.take()?);
    let (send, receive) = channel();
    std::thread::spawn(move || out.lines().map_while(Result::ok).try_for_each(|line| send.send(line)));
    Some(receive)
}

/// The child's side. The error is that of its standard output.
pub fn answer(scene: &Scene, method: &Method, out: &mut dyn Write) -> std::io::Result<()> {
    say(out, "ready")?;
    let start = memory::start();
    let Some(mut done) = once(&scene.system, method) else { return Ok(()) };
    let peak = memory::peak_since(start);
    if done.time < SHORT {
        done = once(&scene.system, method).unwrap_or(done);
    }
    say(out, "done")?;
    let mut measured = Reference::new(scene).judge(&done);
    measured.memory = peak;
    say(out, &serde_json::to_string(&measured)?)
}

fn say(out: &mut dyn Write, line: &str) -> std::io::Result<()> {
    writeln!(out, "{line}")?;
    out.flush()
}

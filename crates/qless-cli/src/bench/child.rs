//! A method in a process of its own: it can be stopped, and its memory is its own.
//!
//! The parent runs `qless bench --child SIZE --family F --method M`. The child says `ready` when the system is there, `done` after
//! the first elimination, and then what it found, as one line of JSON (of methods that the parent runs itself the memory alone); or
//! ends. The limit counts between the first two.

use std::io::{BufRead, BufReader, Write};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

use qless_scenes::Scene;
use serde::de::DeserializeOwned;

use super::measure::Measured;
use super::memory;
use super::methods::Method;
use super::quality::Reference;
use super::run::{once, warmed};

/// Seconds for making the system and for judging the result.
const AROUND: f64 = 600.0;

/// What the child measures of a method that runs apart; none where it fails or takes more than `limit` seconds.
pub fn measure(family: &str, size: &str, method: &Method, limit: f64) -> Option<Measured> {
    ask(family, size, method, limit)
}

/// The memory of another method; none as before.
pub fn memory(family: &str, size: &str, method: &Method, limit: f64) -> Option<u64> {
    ask::<Option<u64>>(family, size, method, limit).flatten()
}

fn ask<T: DeserializeOwned>(family: &str, size: &str, method: &Method, limit: f64) -> Option<T> {
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

fn read<T: DeserializeOwned>(child: &mut Child, limit: f64) -> Option<T> {
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
    let Some(done) = once(&scene.system, method) else { return Ok(()) };
    let peak = memory::peak_since(start);
    say(out, "done")?;
    if !method.is_apart {
        return say(out, &serde_json::to_string(&peak)?);
    }
    let Some(done) = warmed(done, &scene.system, method) else { return Ok(()) };
    say(out, &serde_json::to_string(&Measured { memory: peak, ..Reference::new(scene).judge(&done) })?)
}

fn say(out: &mut dyn Write, line: &str) -> std::io::Result<()> {
    writeln!(out, "{line}")?;
    out.flush()
}

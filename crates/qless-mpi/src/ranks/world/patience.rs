//! Waits for MPI without occupying the core: there may be more ranks than cores.

use std::time::{Duration, Instant};

use mpi::request::{Request, Scope};

/// A thread that has waited for less than this yields instead of sleeping, so that it responds faster.
const AWAKE: Duration = Duration::from_micros(200);
const LONGEST_SLEEP: Duration = Duration::from_millis(1);

pub(super) struct Patience {
    since: Instant,
}

impl Patience {
    pub fn new() -> Self {
        Self { since: Instant::now() }
    }

    /// Yields at first. Later sleeps for an eighth of the time waited so far, at most a millisecond, so that the delay stays small.
    pub fn rest(&self) {
        let waited = self.since.elapsed();
        if waited < AWAKE {
            std::thread::yield_now();
        } else {
            std::thread::sleep((waited / 8).min(LONGEST_SLEEP));
        }
    }
}

/// Polls until there is a result.
pub(super) fn until<T>(mut there: impl FnMut() -> Option<T>) -> T {
    let patience = Patience::new();
    loop {
        if let Some(found) = there() {
            return found;
        }
        patience.rest();
    }
}

pub(super) fn wait<'a, D: ?Sized, S: Scope<'a>>(request: Request<'a, D, S>) {
    let mut requests = vec![request];
    until(|| all_done(&mut requests).then_some(()));
}

/// Drops completed requests, from the last to the first, until one is pending. Returns true if all are complete.
pub(super) fn all_done<'a, D: ?Sized, S: Scope<'a>>(requests: &mut Vec<Request<'a, D, S>>) -> bool {
    while let Some(request) = requests.pop() {
        if let Err(pending) = request.test() {
            requests.push(pending);
            return false;
        }
    }
    true
}

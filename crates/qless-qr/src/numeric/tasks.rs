//! Schedule of the fronts: subtrees in parallel, children before parents.
//!
//! A front depends only on its children, which are assembled in a fixed order, so the result is the same to the last bit for every
//! schedule. A subtree with enough work becomes a task. With one thread, or without memory for subtrees in parallel, all fronts run in
//! postorder on the calling thread.

use rayon::prelude::*;
use std::ops::Range;
use std::sync::{Mutex, PoisonError};

use super::FactorInput;
use super::MemoryLedger;
use super::contribution::{Contribution, FrontResult};
use super::front::Workspace;
use crate::Error;
use crate::Symbolic;
use crate::lists::NONE;

/// Minimum work of a task, in operations.
const GRAIN: f64 = 2e6;
/// Minimum work of a task as a share of the total; this bounds the depth of nested tasks.
const SHARE: f64 = 1.0 / 128.0;

/// Output of a finished front.
#[derive(Default)]
struct FrontSlot {
    contribution: Contribution,
    out: FrontResult,
}

/// Runs all fronts and returns their rows of R in order.
pub(super) fn run(
    symbolic: &Symbolic,
    numbers: &FactorInput,
    ledger: &MemoryLedger,
) -> Result<Vec<FrontResult>, Error> {
    let slots = (0..symbolic.fronts.len()).map(|_| Mutex::default()).collect();
    let all = symbolic.forecast.flops.iter().sum::<f64>();
    let parallel =
        rayon::current_num_threads() > 1 && all > 2.0 * GRAIN && bytes_in_parallel(symbolic, numbers) <= ledger.limit();
    let grain = if parallel { GRAIN.max(all * SHARE) } else { f64::INFINITY };
    let tasks = Tasks { symbolic, numbers, ledger, slots, grain };
    let count = symbolic.fronts.len() as u32;
    let roots: Vec<u32> = (0..count).filter(|&f| symbolic.fronts.parent[f as usize] == NONE).collect();
    if parallel {
        tasks.siblings(&roots)?;
    } else {
        tasks.sequence(std::slice::from_ref(&(0..count)))?;
    }
    let out = |slot: Mutex<FrontSlot>| slot.into_inner().unwrap_or_else(PoisonError::into_inner).out;
    Ok(tasks.slots.into_iter().map(out).collect())
}

/// Memory for a parallel run; with Q, each thread needs its own memory for reflections.
fn bytes_in_parallel(symbolic: &Symbolic, numbers: &FactorInput) -> usize {
    let of_q = if numbers.keep_q { symbolic.memory_of_q().saturating_mul(rayon::current_num_threads()) } else { 0 };
    symbolic.forecast.bytes_in_parallel(symbolic, numbers.count).saturating_add(of_q)
}

struct Tasks<'a> {
    symbolic: &'a Symbolic,
    numbers: &'a FactorInput<'a>,
    ledger: &'a MemoryLedger,
    slots: Vec<Mutex<FrontSlot>>,
    grain: f64,
}

impl Tasks<'_> {
    /// Runs the subtrees of the given fronts in parallel.
    fn siblings(&self, tops: &[u32]) -> Result<(), Error> {
        let (heavy, light) = self.divided(tops);
        let jobs: Vec<FrontTask> =
            heavy.into_iter().map(FrontTask::Subtree).chain(self.batches(light).map(FrontTask::Batch)).collect();
        jobs.into_par_iter().try_for_each(|job| match job {
            FrontTask::Subtree(top) => self.subtree(top),
            FrontTask::Batch(ranges) => self.sequence(&ranges),
        })
    }

    /// Runs a subtree. Follows the path down while exactly one child is heavy enough for a task. Runs the children at the end of
    /// the path in parallel if several are heavy. Then runs the fronts of the path, from the end up.
    fn subtree(&self, top: u32) -> Result<(), Error> {
        let mut path = vec![top];
        loop {
            let children = self.children(path[path.len() - 1]);
            match self.divided(children).0[..] {
                [] => break,
                [only] => path.push(only),
                _ => {
                    self.siblings(children)?;
                    break;
                }
            }
        }
        let bottom = path[path.len() - 1];
        let mut ranges = Vec::new();
        let divided = !self.divided(self.children(bottom)).0.is_empty();
        if !divided {
            ranges.push(self.symbolic.fronts.first[bottom as usize]..bottom);
        }
        ranges.push(bottom..bottom + 1);
        for pair in path.windows(2).rev() {
            ranges.extend(self.divided(self.children(pair[0])).1.into_iter().map(|child| self.range(child)));
            ranges.push(pair[0]..pair[0] + 1);
        }
        self.sequence(&ranges)
    }

    fn children(&self, f: u32) -> &[u32] {
        self.symbolic.fronts.children.list(f as usize)
    }

    fn range(&self, f: u32) -> Range<u32> {
        self.symbolic.fronts.first[f as usize]..f + 1
    }

    /// Subtrees that are heavy enough for a task, and the other, light subtrees.
    fn divided(&self, tops: &[u32]) -> (Vec<u32>, Vec<u32>) {
        tops.iter().partition(|&&f| self.symbolic.forecast.work[f as usize] >= self.grain)
    }

    /// Batches of light subtrees. Each batch except the last is heavy enough for a task.
    fn batches(&self, light: Vec<u32>) -> impl Iterator<Item = Vec<Range<u32>>> {
        let (mut batches, mut work) = (vec![Vec::new()], 0.0);
        for f in light {
            if work >= self.grain {
                batches.push(Vec::new());
                work = 0.0;
            }
            work += self.symbolic.forecast.work[f as usize];
            if let Some(batch) = batches.last_mut() {
                batch.push(self.range(f));
            }
        }
        batches.into_iter().filter(|batch| !batch.is_empty())
    }

    /// Runs fronts one after the other.
    fn sequence(&self, ranges: &[Range<u32>]) -> Result<(), Error> {
        let mut workspace = Workspace::new(self.symbolic, self.numbers, self.ledger);
        for f in ranges.iter().cloned().flatten() {
            let contribution = |child: &u32| std::mem::take(&mut self.slot(*child).contribution);
            let children = self.children(f).iter().map(contribution).collect();
            let (contribution, out) = workspace.front(f as usize, children)?;
            *self.slot(f) = FrontSlot { contribution, out };
        }
        Ok(())
    }

    fn slot(&self, f: u32) -> std::sync::MutexGuard<'_, FrontSlot> {
        self.slots[f as usize].lock().unwrap_or_else(PoisonError::into_inner)
    }
}

enum FrontTask {
    Subtree(u32),
    Batch(Vec<Range<u32>>),
}

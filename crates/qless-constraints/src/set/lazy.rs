//! The plan of H, made when somebody needs it, and brought up to date from the last one.

use std::sync::{Mutex, OnceLock, PoisonError};

use super::block::Block;
use super::effective::Plan;

/// A plan, or what is known of the next one.
#[derive(Default)]
pub(super) struct Planned {
    current: OnceLock<Plan>,
    /// The last one, and the rows of H whose entries changed since.
    last: Mutex<Option<Plan>>,
    touched: Vec<u32>,
}

impl Planned {
    /// The plan for the blocks as they are.
    pub fn plan(&self, blocks: &[Box<dyn Block>], dofs: usize) -> &Plan {
        if let Some(plan) = self.current.get() {
            return plan;
        }
        let last = self.last.lock().unwrap_or_else(PoisonError::into_inner).take();
        // Many changes are done at once.
        let known = last.filter(|_| self.touched.len() < dofs);
        let plan = known.map_or_else(|| Plan::new(blocks, dofs), |last| last.updated(blocks, &self.touched));
        // Not within the lock: while its threads wait, they may take up work that asks for the plan too. The first one is kept.
        self.current.get_or_init(|| plan)
    }

    /// Blocks change; the plan is not that of the blocks any more.
    pub fn outdate(&mut self) {
        let last = self.last.get_mut().unwrap_or_else(PoisonError::into_inner);
        if let Some(plan) = self.current.take() {
            *last = Some(plan);
            self.touched.clear();
        }
    }

    /// Whether there is a plan to bring up to date.
    pub fn is_wanted(&mut self) -> bool {
        self.last.get_mut().unwrap_or_else(PoisonError::into_inner).is_some()
    }

    /// The rows of H that the items of a block have entries in, which come.
    pub fn touch_all(&mut self, block: &dyn Block) {
        (0..block.items()).for_each(|item| self.touch(block, item));
    }

    /// The rows of H that an item has entries in, which comes or goes.
    pub fn touch(&mut self, block: &dyn Block, item: usize) {
        if self.is_wanted() {
            block.touched(item, &mut |row| self.touched.push(row));
        }
    }
}

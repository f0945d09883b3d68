//! From DOFs to columns, in little more room than the columns themselves.

use rustc_hash::FxHashMap;

use super::Dof;
use super::chunks::Chunks;

/// Nodes of a page: numbers that follow each other, as they do in most decks.
const PAGE: u32 = 16;
const NONE: u32 = u32::MAX;

/// A map from DOFs to columns. DOFs of the same component on consecutive nodes share a page, and it is the pages that are hashed.
#[derive(Clone, Debug, Default)]
pub(super) struct Columns {
    pages: FxHashMap<(u32, u8), u32>,
    entries: Chunks<[u32; PAGE as usize]>,
    /// The pages found last, by place in the equation and component: the same ones come again in the next equation.
    last: [Option<((u32, u8), u32)>; 16],
}

impl Columns {
    /// The column of a DOF.
    pub fn get(&self, dof: Dof) -> Option<u32> {
        let &page = self.pages.get(&key(dof))?;
        let column = self.entries[page as usize][(dof.node % PAGE) as usize];
        (column != NONE).then_some(column)
    }

    /// The column of a DOF, which is `next` if it had none.
    pub fn get_or_insert(&mut self, dof: Dof, next: u32, turn: usize) -> u32 {
        let key = key(dof);
        let slot = turn % 4 * 4 + usize::from(dof.component % 4);
        let page = match self.last[slot] {
            Some((last, page)) if last == key => page,
            _ => {
                let fresh = self.entries.len() as u32;
                let page = *self.pages.entry(key).or_insert(fresh);
                if page == fresh {
                    self.entries.push([NONE; PAGE as usize]);
                }
                self.last[slot] = Some((key, page));
                page
            }
        };
        let entry = &mut self.entries[page as usize][(dof.node % PAGE) as usize];
        if *entry == NONE {
            *entry = next;
        }
        *entry
    }
}

fn key(dof: Dof) -> (u32, u8) {
    (dof.node / PAGE, dof.component)
}

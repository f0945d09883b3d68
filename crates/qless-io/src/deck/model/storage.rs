//! Stores a model compactly: the column of each DOF, the terms, and the origins of equations.

use rustc_hash::FxHashMap;

use super::constraints::{Dof, Origin};
use crate::deck::paged_list::PagedList;

/// Number of consecutive nodes in a page.
const PAGE: u32 = 16;
const NONE: u32 = u32::MAX;

/// A map from DOFs to columns. DOFs with the same component at consecutive nodes share a page. Only pages are hashed, which is faster.
#[derive(Clone, Debug, Default)]
pub(super) struct ColumnMap {
    pages: FxHashMap<(u32, u8), u32>,
    entries: PagedList<[u32; PAGE as usize]>,
    /// Recently used pages with their keys. The place of a page in this list follows from the position of the term in its equation and from
    /// the component, because the next equation often uses the same pages.
    last: [Option<((u32, u8), u32)>; 16],
}

impl ColumnMap {
    /// The column of a DOF.
    pub fn get(&self, dof: Dof) -> Option<u32> {
        let &page = self.pages.get(&key(dof))?;
        let column = self.entries[page as usize][(dof.node % PAGE) as usize];
        (column != NONE).then_some(column)
    }

    /// The column of a DOF. A new DOF gets the column `next`. `position` is the index of its term in the equation, which finds the page
    /// faster.
    pub fn get_or_insert(&mut self, dof: Dof, next: u32, position: usize) -> u32 {
        let key = key(dof);
        let slot = position % 4 * 4 + usize::from(dof.component % 4);
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

/// A run of equations with regular origins. The origin of equation `first + k` is `origin` moved by `k * stride` lines and `k * cards`
/// cards.
#[derive(Clone, Copy, Debug)]
pub(super) struct OriginRun {
    pub first: u32,
    pub origin: Origin,
    pub stride: u32,
    pub cards: u32,
}

impl OriginRun {
    /// Origin of equation `i`.
    pub fn at(&self, i: usize) -> Origin {
        let further = |from: u32, stride: u32| from.wrapping_add((i as u32 - self.first).wrapping_mul(stride));
        let Origin { card, line, lines } = self.origin;
        Origin { card: further(card, self.cards), line: further(line, self.stride), lines }
    }

    /// Adds equation `i` to the run if it fits. The second equation of a run sets the strides.
    pub fn try_extend(&mut self, i: usize, origin: Origin) -> bool {
        if self.first + 1 == i as u32 {
            self.stride = origin.line.wrapping_sub(self.origin.line);
            self.cards = origin.card.wrapping_sub(self.origin.card);
        }
        self.at(i) == origin
    }
}

/// Terms of all equations, one after the other.
#[derive(Clone, Debug, Default)]
pub(super) struct TermStorage {
    pub columns: Vec<u32>,
    pub coefficients: Vec<f64>,
}

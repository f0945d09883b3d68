//! A list that grows without moving its items. Moving them would take time, and memory for both copies.

use std::ops::{Index, IndexMut};

/// Number of items in a page.
const PAGE: usize = 1 << 14;

/// A list that is split into pages. All pages but the last are full.
#[derive(Clone, Debug)]
pub(super) struct PagedList<T> {
    pages: Vec<Vec<T>>,
}

impl<T> Default for PagedList<T> {
    fn default() -> Self {
        Self { pages: Vec::new() }
    }
}

impl<T> PagedList<T> {
    pub fn len(&self) -> usize {
        self.pages.last().map_or(0, |last| (self.pages.len() - 1) * PAGE + last.len())
    }

    pub fn push(&mut self, item: T) {
        if let Some(last) = self.pages.last_mut().filter(|last| last.len() < PAGE) {
            last.push(item);
            return;
        }
        // The first page grows as needed, so that a short list takes little memory.
        let room = if self.pages.is_empty() { 0 } else { PAGE };
        let mut page = Vec::with_capacity(room);
        page.push(item);
        self.pages.push(page);
    }

    pub fn pop(&mut self) -> Option<T> {
        let last = self.pages.last_mut()?;
        let item = last.pop();
        if last.is_empty() {
            self.pages.pop();
        }
        item
    }

    pub fn last(&self) -> Option<&T> {
        self.pages.last()?.last()
    }

    pub fn last_mut(&mut self) -> Option<&mut T> {
        self.pages.last_mut()?.last_mut()
    }

    pub fn iter(&self) -> impl Iterator<Item = &T> + Clone {
        self.pages.iter().flatten()
    }

    /// The items from index `start` on.
    pub fn iter_from(&self, start: usize) -> impl Iterator<Item = &T> + Clone {
        let pages = self.pages.get(start / PAGE..).unwrap_or_default();
        pages.iter().flatten().skip(start % PAGE)
    }

    /// Number of leading items for which `is_such` is true. It must be false for all items after them.
    pub fn partition_point(&self, is_such: impl Fn(&T) -> bool) -> usize {
        let full = self.pages.partition_point(|page| page.last().is_some_and(&is_such));
        match self.pages.get(full) {
            Some(page) => full * PAGE + page.partition_point(is_such),
            None => self.len(),
        }
    }

    /// All items, in order.
    pub fn into_items(self) -> impl Iterator<Item = T> {
        self.pages.into_iter().flatten()
    }
}

impl<T> FromIterator<T> for PagedList<T> {
    fn from_iter<I: IntoIterator<Item = T>>(items: I) -> Self {
        let mut pages = Self::default();
        items.into_iter().for_each(|item| pages.push(item));
        pages
    }
}

impl<T> Index<usize> for PagedList<T> {
    type Output = T;

    fn index(&self, i: usize) -> &T {
        &self.pages[i / PAGE][i % PAGE]
    }
}

impl<T> IndexMut<usize> for PagedList<T> {
    fn index_mut(&mut self, i: usize) -> &mut T {
        &mut self.pages[i / PAGE][i % PAGE]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pages_are_a_list() {
        for count in [0, 1, PAGE - 1, PAGE, PAGE + 1, 3 * PAGE] {
            let mut list: Vec<usize> = (0..count).map(|k| 2 * k).collect();
            let mut pages: PagedList<usize> = list.iter().copied().collect();
            assert_eq!((pages.len(), pages.last()), (list.len(), list.last()));
            for at in [0, 1, PAGE / 2, PAGE, PAGE + 5, count] {
                assert!(pages.iter_from(at).eq(list.iter().skip(at)));
                assert_eq!(pages.partition_point(|&k| k < 2 * at), list.partition_point(|&k| k < 2 * at));
                if at < count {
                    (pages[at], list[at]) = (pages[at] + 1, list[at] + 1);
                    assert_eq!(pages[at], list[at]);
                }
            }
            assert!(pages.iter().eq(&list));
            assert_eq!((pages.pop(), pages.len()), (list.pop(), list.len()));
            assert!(pages.into_items().eq(list));
        }
    }
}

//! A container of equations or coupled sets by their number.
//!
//! Items whose numbers ascend, as in most decks, are appended to a list. An item with a number below the last one is stored in a map.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use crate::deck::paged_list::PagedList;

/// Equations or coupled sets, each with its number.
#[derive(Debug)]
pub struct NumberedSets<T> {
    /// Items in ascending order of numbers; `None` marks a removed item. The last entry is never `None`.
    list: PagedList<(u32, Option<T>)>,
    /// Number of `None` in `list`.
    removed: usize,
    /// Items that were inserted after an item with a higher number.
    late: BTreeMap<u32, T>,
}

impl<T> Default for NumberedSets<T> {
    fn default() -> Self {
        Self { list: PagedList::default(), removed: 0, late: BTreeMap::new() }
    }
}

impl<T> NumberedSets<T> {
    pub fn len(&self) -> usize {
        self.list.len() - self.removed + self.late.len()
    }

    /// The highest number of all items.
    pub fn highest(&self) -> Option<u32> {
        let late = self.late.last_key_value().map(|(&number, _)| number);
        self.list.last().map(|(number, _)| *number).max(late)
    }

    pub fn get_mut(&mut self, number: u32) -> Option<&mut T> {
        match self.index(number).filter(|&index| self.list[index].1.is_some()) {
            Some(index) => self.list[index].1.as_mut(),
            None => self.late.get_mut(&number),
        }
    }

    /// The item of this number if it is the last of the list, which is the usual case; `None` otherwise.
    pub fn last_mut(&mut self, number: u32) -> Option<&mut T> {
        self.list.last_mut().filter(|(last, _)| *last == number)?.1.as_mut()
    }

    /// Sets the item of this number and returns the previous one.
    pub fn insert(&mut self, number: u32, value: T) -> Option<T> {
        let is_above = self.list.last().is_none_or(|(last, _)| *last < number);
        if let Some(known) = if is_above { self.late.get_mut(&number) } else { self.get_mut(number) } {
            return Some(std::mem::replace(known, value));
        }
        if is_above {
            self.list.push((number, Some(value)));
        } else {
            self.late.insert(number, value);
        }
        None
    }

    /// The item of this number. If there is none, inserts `new()` first.
    pub fn get_or_insert_with(&mut self, number: u32, new: impl FnOnce() -> T) -> &mut T {
        if self.get_mut(number).is_none() {
            self.insert(number, new());
        }
        self.get_mut(number).expect("it was found or inserted")
    }

    /// The numbers within a range, in any order.
    pub fn within(&self, range: RangeInclusive<u32>) -> Vec<u32> {
        let list = self.list.iter_from(self.list.partition_point(|(number, _)| number < range.start()));
        let list = list.take_while(|(number, _)| number <= range.end());
        let mut numbers: Vec<u32> = list.filter(|(_, value)| value.is_some()).map(|(number, _)| *number).collect();
        numbers.extend(self.late.range(range).map(|(&number, _)| number));
        numbers
    }

    /// Removes and returns the item of this number.
    pub fn remove(&mut self, number: u32) -> Option<T> {
        let removed = self.index(number).and_then(|index| self.list[index].1.take());
        self.removed += usize::from(removed.is_some());
        let removed = removed.or_else(|| self.late.remove(&number));
        // Drops removed items at the end of the list. If more than half of all items are removed, drops all removed ones, which bounds the
        // time to skip them.
        if 2 * self.removed > self.list.len() || self.list.last().is_some_and(|(_, value)| value.is_none()) {
            self.compact();
        }
        removed
    }

    pub fn clear(&mut self) {
        *self = Self::default();
    }

    /// All items in ascending order of their numbers.
    pub fn iter(&self) -> impl Iterator<Item = (u32, &T)> {
        let mut list = self.list.iter().filter_map(|(number, value)| Some((*number, value.as_ref()?))).peekable();
        let mut late = self.late.iter().map(|(&number, value)| (number, value)).peekable();
        std::iter::from_fn(move || match (list.peek(), late.peek()) {
            (Some((first, _)), Some((other, _))) if other < first => late.next(),
            (None, _) => late.next(),
            _ => list.next(),
        })
    }

    fn index(&self, number: u32) -> Option<usize> {
        let last = self.list.len().checked_sub(1)?;
        if self.list[last].0 <= number {
            return (self.list[last].0 == number).then_some(last);
        }
        let index = self.list.partition_point(|(other, _)| *other < number);
        (index <= last && self.list[index].0 == number).then_some(index)
    }

    fn compact(&mut self) {
        if 2 * self.removed > self.list.len() {
            self.list = std::mem::take(&mut self.list).into_items().filter(|(_, value)| value.is_some()).collect();
            self.removed = 0;
        }
        while self.list.last().is_some_and(|(_, value)| value.is_none()) {
            self.list.pop();
            self.removed -= 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Does many random operations on the container and on a standard map, and compares the two after each.
    #[test]
    fn sets_do_what_a_map_does() {
        let (mut sets, mut map) = (NumberedSets::default(), BTreeMap::new());
        let mut state = 7_u32;
        let mut next = |below: u32| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 16) % below
        };
        for step in 0..20_000 {
            let number = if step % 3 == 0 { step } else { next(1 + step) };
            match next(4) {
                0 => assert_eq!(sets.remove(number), map.remove(&number)),
                1 => assert_eq!(sets.insert(number, step), map.insert(number, step)),
                2 => {
                    *sets.get_or_insert_with(number, || step) += 1;
                    *map.entry(number).or_insert(step) += 1;
                }
                _ => assert_eq!(sets.get_mut(number), map.get_mut(&number)),
            }
            assert_eq!((sets.len(), sets.highest()), (map.len(), map.last_key_value().map(|(&number, _)| number)));
        }
        assert!(sets.iter().eq(map.iter().map(|(&number, value)| (number, value))));
        let mut within = sets.within(500..=9000);
        within.sort_unstable();
        assert!(within.iter().eq(map.range(500..=9000).map(|(number, _)| number)));
        sets.clear();
        assert_eq!((sets.len(), sets.highest()), (0, None));
    }
}

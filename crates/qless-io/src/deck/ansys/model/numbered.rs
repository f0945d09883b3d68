//! Equations or coupled sets by number. Decks number them upwards, so that they stand in a row; others stand apart.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use crate::deck::paged_list::PagedList;

/// Things by their number.
#[derive(Debug)]
pub struct NumberedSets<T> {
    /// Ascending; nothing where one was taken away, but for the last.
    row: PagedList<(u32, Option<T>)>,
    /// How many were taken away in `row`.
    gone: usize,
    /// Those that came after a higher number.
    apart: BTreeMap<u32, T>,
}

impl<T> Default for NumberedSets<T> {
    fn default() -> Self {
        Self { row: PagedList::default(), gone: 0, apart: BTreeMap::new() }
    }
}

impl<T> NumberedSets<T> {
    pub fn len(&self) -> usize {
        self.row.len() - self.gone + self.apart.len()
    }

    /// The highest number.
    pub fn highest(&self) -> Option<u32> {
        let apart = self.apart.last_key_value().map(|(&number, _)| number);
        self.row.last().map(|(number, _)| *number).max(apart)
    }

    pub fn get_mut(&mut self, number: u32) -> Option<&mut T> {
        match self.place(number).filter(|&place| self.row[place].1.is_some()) {
            Some(place) => self.row[place].1.as_mut(),
            None => self.apart.get_mut(&number),
        }
    }

    /// What has this number, if it is the last in the row: it mostly is.
    pub fn last_mut(&mut self, number: u32) -> Option<&mut T> {
        self.row.last_mut().filter(|(last, _)| *last == number)?.1.as_mut()
    }

    /// Puts in what has this number from now on, and gives what had it before.
    pub fn insert(&mut self, number: u32, value: T) -> Option<T> {
        let is_above = self.row.last().is_none_or(|(last, _)| *last < number);
        if let Some(known) = if is_above { self.apart.get_mut(&number) } else { self.get_mut(number) } {
            return Some(std::mem::replace(known, value));
        }
        if is_above {
            self.row.push((number, Some(value)));
        } else {
            self.apart.insert(number, value);
        }
        None
    }

    /// What has this number; `new` if there was nothing.
    pub fn get_or_insert_with(&mut self, number: u32, new: impl FnOnce() -> T) -> &mut T {
        if self.get_mut(number).is_none() {
            self.insert(number, new());
        }
        self.get_mut(number).expect("it is there: known before or put in")
    }

    /// The numbers within a range, in no order.
    pub fn within(&self, range: RangeInclusive<u32>) -> Vec<u32> {
        let row = self.row.iter_from(self.row.partition_point(|(number, _)| number < range.start()));
        let row = row.take_while(|(number, _)| number <= range.end());
        let mut numbers: Vec<u32> = row.filter(|(_, value)| value.is_some()).map(|(number, _)| *number).collect();
        numbers.extend(self.apart.range(range).map(|(&number, _)| number));
        numbers
    }

    /// Takes away what has this number.
    pub fn remove(&mut self, number: u32) -> Option<T> {
        let removed = self.place(number).and_then(|place| self.row[place].1.take());
        self.gone += usize::from(removed.is_some());
        let removed = removed.or_else(|| self.apart.remove(&number));
        // To keep few of those that are gone bounds the time that it takes to pass over them.
        if 2 * self.gone > self.row.len() || self.row.last().is_some_and(|(_, value)| value.is_none()) {
            self.forget();
        }
        removed
    }

    pub fn clear(&mut self) {
        *self = Self::default();
    }

    /// All by ascending number.
    pub fn iter(&self) -> impl Iterator<Item = (u32, &T)> {
        let mut row = self.row.iter().filter_map(|(number, value)| Some((*number, value.as_ref()?))).peekable();
        let mut apart = self.apart.iter().map(|(&number, value)| (number, value)).peekable();
        std::iter::from_fn(move || match (row.peek(), apart.peek()) {
            (Some((first, _)), Some((other, _))) if other < first => apart.next(),
            (None, _) => apart.next(),
            _ => row.next(),
        })
    }

    fn place(&self, number: u32) -> Option<usize> {
        let last = self.row.len().checked_sub(1)?;
        if self.row[last].0 <= number {
            return (self.row[last].0 == number).then_some(last);
        }
        let place = self.row.partition_point(|(other, _)| *other < number);
        (place <= last && self.row[place].0 == number).then_some(place)
    }

    fn forget(&mut self) {
        if 2 * self.gone > self.row.len() {
            self.row = std::mem::take(&mut self.row).into_items().filter(|(_, value)| value.is_some()).collect();
            self.gone = 0;
        }
        while self.row.last().is_some_and(|(_, value)| value.is_none()) {
            self.row.pop();
            self.gone -= 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The same steps with a map, which cannot be wrong.
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

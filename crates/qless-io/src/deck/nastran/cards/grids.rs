//! A compact table of grid points by number. Data that many points share is stored once.

use std::cmp::Ordering;

use rustc_hash::FxHashMap;

use super::points::{GridCard, GridDefaults};
use crate::deck::CardName;
use crate::deck::kinematics::vector::Vector;
use crate::deck::nastran::syntax::card::CardLocation;
use crate::deck::paged_list::PagedList;

/// A grid point.
#[derive(Clone, Copy, Debug)]
pub struct GridPoint {
    /// Coordinates in the coordinate system CP of the card.
    pub at: Vector,
    pub id: u32,
    line: u32,
    /// Index in `Grids::shared` of the data that this point shares with others.
    shared: u32,
}

/// What many `GRID` cards have in common: the file, and all fields except the number and the coordinates.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
struct SharedGridData {
    file: u32,
    fields: GridDefaults,
}

/// The grid points of a deck.
#[derive(Debug, Default)]
pub struct Grids {
    all: PagedList<GridPoint>,
    shared: Vec<SharedGridData>,
    by_shared: FxHashMap<SharedGridData, u32>,
    /// The shared data of the last point that was added, and their index.
    recent: Option<(SharedGridData, u32)>,
    /// Pairs of cards that define the same point equally, ascending by the number of the point.
    pub repeated: Vec<[CardLocation; 2]>,
}

impl Grids {
    /// Adds the point of a card; `file` and `line` are those of the card.
    pub fn push(&mut self, card: &GridCard, file: u32, line: u32) {
        let shared = self.share(SharedGridData { file, fields: card.fields });
        self.all.push(GridPoint { at: card.at, id: card.id, line, shared });
    }

    fn share(&mut self, shared: SharedGridData) -> u32 {
        // The previous point usually has the same data, so its index is tried first.
        if let Some((recent, index)) = self.recent
            && recent == shared
        {
            return index;
        }
        let index = *self.by_shared.entry(shared).or_insert_with(|| {
            self.shared.push(shared);
            self.shared.len() as u32 - 1
        });
        self.recent = Some((shared, index));
        index
    }

    /// Sorts the points by number and removes duplicates. The error is a number that two different cards define.
    pub fn sort(&mut self) -> Result<(), Box<(u32, [CardLocation; 2])>> {
        if self.all.iter().is_sorted_by(|a, b| a.id < b.id) {
            return Ok(());
        }
        let mut all: Vec<GridPoint> = std::mem::take(&mut self.all).into_items().collect();
        all.sort_by_key(|grid| grid.id);
        let data = |grid: &GridPoint| (grid.at, self.fields(grid));
        let differs = |pair: &&[GridPoint]| pair[0].id == pair[1].id && data(&pair[0]) != data(&pair[1]);
        if let Some([first, second]) = all.windows(2).find(differs) {
            return Err(Box::new((first.id, [self.place(first), self.place(second)])));
        }
        let same = all.windows(2).filter(|pair| pair[0].id == pair[1].id);
        self.repeated = same.map(|pair| [self.place(&pair[0]), self.place(&pair[1])]).collect();
        all.dedup_by_key(|grid| grid.id);
        self.all = all.into_iter().collect();
        Ok(())
    }

    /// The place of the card that defines a point.
    pub fn place(&self, grid: &GridPoint) -> CardLocation {
        let file = self.shared[grid.shared as usize].file;
        CardLocation { name: CardName::numbered("GRID", grid.id), file, line: grid.line, lines: 1 }
    }

    /// The fields of the point's card except the number and the coordinates.
    pub fn fields(&self, grid: &GridPoint) -> GridDefaults {
        self.shared[grid.shared as usize].fields
    }

    /// Whether the fields of some point satisfy `is_such`.
    pub fn any(&self, is_such: impl Fn(GridDefaults) -> bool) -> bool {
        self.shared.iter().any(|shared| is_such(shared.fields))
    }

    pub fn iter(&self) -> impl Iterator<Item = &GridPoint> {
        self.all.iter()
    }

    /// The points whose number is at least `id`.
    pub fn from(&self, id: u32) -> impl Iterator<Item = &GridPoint> {
        self.all.iter_from(self.all.partition_point(|grid| grid.id < id))
    }

    /// The point with this number; the points must be sorted. If no numbers are missing, the first place searched is the right one.
    pub fn get(&self, id: u32) -> Option<&GridPoint> {
        let first = self.all.iter().next()?.id;
        let mut end = self.all.len().min(id.checked_sub(first)? as usize + 1);
        let (mut beyond, mut step) = (end, 1);
        // Without missing numbers, the index would be `id - first`. Missing numbers lower it, so the search goes backwards, with steps that
        // double.
        loop {
            let grid = &self.all[end - 1];
            match grid.id.cmp(&id) {
                Ordering::Equal => return Some(grid),
                Ordering::Less => break,
                Ordering::Greater => (beyond, end, step) = (end - 1, end.saturating_sub(step).max(1), 2 * step),
            }
        }
        let between = self.all.partition_point(|grid| grid.id < id);
        (between < beyond).then(|| &self.all[between]).filter(|grid| grid.id == id)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_found_by_number_wherever_numbers_are_missing() {
        let mut grids = Grids::default();
        let numbers: Vec<u32> = (1..200).filter(|n| n % 7 != 0).chain([500, 900, 901, 902, 4_000_000_000]).collect();
        for &id in numbers.iter().rev() {
            grids.push(&GridCard { id, at: [f64::from(id); 3], fields: GridDefaults::default() }, 0, id);
        }
        assert!(grids.sort().is_ok());
        for id in (0..1000).chain([3_999_999_999, 4_000_000_000, u32::MAX]) {
            let found = grids.get(id).map(|grid| grid.at[0]);
            assert_eq!(found, numbers.contains(&id).then_some(f64::from(id)), "{id}");
        }
    }

    #[test]
    fn equal_cards_are_one_point_and_others_clash() {
        let fields = |digits: &[u8]| GridDefaults {
            prescribed: crate::deck::kinematics::components::Components::parse(digits),
            ..GridDefaults::default()
        };
        let mut grids = Grids::default();
        for (digits, file) in [(b"12", 0), (b"12", 1)] {
            grids.push(&GridCard { id: 3, at: [1.0; 3], fields: fields(digits) }, file, 1 + file);
        }
        assert!(grids.sort().is_ok());
        assert_eq!(grids.iter().count(), 1);
        grids.push(&GridCard { id: 3, at: [1.0; 3], fields: fields(b"1") }, 1, 9);
        let clash = grids.sort().expect_err("a clash");
        assert_eq!((clash.0, clash.1.map(|place| (place.file, place.line))), (3, [(0, 1), (1, 9)]));
    }
}

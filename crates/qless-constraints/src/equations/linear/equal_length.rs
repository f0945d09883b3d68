//! Linear equations with the same number of terms: edits of the group, the loop that evaluates them, and a cache of coefficient lists.

use qless::common::Identity;

/// Linear equations of a batch that have the same number of terms.
pub struct EqualLengthRows<I> {
    pub terms: usize,
    /// Rows in the batch, ascending.
    pub row: Vec<u16>,
    /// Start of each row's coefficient list.
    pub list: Vec<u32>,
    /// DOFs relative to the base of the batch, row by row.
    pub dofs: Vec<I>,
}

/// Equations with at most this many terms get memory for a whole batch in advance.
const SHORT: usize = 16;

/// A DOF relative to the base of its batch, in 16 or 32 bits.
pub trait DofOffset: Copy {
    fn from_u32(offset: u32) -> Self;
    fn value(self) -> u32;
}

impl DofOffset for u16 {
    fn from_u32(offset: u32) -> Self {
        offset as Self
    }
    fn value(self) -> u32 {
        self.into()
    }
}

impl DofOffset for u32 {
    fn from_u32(offset: u32) -> Self {
        offset
    }
    fn value(self) -> u32 {
        self
    }
}

impl<I: DofOffset> EqualLengthRows<I> {
    /// Moves the rows from `row` on back by `by`.
    pub fn shift(&mut self, row: usize, by: u16) {
        self.row.iter_mut().for_each(|r| *r += if usize::from(*r) >= row { by } else { 0 });
    }

    /// Inserts an equation at a row that is free.
    pub fn insert(&mut self, row: usize, list: u32, dofs: impl Iterator<Item = u32>) {
        let behind = self.row.last().is_none_or(|&last| usize::from(last) < row);
        let place = if behind { self.row.len() } else { self.row.partition_point(|&r| usize::from(r) < row) };
        self.row.insert(place, row as u16);
        self.list.insert(place, list);
        let first = place * self.terms;
        if first == self.dofs.len() {
            self.dofs.extend(dofs.map(I::from_u32));
        } else {
            self.dofs.splice(first..first, dofs.map(I::from_u32));
        }
    }

    /// Removes the row if it belongs to this group. Later rows move up by one in any case.
    pub fn remove(&mut self, row: usize) {
        if let Ok(place) = self.row.binary_search(&(row as u16)) {
            self.row.remove(place);
            self.list.remove(place);
            self.dofs.drain(place * self.terms..(place + 1) * self.terms);
        }
        self.row.iter_mut().for_each(|r| *r -= u16::from(usize::from(*r) > row));
    }

    /// DOFs and coefficients of the equation at index `place`.
    pub fn terms<'a>(&'a self, place: usize, base: u32, lists: &'a [f64]) -> impl Iterator<Item = (u32, f64)> + 'a {
        let dofs = &self.dofs[place * self.terms..(place + 1) * self.terms];
        dofs.iter().zip(&lists[self.list[place] as usize..]).map(move |(&j, &v)| (base + j.value(), v))
    }

    /// Writes the columns and coefficients of these equations; `end` holds the end of each row of the batch.
    pub fn write_rows(&self, (base, lists): (u32, &[f64]), end: &[usize], col: &mut [u32], val: &mut [f64]) {
        for (i, (&row, &list)) in self.row.iter().zip(&self.list).enumerate() {
            let last = end[usize::from(row)];
            let dofs = &self.dofs[i * self.terms..(i + 1) * self.terms];
            col[last - self.terms..last].iter_mut().zip(dofs).for_each(|(col, dof)| *col = base + dof.value());
            val[last - self.terms..last].copy_from_slice(&lists[list as usize..][..self.terms]);
        }
    }

    /// Reserves memory for this many rows, if the rows are short.
    pub fn reserve(&mut self, rows: usize) {
        if self.terms <= SHORT {
            self.row.reserve_exact(rows);
            self.list.reserve_exact(rows);
            self.dofs.reserve_exact(rows * self.terms);
        }
    }
}

impl<I: Copy> EqualLengthRows<I> {
    #[inline]
    pub fn evaluate(&self, lists: &[f64], u: impl Fn(I) -> f64 + Copy, (rhs, c): (&[f64], &mut [f64])) {
        match self.terms {
            1 => self.fixed::<1>(lists, u, (rhs, c)),
            2 => self.fixed::<2>(lists, u, (rhs, c)),
            3 => self.fixed::<3>(lists, u, (rhs, c)),
            4 => self.fixed::<4>(lists, u, (rhs, c)),
            5 => self.fixed::<5>(lists, u, (rhs, c)),
            6 => self.fixed::<6>(lists, u, (rhs, c)),
            7 => self.fixed::<7>(lists, u, (rhs, c)),
            8 => self.fixed::<8>(lists, u, (rhs, c)),
            9 => self.fixed::<9>(lists, u, (rhs, c)),
            _ => self.any(lists, u, (rhs, c)),
        }
    }

    #[inline]
    fn fixed<const N: usize>(&self, lists: &[f64], u: impl Fn(I) -> f64, (rhs, c): (&[f64], &mut [f64])) {
        let (dofs, _) = self.dofs.as_chunks::<N>();
        for ((&row, &list), dofs) in self.row.iter().zip(&self.list).zip(dofs) {
            let list = &lists[list as usize..][..N];
            let mut sum = 0.0;
            (0..N).for_each(|t| sum += list[t] * u(dofs[t]));
            c[row as usize] = sum - rhs[row as usize];
        }
    }

    fn any(&self, lists: &[f64], u: impl Fn(I) -> f64, (rhs, c): (&[f64], &mut [f64])) {
        for (i, (&row, &list)) in self.row.iter().zip(&self.list).enumerate() {
            let list = &lists[list as usize..][..self.terms];
            let dofs = &self.dofs[i * self.terms..(i + 1) * self.terms];
            let sum: f64 = dofs.iter().zip(list).map(|(&j, v)| v * u(j)).sum();
            c[row as usize] = sum - rhs[row as usize];
        }
    }
}

/// The cache has `2^BITS` slots.
const BITS: u32 = 12;
/// An empty slot.
const NONE: u32 = u32::MAX;

/// Finds repeated coefficient lists: for each hash, where the last list with it starts among the numbers of one batch.
///
/// Lists are compared bit by bit. Constant time and memory per list; nearly all repetitions are found.
#[derive(Default)]
pub struct CoefficientCache {
    /// Identity of the list of numbers.
    list: Identity,
    places: Vec<u32>,
    /// Start of the list returned last: most consecutive equations share it.
    last: usize,
}

impl CoefficientCache {
    /// The start of a list in `numbers`, to which it is appended unless the cache finds it; `list_id` identifies `numbers`.
    pub fn put(&mut self, list_id: Identity, numbers: &mut Vec<f64>, list: impl Iterator<Item = f64> + Clone) -> u32 {
        if self.list != list_id || self.places.is_empty() {
            self.list = list_id;
            self.places.clear();
            self.places.resize(1 << BITS, NONE);
        } else if starts_with(&numbers[self.last..], list.clone()) {
            return self.last as u32;
        }
        let key =
            list.clone().fold(0_u64, |key, v| (key.rotate_left(5) ^ v.to_bits()).wrapping_mul(0x9E37_79B9_7F4A_7C15));
        // The hash of small whole numbers ends with zero bits, so its leading bits select the slot.
        let recent = &mut self.places[(key >> (u64::BITS - BITS)) as usize];
        let known = *recent != NONE && starts_with(&numbers[*recent as usize..], list.clone());
        if !known {
            *recent = numbers.len() as u32;
            numbers.extend(list);
        }
        self.last = *recent as usize;
        *recent
    }
}

fn starts_with(numbers: &[f64], mut list: impl Iterator<Item = f64>) -> bool {
    let mut numbers = numbers.iter();
    list.all(|v| numbers.next().is_some_and(|n| n.to_bits() == v.to_bits()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_that_repeat_are_there_once() {
        let (mut recent, of, mut numbers) = (CoefficientCache::default(), Identity::new(), Vec::new());
        let all = [[1.0, -1.0], [1.0, 2.0], [1.0, -1.0], [0.0, 0.0], [-0.0, 0.0]];
        let places: Vec<_> = all.iter().map(|list| recent.put(of, &mut numbers, list.iter().copied())).collect();
        assert_eq!(places[0], places[2]);
        assert_eq!(numbers.len(), 8);
        for (place, list) in places.iter().zip(&all) {
            let found = &numbers[*place as usize..][..2];
            assert!(found.iter().zip(list).all(|(a, b)| a.to_bits() == b.to_bits()));
        }
        // Another batch does not share the lists of this one.
        let mut others = Vec::new();
        assert_eq!(recent.put(Identity::new(), &mut others, [1.0, 2.0].into_iter()), 0);
        assert_eq!(others, [1.0, 2.0]);
    }
}

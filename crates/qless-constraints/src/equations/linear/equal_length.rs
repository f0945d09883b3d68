//! Equations of one length: changes of them, and the loop over them.
//! Lists of numbers, one after the other; one that was put in lately is not put in again.
//!
//! A small table of the last lists finds nearly all that repeat, in constant time and memory per list.

use qless::common::Identity;

/// The equations of one length.
pub struct EqualLengthRows<I> {
    pub terms: usize,
    /// Places in the batch, ascending.
    pub row: Vec<u16>,
    /// Where the list of each starts.
    pub list: Vec<u32>,
    /// DOFs less the base of the batch, one row after the other.
    pub dofs: Vec<I>,
}

/// Terms of an equation for many of which room is made before they come.
const SHORT: usize = 16;

/// A DOF less the base of a batch, in 16 or 32 bits.
pub trait DofOffset: Copy {
    fn of(offset: u32) -> Self;
    fn value(self) -> u32;
}

impl DofOffset for u16 {
    fn of(offset: u32) -> Self {
        offset as Self
    }
    fn value(self) -> u32 {
        self.into()
    }
}

impl DofOffset for u32 {
    fn of(offset: u32) -> Self {
        offset
    }
    fn value(self) -> u32 {
        self
    }
}

impl<I: DofOffset> EqualLengthRows<I> {
    /// Rows from `row` on follow so much later.
    pub fn shift(&mut self, row: usize, by: u16) {
        self.row.iter_mut().for_each(|r| *r += if usize::from(*r) >= row { by } else { 0 });
    }

    /// Puts in an equation whose row is free.
    pub fn insert(&mut self, row: usize, list: u32, dofs: impl Iterator<Item = u32>) {
        let behind = self.row.last().is_none_or(|&last| usize::from(last) < row);
        let place = if behind { self.row.len() } else { self.row.partition_point(|&r| usize::from(r) < row) };
        self.row.insert(place, row as u16);
        self.list.insert(place, list);
        let first = place * self.terms;
        if first == self.dofs.len() {
            self.dofs.extend(dofs.map(I::of));
        } else {
            self.dofs.splice(first..first, dofs.map(I::of));
        }
    }

    /// Takes an equation out if it is one of these; those after it move up.
    pub fn remove(&mut self, row: usize) {
        if let Ok(place) = self.row.binary_search(&(row as u16)) {
            self.row.remove(place);
            self.list.remove(place);
            self.dofs.drain(place * self.terms..(place + 1) * self.terms);
        }
        self.row.iter_mut().for_each(|r| *r -= u16::from(usize::from(*r) > row));
    }

    /// DOFs and coefficients of one of them.
    pub fn terms<'a>(&'a self, place: usize, base: u32, lists: &'a [f64]) -> impl Iterator<Item = (u32, f64)> + 'a {
        let dofs = &self.dofs[place * self.terms..(place + 1) * self.terms];
        dofs.iter().zip(&lists[self.list[place] as usize..]).map(move |(&j, &v)| (base + j.value(), v))
    }
}

impl<I: DofOffset> EqualLengthRows<I> {
    /// Writes columns and coefficients of the rows of these, which end where `end` says.
    pub fn write_rows(&self, (base, lists): (u32, &[f64]), end: &[usize], col: &mut [u32], val: &mut [f64]) {
        for (i, (&row, &list)) in self.row.iter().zip(&self.list).enumerate() {
            let last = end[usize::from(row)];
            let dofs = &self.dofs[i * self.terms..(i + 1) * self.terms];
            col[last - self.terms..last].iter_mut().zip(dofs).for_each(|(col, dof)| *col = base + dof.value());
            val[last - self.terms..last].copy_from_slice(&lists[list as usize..][..self.terms]);
        }
    }

    /// Room for rows up to so many, if they are short.
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

/// The table has `2^BITS` places.
const BITS: u32 = 12;
/// No list yet.
const NONE: u32 = u32::MAX;

/// Where the last list with each key starts, in the numbers of one batch.
#[derive(Default)]
pub struct CoefficientCache {
    of: Identity,
    places: Vec<u32>,
    /// The list that was asked for last: most equations of a kind have the same.
    last: usize,
}

impl CoefficientCache {
    /// Where the list stands, bit by bit, among the numbers of the batch that has this stamp.
    pub fn put(&mut self, of: Identity, numbers: &mut Vec<f64>, list: impl Iterator<Item = f64> + Clone) -> u32 {
        if self.of != of || self.places.is_empty() {
            self.of = of;
            self.places.clear();
            self.places.resize(1 << BITS, NONE);
        } else if starts_with(&numbers[self.last..], list.clone()) {
            return self.last as u32;
        }
        let key =
            list.clone().fold(0_u64, |key, v| (key.rotate_left(5) ^ v.to_bits()).wrapping_mul(0x9E37_79B9_7F4A_7C15));
        // The product of small whole numbers ends with zeros: its first bits tell lists apart.
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
        // The numbers of another batch know nothing of them.
        let mut others = Vec::new();
        assert_eq!(recent.put(Identity::new(), &mut others, [1.0, 2.0].into_iter()), 0);
        assert_eq!(others, [1.0, 2.0]);
    }
}

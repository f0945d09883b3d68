//! Lists of numbers, one after the other; one that was put in lately is not put in again.
//!
//! A small table of the last lists finds nearly all that repeat, in constant time and memory per list.

use qless::common::Identity;

/// The table has `2^BITS` places.
const BITS: u32 = 12;
/// No list yet.
const NONE: u32 = u32::MAX;

/// Where the last list with each key starts, in the numbers of one batch.
#[derive(Default)]
pub struct Recent {
    of: Identity,
    places: Vec<u32>,
    /// The list that was asked for last: most equations of a kind have the same.
    last: usize,
}

impl Recent {
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
        let (mut recent, of, mut numbers) = (Recent::default(), Identity::new(), Vec::new());
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

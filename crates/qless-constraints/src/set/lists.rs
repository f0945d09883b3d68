//! Lists of numbers, one after the other; one that was put in lately is not put in again.
//!
//! A small table of the last lists finds nearly all that repeat, in constant time and memory per list.

/// The table has `2^BITS` places.
const BITS: u32 = 12;
/// No list yet.
const NONE: u32 = u32::MAX;

/// The numbers, and what was put in lately.
pub struct Lists {
    numbers: Vec<f64>,
    /// Where the last list with this key starts.
    recent: Vec<u32>,
}

impl Default for Lists {
    fn default() -> Self {
        Self { numbers: Vec::new(), recent: vec![NONE; 1 << BITS] }
    }
}

impl Lists {
    /// Where the list stands, bit by bit.
    pub fn put(&mut self, list: impl Iterator<Item = f64> + Clone) -> u32 {
        let key =
            list.clone().fold(0_u64, |key, v| (key.rotate_left(5) ^ v.to_bits()).wrapping_mul(0x9E37_79B9_7F4A_7C15));
        // The product of small whole numbers ends with zeros: its first bits tell lists apart.
        let recent = &mut self.recent[(key >> (u64::BITS - BITS)) as usize];
        if *recent != NONE && starts_with(&self.numbers[*recent as usize..], list.clone()) {
            return *recent;
        }
        *recent = self.numbers.len() as u32;
        self.numbers.extend(list);
        *recent
    }

    /// The numbers, when all lists are in.
    pub fn numbers(self) -> Vec<f64> {
        self.numbers
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
        let mut lists = Lists::default();
        let all = [[1.0, -1.0], [1.0, 2.0], [1.0, -1.0], [0.0, 0.0], [-0.0, 0.0]];
        let places: Vec<_> = all.iter().map(|list| lists.put(list.iter().copied())).collect();
        assert_eq!(places[0], places[2]);
        let numbers = lists.numbers();
        assert_eq!(numbers.len(), 8);
        for (place, list) in places.iter().zip(&all) {
            let found = &numbers[*place as usize..][..2];
            assert!(found.iter().zip(list).all(|(a, b)| a.to_bits() == b.to_bits()));
        }
    }
}

//! Sorts short lists, of which many have the order of the one before: rows of H that belong to the directions of one node.

/// Longer lists are sorted as such.
const SHORT: usize = 16;

/// How many keys of the last short list were smaller than each of them.
#[derive(Default)]
pub(super) struct Ranks {
    of: Vec<u8>,
    sorted: Vec<u64>,
}

impl Ranks {
    /// Sorts keys that all differ.
    pub fn sort(&mut self, keys: &mut [u64]) {
        if keys.len() > SHORT {
            return keys.sort_unstable();
        }
        let alike = self.of.len() == keys.len() && self.place(keys);
        if !alike {
            self.of.clear();
            self.of.extend(keys.iter().map(|key| keys.iter().map(|other| u8::from(other < key)).sum::<u8>()));
            self.place(keys);
        }
        keys.copy_from_slice(&self.sorted);
    }

    /// Puts each key in the place of its rank; whether they ascend then.
    fn place(&mut self, keys: &[u64]) -> bool {
        self.sorted.clear();
        self.sorted.resize(keys.len(), 0);
        self.of.iter().zip(keys).for_each(|(&rank, &key)| self.sorted[usize::from(rank)] = key);
        self.sorted.is_sorted()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lists of all lengths, many of them shifted copies of the one before.
    #[test]
    fn sorted_lists_are_those_of_the_library() {
        let (mut ranks, mut state) = (Ranks::default(), 1_u64);
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            state >> 33
        };
        let mut list: Vec<u64> = Vec::new();
        for k in 0..3000_u64 {
            if k % 3 == 0 {
                list = (0..next() % 20).map(|place| (next() % 1000) << 8 | place).collect();
            }
            let shifted: Vec<u64> = list.iter().map(|key| key + (k << 32)).collect();
            let (mut found, mut expected) = (shifted.clone(), shifted);
            ranks.sort(&mut found);
            expected.sort_unstable();
            assert_eq!(found, expected);
        }
    }
}

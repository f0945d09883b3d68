//! Sorts short lists that often have the same order as the list before.
//!
//! Examples are the rows of H for the directions of one node, or for nodes that are connected alike. Keys are `(column, number)`; the
//! keys of one column form a run.

/// Longer lists are sorted without reuse of the last order.
const SHORT: usize = 16;

/// The order of the last list.
#[derive(Default)]
pub struct KeySorter {
    /// Rank of each unsorted key; empty if the list was long.
    ranks: Vec<u8>,
    unsorted: [u64; SHORT],
    sorted: [u64; SHORT],
    /// Whether each sorted key starts a run.
    new: [bool; SHORT],
    /// Number of keys of each column.
    runs: Vec<u32>,
}

impl KeySorter {
    /// Sorts distinct keys. Returns the number of keys of each column.
    pub fn sort(&mut self, keys: &mut [u64]) -> &[u32] {
        if keys.is_empty() {
            return &[];
        }
        if keys.len() > SHORT {
            self.ranks.clear();
            keys.sort_unstable();
            self.find_runs(keys);
            return &self.runs;
        }
        if self.ranks.len() == keys.len() && self.shift(keys) {
            return &self.runs;
        }
        let alike = self.ranks.len() == keys.len() && self.place(keys);
        if !alike {
            self.ranks.clear();
            self.ranks.extend(keys.iter().map(|key| keys.iter().map(|other| u8::from(other < key)).sum::<u8>()));
            self.place(keys);
        }
        self.unsorted[..keys.len()].copy_from_slice(keys);
        keys.copy_from_slice(&self.sorted[..keys.len()]);
        if !alike || !self.has_runs(keys) {
            self.find_runs(keys);
        }
        &self.runs
    }

    /// Handles keys that are those of the last list with all columns shifted equally; returns whether they are.
    fn shift(&mut self, keys: &mut [u64]) -> bool {
        let step = keys[0].wrapping_sub(self.unsorted[0]);
        let shifted = |(key, last): (&u64, &u64)| key.wrapping_sub(*last) == step;
        if step as u32 != 0 || !keys.iter().zip(&self.unsorted).all(shifted) {
            return false;
        }
        self.unsorted[..keys.len()].copy_from_slice(keys);
        keys.iter_mut().zip(&mut self.sorted).for_each(|(key, sorted)| {
            *sorted = sorted.wrapping_add(step);
            *key = *sorted;
        });
        true
    }

    /// Arranges the keys by the ranks of the last list; returns whether they ascend then.
    fn place(&mut self, keys: &[u64]) -> bool {
        self.ranks.iter().zip(keys).for_each(|(&rank, &key)| self.sorted[usize::from(rank) % SHORT] = key);
        let sorted = &self.sorted[..keys.len()];
        sorted.windows(2).filter(|two| two[0] >= two[1]).count() == 0
    }

    /// Whether the runs are those of the last list, which has the same length.
    fn has_runs(&self, keys: &[u64]) -> bool {
        keys.windows(2).zip(&self.new[1..]).fold(true, |same, (two, &new)| same & (starts_run(two) == new))
    }

    fn find_runs(&mut self, keys: &[u64]) {
        keys.windows(2).zip(&mut self.new[1..]).for_each(|(two, new)| *new = starts_run(two));
        self.runs.clear();
        self.runs.extend(keys.chunk_by(|a, b| a >> 32 == b >> 32).map(|run| run.len() as u32));
    }
}

/// Whether the second key has another column than the first.
fn starts_run(two: &[u64]) -> bool {
    two[0] >> 32 != two[1] >> 32
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lists of all lengths, many of them shifted copies of the list before.
    #[test]
    fn sorted_lists_are_those_of_the_library() {
        let (mut ranks, mut state) = (KeySorter::default(), 1_u64);
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            state >> 33
        };
        let mut list: Vec<u64> = Vec::new();
        for k in 0..3000_u64 {
            if k % 3 == 0 {
                list = (0..next() % 20).map(|place| (next() % 1000) << 8 | place).collect();
            }
            // The order stays, but keys of one column may fall into different columns.
            let apart = if k % 7 == 0 { 24 } else { 20 };
            let shifted: Vec<u64> = list.iter().map(|key| (key << apart) + (k << 32)).collect();
            let (mut found, mut expected) = (shifted.clone(), shifted);
            let runs = ranks.sort(&mut found).to_vec();
            expected.sort_unstable();
            assert_eq!(found, expected);
            let of_columns = expected.chunk_by(|a, b| a >> 32 == b >> 32).map(|run| run.len() as u32);
            assert!(of_columns.eq(runs), "list {k}");
        }
    }
}

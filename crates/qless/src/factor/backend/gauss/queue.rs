//! The waiting rows by length; among rows of the same length, the one whose length changed last comes first.

use super::ledger::Ledger;
use crate::factor::backend::BackendError;

const NONE: u32 = u32::MAX;

/// One list of rows for each length, linked both ways; every change takes O(1).
pub(super) struct Queue {
    /// The first row of each length; the last list has the rows that wait behind all others.
    head: Vec<u32>,
    next: Vec<u32>,
    previous: Vec<u32>,
    /// Length of each row; [`NONE`] if the row does not wait.
    length: Vec<u32>,
    /// No waiting row is shorter than this.
    least: usize,
}

impl Queue {
    /// A queue for rows `0..rows` of at most `longest` entries; none of them waits yet.
    pub fn new(rows: usize, longest: usize, ledger: &mut Ledger) -> Result<Self, BackendError> {
        Ok(Self {
            head: ledger.filled(NONE, longest + 2)?,
            next: ledger.filled(NONE, rows)?,
            previous: ledger.filled(NONE, rows)?,
            length: ledger.filled(NONE, rows)?,
            least: longest + 2,
        })
    }

    pub fn waits(&self, row: u32) -> bool {
        self.length[row as usize] != NONE
    }

    /// Among the shortest waiting rows, the one whose length changed last.
    pub fn first(&mut self) -> Option<u32> {
        while self.least < self.head.len() && self.head[self.least] == NONE {
            self.least += 1;
        }
        self.head.get(self.least).copied()
    }

    /// Puts the row at the head of the list of waiting rows with this length.
    pub fn set(&mut self, row: u32, length: usize) {
        if self.length[row as usize] == length as u32 {
            return;
        }
        self.remove(row);
        let head = std::mem::replace(&mut self.head[length], row);
        if head != NONE {
            self.previous[head as usize] = row;
        }
        self.next[row as usize] = head;
        self.length[row as usize] = length as u32;
        self.least = self.least.min(length);
    }

    /// Makes the row wait behind all others until its length is set again.
    pub fn set_last(&mut self, row: u32) {
        self.set(row, self.head.len() - 1);
    }

    pub fn is_last(&self, row: u32) -> bool {
        self.length[row as usize] as usize == self.head.len() - 1
    }

    /// Removes the row from the queue, if it waits.
    pub fn remove(&mut self, row: u32) {
        if !self.waits(row) {
            return;
        }
        let take = |list: &mut [u32]| std::mem::replace(&mut list[row as usize], NONE);
        let (next, previous, length) = (take(&mut self.next), take(&mut self.previous), take(&mut self.length));
        if next != NONE {
            self.previous[next as usize] = previous;
        }
        if previous == NONE {
            self.head[length as usize] = next;
        } else {
            self.next[previous as usize] = next;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Csr;
    use crate::factor::backend::check::Random;

    #[test]
    fn the_first_row_is_always_a_shortest() {
        let mut random = Random(7);
        let mut queue = Queue::new(40, 9, &mut Ledger::new(&Csr::empty(0), usize::MAX)).expect("small");
        let mut lengths = [None; 40];
        for _ in 0..4000 {
            let row = random.below(40);
            lengths[row] = (random.below(3) > 0).then(|| random.below(11));
            match lengths[row] {
                Some(10) => queue.set_last(row as u32),
                Some(length) => queue.set(row as u32, length),
                None => queue.remove(row as u32),
            }
            assert_eq!(
                (queue.waits(row as u32), queue.is_last(row as u32)),
                (lengths[row].is_some(), lengths[row] == Some(10))
            );
            let first = queue.first().map(|row| lengths[row as usize].expect("it waits"));
            assert_eq!(first, lengths.iter().flatten().min().copied());
        }
    }
}

//! Equations by where they stand, in little memory.

use super::parts::Origin;

/// Equations from `first` on that follow each other evenly: equation `first + k` is that of `origin`, `k stride` lines and
/// `k cards` cards further on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Run {
    pub first: u32,
    pub origin: Origin,
    pub stride: u32,
    pub cards: u32,
}

impl Run {
    /// Where equation `i` stands.
    pub fn at(&self, i: usize) -> Origin {
        let further = |from: u32, stride: u32| from.wrapping_add((i as u32 - self.first).wrapping_mul(stride));
        let Origin { card, line, lines } = self.origin;
        Origin { card: further(card, self.cards), line: further(line, self.stride), lines }
    }

    /// Takes equation `i` in, if it follows; the second one sets the strides.
    pub fn take(&mut self, i: usize, origin: Origin) -> bool {
        if self.first + 1 == i as u32 {
            self.stride = origin.line.wrapping_sub(self.origin.line);
            self.cards = origin.card.wrapping_sub(self.origin.card);
        }
        self.at(i) == origin
    }
}

#[derive(Clone, Debug, Default)]
pub(super) struct Terms {
    pub columns: Vec<u32>,
    pub coefficients: Vec<f64>,
}

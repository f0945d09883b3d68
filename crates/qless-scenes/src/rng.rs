//! Pseudo-random numbers by SplitMix64 (Steele, Lea, Flood 2014), the same on every machine.

use qless::common::SplitMix64;

use crate::SceneError;
use crate::error::{MOST, within};

/// A stream of pseudo-random numbers; the seed determines the stream.
///
/// ```
/// use qless_scenes::Rng;
/// assert_eq!(Rng::new(0).bits(), 0xe220_a839_7b1d_cdaf);
/// assert!(Rng::new(7).below(3) < 3);
/// ```
#[derive(Clone, Debug)]
pub struct Rng(SplitMix64);

impl Rng {
    /// The stream of a seed.
    pub fn new(seed: u64) -> Self {
        Self(SplitMix64::new(seed))
    }

    /// 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.0.next()
    }

    /// A whole number in `0..n`; 0 for n = 0.
    pub fn below(&mut self, n: usize) -> usize {
        ((u128::from(self.bits()) * n as u128) >> 64) as usize
    }

    /// A nonzero whole number in `-most..=most`; a `most` of 0 counts as 1.
    pub fn coefficient(&mut self, most: usize) -> f64 {
        let size = 1 + self.below(most.max(1));
        if self.bits() >> 63 == 0 { size as f64 } else { -(size as f64) }
    }

    /// A nonzero multiple of 2^-52 in `-1 <= x < 1`.
    pub fn real(&mut self) -> f64 {
        loop {
            let x = (self.bits() >> 11) as f64 / (1_u64 << 52) as f64 - 1.0;
            if x != 0.0 {
                return x;
            }
        }
    }

    /// Fisher-Yates shuffle.
    pub fn shuffle<T>(&mut self, items: &mut [T]) {
        for last in (1..items.len()).rev() {
            items.swap(last, self.below(last + 1));
        }
    }

    /// The numbers `0..n` in random order.
    ///
    /// # Errors
    /// [`SceneError::Size`] for more than 2^27 of them.
    pub fn permutation(&mut self, n: usize) -> Result<Vec<usize>, SceneError> {
        within("n", n, 0, MOST)?;
        Ok(self.shuffled(n))
    }

    /// [`Rng::permutation`] without the limit.
    pub(crate) fn shuffled(&mut self, n: usize) -> Vec<usize> {
        let mut order: Vec<usize> = (0..n).collect();
        self.shuffle(&mut order);
        order
    }

    /// `count` different numbers of `0..n`, in the order drawn; all of them if `count > n`. O(count^2).
    ///
    /// # Errors
    /// [`SceneError::Size`] for more than 2^16 of them.
    pub fn distinct(&mut self, count: usize, n: usize) -> Result<Vec<usize>, SceneError> {
        within("count", count.min(n), 0, 1 << 16)?;
        Ok(self.drawn(count, n))
    }

    /// As [`Rng::distinct`], but for any count.
    pub(crate) fn drawn(&mut self, count: usize, n: usize) -> Vec<usize> {
        let mut drawn = Vec::with_capacity(count.min(n));
        while drawn.len() < count.min(n) {
            let candidate = self.below(n);
            if !drawn.contains(&candidate) {
                drawn.push(candidate);
            }
        }
        drawn
    }
}

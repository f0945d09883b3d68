//! Random numbers that are the same in every run.

/// Numbers in `[0.5, 1.5)` that depend on the seed only. Number k is a mix of the bits of k, so it does not depend on number k - 1.
pub(crate) fn randoms(seed: u64) -> impl Iterator<Item = f64> {
    (0..).map(move |k| unit(bits(seed, k)))
}

/// Number k of a seed, with a random sign and a magnitude in `[0.5, 1.5)`.
#[inline]
pub(crate) fn signed(seed: u64, k: u64) -> f64 {
    let bits = bits(seed, k);
    // Bit 0 becomes the sign bit: a branch on a random sign would be unpredictable.
    f64::from_bits(unit(bits).to_bits() | (bits & 1) << 63)
}

#[inline]
fn unit(bits: u64) -> f64 {
    0.5 + (bits >> 11) as f64 / (1_u64 << 53) as f64
}

#[inline]
fn bits(seed: u64, k: u64) -> u64 {
    let first = seed.wrapping_mul(0x5851_f42d_4c95_7f2d);
    let x = (k + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(first);
    let x = (x ^ (x >> 32)).wrapping_mul(0xd6e8_feb8_6659_fd93);
    x ^ (x >> 32)
}

/// SplitMix64 (Steele, Lea, Flood 2014): a stream of 64-bit numbers, the same for the same seed on every machine.
///
/// ```
/// use qless::common::SplitMix64;
/// assert_eq!(SplitMix64::new(0).next(), 0xe220_a839_7b1d_cdaf);
/// ```
#[derive(Clone, Debug)]
pub struct SplitMix64(u64);

impl SplitMix64 {
    const STEP: u64 = 0x9e37_79b9_7f4a_7c15;

    /// The stream of a seed.
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// The next 64 random bits.
    #[expect(clippy::should_implement_trait, reason = "a stream without an end needs no Option")]
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(Self::STEP);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }
}

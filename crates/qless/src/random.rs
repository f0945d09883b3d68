//! Random numbers that are the same in every run.

/// Numbers in `[0.5, 1.5)`, the same for the same seed: a counter, its bits mixed, so that none waits for the one before.
pub(crate) fn randoms(seed: u64) -> impl Iterator<Item = f64> {
    let first = seed.wrapping_mul(0x5851_f42d_4c95_7f2d);
    (1_u64..).map(move |k| {
        let x = k.wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(first);
        let x = (x ^ (x >> 32)).wrapping_mul(0xd6e8_feb8_6659_fd93);
        0.5 + ((x ^ (x >> 32)) >> 11) as f64 / (1_u64 << 53) as f64
    })
}

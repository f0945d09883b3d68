//! Powers of two that put numbers around one.

/// The power half way between the smallest and the largest number that is not zero; 0 without any.
pub fn middle(values: impl Iterator<Item = f64>) -> i32 {
    let powers = values.filter(|v| *v != 0.0).map(power);
    let ends = powers.fold(None, |ends: Option<(i32, i32)>, e| match ends {
        None => Some((e, e)),
        Some((least, most)) => Some((least.min(e), most.max(e))),
    });
    ends.map_or(0, |(least, most)| (least + most).div_euclid(2))
}

/// e of `2^e <= |v| < 2^(e + 1)`, up to one where log2 rounds; 0 for zero.
pub fn power(v: f64) -> i32 {
    if v == 0.0 { 0 } else { v.abs().log2().floor() as i32 }
}

/// `v 2^e`, in two steps: 2^e alone may leave the range of doubles.
pub fn times_power(v: f64, e: i32) -> f64 {
    let half = e.div_euclid(2);
    v * f64::from(half).exp2() * f64::from(e - half).exp2()
}

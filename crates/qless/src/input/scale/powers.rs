//! Powers of two.

/// `x 2^k`, exact unless the result leaves the range of doubles.
pub(crate) fn ldexp(x: f64, k: i32) -> f64 {
    let power = |k: i32| f64::from_bits(((k + 1023) as u64) << 52);
    match k {
        -1022..=1023 => x * power(k),
        1024.. => ldexp(x * power(1023), (k - 1023).min(2000)),
        _ => ldexp(x * power(-1022), (k + 1022).max(-2000)),
    }
}

/// `floor(log2 |x|)` for a finite x that is not zero.
pub(crate) fn exponent(x: f64) -> i32 {
    let biased = ((x.to_bits() >> 52) & 0x7ff) as i32;
    if biased == 0 { exponent(x * 2f64.powi(64)) - 64 } else { biased - 1023 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_of_two_are_exact_over_the_whole_range() {
        assert_eq!(ldexp(3.0, 4), 48.0);
        assert_eq!(ldexp(f64::MIN_POSITIVE, 2000), f64::MIN_POSITIVE * 2f64.powi(1000) * 2f64.powi(1000));
        assert_eq!(ldexp(1.5, -1060), 1.5 * 2f64.powi(-1000) * 2f64.powi(-60));
        assert_eq!((exponent(1.0), exponent(-7.9), exponent(0.25), exponent(5e-324)), (0, 2, -2, -1074));
    }
}

//! `Z / p` with `p = 2^61 - C`: whole numbers modulo a prime of 61 bits, C = 1 or 31.

/// Arithmetic on residues `0..p`.
pub(super) trait Field {
    /// The residue of a finite double.
    fn of(value: f64) -> u64;
    /// a + b.
    fn add(a: u64, b: u64) -> u64;
    /// a b.
    fn mul(a: u64, b: u64) -> u64;
    /// -a.
    fn negative(a: u64) -> u64;
    /// 1 / a for a != 0.
    fn inverse(a: u64) -> u64;
}

/// Residues modulo `2^61 - C`, which is prime for C = 1 and C = 31.
pub(super) struct Mod61<const C: u64>;

impl<const C: u64> Mod61<C> {
    const P: u64 = (1 << 61) - C;

    /// x mod p by `2^61 = C`, for x below 2^122.
    fn reduce(x: u128) -> u64 {
        let fold = |x: u128| (x & ((1 << 61) - 1)) + (x >> 61) * u128::from(C);
        let folded = fold(fold(x)) as u64;
        if folded >= Self::P { folded - Self::P } else { folded }
    }

    fn power(mut base: u64, mut exponent: u64) -> u64 {
        let mut result = 1;
        while exponent > 0 {
            if exponent & 1 == 1 {
                result = Self::mul(result, base);
            }
            base = Self::mul(base, base);
            exponent >>= 1;
        }
        result
    }
}

impl<const C: u64> Field for Mod61<C> {
    fn of(value: f64) -> u64 {
        assert!(value.is_finite(), "the oracle needs finite numbers, found {value}");
        let bits = value.to_bits();
        let biased = (bits >> 52) & 0x7ff;
        let fraction = bits & ((1 << 52) - 1);
        // value = mantissa 2^(shift - 1074); subnormal numbers have no hidden bit.
        let (mantissa, shift) = if biased == 0 { (fraction, 0) } else { (fraction | 1 << 52, biased - 1) };
        let half = Self::P.div_ceil(2);
        let scale = Self::mul(Self::power(2, shift), Self::power(half, 1074));
        let size = Self::mul(mantissa, scale);
        if value < 0.0 { Self::negative(size) } else { size }
    }

    fn add(a: u64, b: u64) -> u64 {
        Self::reduce(u128::from(a) + u128::from(b))
    }

    fn mul(a: u64, b: u64) -> u64 {
        Self::reduce(u128::from(a) * u128::from(b))
    }

    fn negative(a: u64) -> u64 {
        if a == 0 { 0 } else { Self::P - a }
    }

    fn inverse(a: u64) -> u64 {
        Self::power(a, Self::P - 2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn laws<F: Field>() {
        for value in [1.0, -3.5, 0.1, 1e300, 5e-324, 12_345.678] {
            let a = F::of(value);
            assert_eq!(F::mul(a, F::inverse(a)), 1);
            assert_eq!(F::add(a, F::of(-value)), 0);
        }
        assert_eq!(F::of(0.75), F::add(F::of(0.5), F::of(0.25)));
        assert_eq!(F::of(1e20), F::mul(F::of(1e10), F::of(1e10)));
        assert_ne!(F::of(0.3), F::add(F::of(0.1), F::of(0.2)));
    }

    #[test]
    fn doubles_map_to_both_fields_exactly() {
        laws::<Mod61<1>>();
        laws::<Mod61<31>>();
    }
}

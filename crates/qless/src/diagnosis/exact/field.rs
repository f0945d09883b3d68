//! `Z / p`: integers modulo a prime below 2^62, stored as `a 2^64 mod p` (Montgomery 1985), so that multiplication needs no division.

use crate::input::reading::Number;

/// Arithmetic on residues modulo p. Zero is stored as 0; other stored values have a meaning only within this type.
#[derive(Clone, Copy, Debug)]
pub(in crate::diagnosis) struct Field {
    p: u64,
    /// The constant `-1 / p mod 2^64` of Montgomery's multiplication.
    inverse: u64,
    /// The constant `2^128 mod p`, which converts numbers to stored residues.
    square: u64,
    /// The residue of 1/2. The next field is that of 1/10.
    half: u64,
    tenth: u64,
}

impl Field {
    /// The residues modulo an odd p below 2^62. Inverses need a prime; all else holds for every odd p.
    pub(in crate::diagnosis) fn new(p: u64) -> Self {
        debug_assert!(p % 2 == 1 && p < 1 << 62);
        // Newton's step doubles the number of correct bits: 3, 6, 12, 24, 48, 96.
        let inverse = (0..5).fold(p, |x, _| x.wrapping_mul(2_u64.wrapping_sub(p.wrapping_mul(x))));
        let square = ((u128::MAX % u128::from(p)) as u64 + 1) % p;
        let mut field = Self { p, inverse: inverse.wrapping_neg(), square, half: 0, tenth: 0 };
        (field.half, field.tenth) = (field.inverse(field.of(2)), field.inverse(field.of(10)));
        field
    }

    /// The residue of a whole number.
    pub(in crate::diagnosis) fn of(&self, number: u64) -> u64 {
        self.mul(number, self.square)
    }

    /// The residue of `± digits base^exponent`.
    pub(in crate::diagnosis) fn residue(&self, number: Number) -> u64 {
        let base = match (number.decimal, number.exponent < 0) {
            (true, true) => self.tenth,
            (true, false) => self.of(10),
            (false, true) => self.half,
            (false, false) => self.of(2),
        };
        let digits = self.of(number.digits);
        let times = u64::from(number.exponent.unsigned_abs());
        let size = if times == 0 { digits } else { self.mul(digits, self.power(base, times)) };
        if number.negative { self.negative(size) } else { size }
    }

    /// The sum a + b.
    pub(in crate::diagnosis) fn add(&self, a: u64, b: u64) -> u64 {
        self.below(a + b)
    }

    /// The difference a - b.
    pub(in crate::diagnosis) fn sub(&self, a: u64, b: u64) -> u64 {
        self.below(a + self.p - b)
    }

    /// The negative -a.
    pub(in crate::diagnosis) fn negative(&self, a: u64) -> u64 {
        self.sub(0, a)
    }

    /// The product a b.
    pub(in crate::diagnosis) fn mul(&self, a: u64, b: u64) -> u64 {
        let product = u128::from(a) * u128::from(b);
        let multiple = (product as u64).wrapping_mul(self.inverse);
        self.below(((product + u128::from(multiple) * u128::from(self.p)) >> 64) as u64)
    }

    /// The power a^exponent.
    pub(in crate::diagnosis) fn power(&self, mut a: u64, mut exponent: u64) -> u64 {
        let mut result = self.of(1);
        while exponent > 0 {
            if exponent & 1 == 1 {
                result = self.mul(result, a);
            }
            a = self.mul(a, a);
            exponent >>= 1;
        }
        result
    }

    /// The inverse 1 / a for a != 0, by Fermat's theorem.
    pub(in crate::diagnosis) fn inverse(&self, a: u64) -> u64 {
        self.power(a, self.p - 2)
    }

    fn below(&self, a: u64) -> u64 {
        if a >= self.p { a - self.p } else { a }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::common::random::randoms;
    use crate::diagnosis::exact::{Reading, prime};

    fn fields() -> Vec<Field> {
        let drawn = (0..20).flat_map(prime::two);
        drawn.chain([(1 << 61) - 1, (1 << 61) - 31, 11, 13]).map(Field::new).collect()
    }

    /// Random whole numbers of up to 60 bits.
    fn numbers(seed: u64, count: usize) -> Vec<u64> {
        randoms(seed).map(|x| (x * (1_u64 << 60) as f64) as u64).take(count).collect()
    }

    #[test]
    fn sums_and_products_are_those_of_whole_numbers() {
        for field in fields() {
            let p = u128::from(field.p);
            for pair in numbers(field.p, 200).windows(2) {
                let [a, b] = [pair[0], pair[1]].map(|x| field.of(x));
                let [x, y] = [pair[0], pair[1]].map(u128::from);
                let of = |whole: u128| field.of((whole % p) as u64);
                assert_eq!(field.mul(a, b), of(x * y));
                assert_eq!(field.add(a, b), of(x + y));
                assert_eq!(field.sub(a, b), of(x % p + p - y % p));
                assert!([a, b, field.mul(a, b)].iter().all(|&residue| residue < field.p));
            }
        }
    }

    #[test]
    fn the_laws_of_a_field_hold() {
        for field in fields() {
            let (zero, one) = (field.of(0), field.of(1));
            assert_eq!(zero, 0);
            for triple in numbers(field.p ^ 5, 200).windows(3) {
                let [a, b, c] = [triple[0], triple[1], triple[2]].map(|x| field.of(x));
                assert_eq!(field.mul(a, field.add(b, c)), field.add(field.mul(a, b), field.mul(a, c)));
                assert_eq!(field.mul(a, field.mul(b, c)), field.mul(field.mul(a, b), c));
                assert_eq!(field.add(a, field.negative(a)), zero);
                assert_eq!(field.mul(a, one), a);
                assert!(a == zero || field.mul(a, field.inverse(a)) == one);
            }
        }
    }

    #[test]
    fn doubles_keep_their_sums_and_products_in_both_readings() {
        for (field, reading) in
            fields().into_iter().flat_map(|field| [(field, Reading::Typed), (field, Reading::Stored)])
        {
            let of = |value| field.residue(Number::read(value, reading));
            for value in [1.0, -3.5, 0.1, 1e300, 5e-324, 12_345.678, f64::MAX, f64::MIN_POSITIVE] {
                assert_eq!(field.add(of(value), of(-value)), 0);
            }
            assert_eq!(of(0.75), field.add(of(0.5), of(0.25)));
            assert_eq!(of(1e20), field.mul(of(1e10), of(1e10)));
            let is_sum = of(0.3) == field.add(of(0.1), of(0.2));
            assert_eq!(is_sum, reading == Reading::Typed || field.p < 20 && is_sum);
        }
    }
}

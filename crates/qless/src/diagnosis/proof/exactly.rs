//! Verifies certificates in exact arithmetic. A whole number is zero if it is zero modulo primes whose product exceeds its magnitude.

use std::collections::{BTreeSet, HashMap};

use super::number_size::NumberSize;
use super::rational::Rational;
use crate::diagnosis::certificate::CertificateTerm;
use crate::diagnosis::exact::eliminate::eliminate;
use crate::diagnosis::exact::field::Field;
use crate::diagnosis::exact::prime;
use crate::exact::Reading;
use crate::input::numbering::LocalSystem;
use crate::input::reading::Number;

/// The result of verifying a certificate in exact arithmetic.
#[derive(Clone, Copy, Debug)]
pub(super) struct Found {
    /// True if the equation is a combination of the equations of its certificate.
    pub is_combination: bool,
    /// True if the right-hand side of the equation is the same combination of the right-hand sides of the certificate's equations.
    pub sides_agree: bool,
}

/// Bits of a prime above `2^60`.
const BITS: f64 = 60.0;
/// Largest number of primes: numbers of up to 3,840 bits can be verified with 64 of them. The largest double is 2^2098 times the smallest.
const PRIMES: usize = 64;
/// Largest number of rows of a certificate that is verified by ranks. A rank is exact if the product of the primes exceeds every minor of
/// these rows. [`PRIMES`] primes allow about 116 bits for each row. More primes would cost more time, because each needs an elimination.
const ROWS: usize = 32;
/// Largest number of coefficients that the elimination for minors may store.
const FILL: usize = 1 << 20;

/// Different primes whose product exceeds `2^bits`; None if more than [`PRIMES`] are needed.
fn primes(bits: f64) -> Option<&'static [u64]> {
    let count = (bits.max(0.0) / BITS).floor() + 1.0;
    (count <= PRIMES as f64).then(|| &prime::first(PRIMES)[..count as usize])
}

/// The system whose certificates are verified.
pub(super) struct Explanation<'a> {
    system: LocalSystem<'a>,
    reading: Reading,
    prescribed: HashMap<usize, f64>,
}

impl<'a> Explanation<'a> {
    pub fn new(system: LocalSystem<'a>, reading: Reading) -> Self {
        let prescribed = system.prescribed().iter().copied().collect();
        Self { system, reading, prescribed }
    }

    fn read(&self, value: f64) -> Number {
        Number::read(value, self.reading)
    }

    /// Verifies `row_k = sum_i c_i row_i` with fractions near the coefficients; None if there are no such fractions, or if the numbers are
    /// too large for [`PRIMES`].
    pub fn identity(&self, row: usize, terms: &[CertificateTerm]) -> Option<Found> {
        let own =
            Rational { numerator: Number { negative: true, digits: 1, decimal: false, exponent: 0 }, denominator: 1 };
        let mut scaled = vec![(row, -1.0, own)];
        for term in terms {
            scaled.push((term.row, term.coefficient, Rational::near(term.coefficient)?));
        }
        let mut common = 1_u128;
        let (mut factors, mut of_dofs, mut of_sides) = <(NumberSize, NumberSize, NumberSize)>::default();
        for &(i, c, Rational { numerator, denominator }) in &scaled {
            common = least_common_multiple(common, denominator)?;
            factors.add(numerator, 0.0);
            let [dofs, sides] = self.sizes(i, c);
            of_dofs.join(dofs);
            of_sides.join(sides);
        }
        let bits = of_dofs.times(factors).bits().max(of_sides.times(factors).bits()) + (common as f64).log2();
        let mut found = Found { is_combination: true, sides_agree: true };
        for &p in primes(bits)? {
            let field = Field::new(p);
            let (mut sums, mut side) = (HashMap::new(), 0);
            for &(i, _, Rational { numerator, denominator }) in &scaled {
                let c = field.mul(field.residue(numerator), field.inverse(field.of(denominator)));
                let (entries, own) = self.residues(&field, i);
                for (j, v) in entries {
                    let sum = sums.entry(j).or_insert(0);
                    *sum = field.add(*sum, field.mul(c, v));
                }
                side = field.add(side, field.mul(c, own));
            }
            found.is_combination &= sums.values().all(|&sum| sum == 0);
            found.sides_agree &= side == 0;
            if !found.is_combination {
                break;
            }
        }
        Some(found)
    }

    /// Verifies that the row is a combination of the rows of `terms`, by the ranks of all these rows without and with their right-hand
    /// sides. None if the rows are too many or too large, or if the ranks decide nothing about the right-hand sides.
    pub fn minors(&self, row: usize, terms: &[CertificateTerm]) -> Option<Found> {
        if terms.len() > ROWS {
            return None;
        }
        let rows: Vec<usize> = terms.iter().map(|term| term.row).chain([row]).collect();
        let of_row = |&i: &usize| {
            let [mut size, sides] = self.sizes(i, 1.0);
            size.join(sides);
            size.bits()
        };
        // Hadamard: a minor is at most the product of the lengths of its rows.
        let bits: f64 = rows.iter().map(of_row).sum();
        let free = |i: &usize| self.system.row(*i).filter(|&(j, _)| self.system.free()[j]).map(|(j, _)| j);
        let dofs: BTreeSet<usize> = rows.iter().flat_map(free).collect();
        let place: HashMap<usize, u32> = dofs.into_iter().zip(0..).collect();
        let mut found = Found { is_combination: true, sides_agree: true };
        for &p in primes(bits)? {
            let field = Field::new(p);
            let (matrix, sides): (Vec<_>, Vec<_>) = rows.iter().map(|&i| self.residues(&field, i)).unzip();
            let placed = |row: Vec<(usize, u64)>| {
                let mut row: Vec<(u32, u64)> = row.into_iter().map(|(j, v)| (place[&j], v)).collect();
                row.sort_unstable();
                row
            };
            let done = eliminate(field, matrix.into_iter().map(placed).collect(), sides, place.len(), FILL).ok()?;
            found.is_combination &= done.pivots.len() <= terms.len();
            // If the rank modulo a prime is below the number of terms, a contradicting row proves nothing about the right-hand sides.
            if done.pivots.len() != terms.len() && !done.contradicting.is_empty() {
                return None;
            }
            found.sides_agree &= done.contradicting.is_empty();
        }
        Some(found)
    }

    /// Modulo a prime: the coefficients of free DOFs, and the right-hand side `b_i - sum_p row_ip u_p` without prescribed terms.
    fn residues(&self, field: &Field, i: usize) -> (Vec<(usize, u64)>, u64) {
        let residue = |value| field.residue(self.read(value));
        let (mut entries, mut side) = (Vec::with_capacity(self.system.length(i)), residue(self.system.rhs()[i]));
        for (j, v) in self.system.row(i) {
            match self.prescribed.get(&j) {
                Some(&value) => side = field.sub(side, field.mul(residue(v), residue(value))),
                None => entries.push((j, residue(v))),
            }
        }
        (entries, side)
    }

    /// Sizes of the coefficients of free DOFs, and of the terms of the right-hand side, both times c.
    fn sizes(&self, i: usize, c: f64) -> [NumberSize; 2] {
        let (mut of_dofs, mut of_sides) = (NumberSize::default(), NumberSize::default());
        let b = self.system.rhs()[i];
        of_sides.add(self.read(b), c * b);
        for (j, v) in self.system.row(i) {
            match self.prescribed.get(&j) {
                Some(&value) => {
                    let (mut own, mut other) = (NumberSize::default(), NumberSize::default());
                    own.add(self.read(v), c * v * value);
                    other.add(self.read(value), 0.0);
                    of_sides.join(own.times(other));
                }
                None => of_dofs.add(self.read(v), c * v),
            }
        }
        [of_dofs, of_sides]
    }
}

fn least_common_multiple(a: u128, b: u64) -> Option<u128> {
    let (mut x, mut y) = (a, u128::from(b));
    while y > 0 {
        (x, y) = (y, x % y);
    }
    (a / x).checked_mul(u128::from(b))
}

#[cfg(test)]
mod tests {
    use super::least_common_multiple;
    use crate::diagnosis::exact::prime;
    use crate::exact::Reading;
    use crate::{Effort, Kind, Options, SystemBuilder, analyse};

    /// The product of the first `count` primes of the list, as whole numbers below `base` times `1, base, base^2, ...`.
    fn product(count: usize, base: u64) -> Vec<u64> {
        let mut digits = vec![1];
        for prime in prime::first(count) {
            let mut carry = 0;
            for digit in &mut digits {
                carry += u128::from(*digit) * u128::from(*prime);
                *digit = (carry % u128::from(base)) as u64;
                carry /= u128::from(base);
            }
            while carry > 0 {
                digits.push((carry % u128::from(base)) as u64);
                carry /= u128::from(base);
            }
        }
        digits
    }

    /// A ring of DOFs whose differences add up to a product of primes, in any unit: as right-hand sides, or as terms of prescribed DOFs.
    #[test]
    fn a_mismatch_that_is_zero_modulo_many_primes_is_proved_to_be_a_conflict() {
        let readings = [(Reading::Typed, 10_u64, 15), (Reading::Stored, 2, 50)];
        for (count, (numbers, base, width)) in (1..12).flat_map(|count| readings.map(|reading| (count, reading))) {
            let digits = product(count, base.pow(width));
            let n = digits.len();
            let number = |k: usize, power: i32| -> f64 {
                let power = width as i32 * k as i32 + power;
                match numbers {
                    Reading::Typed => format!("{}e{power}", digits[k]).parse().expect("a number"),
                    Reading::Stored => digits[k] as f64 * 2_f64.powi(power),
                }
            };
            for (power, is_prescribed) in [0, -20, -100].into_iter().flat_map(|power| [(power, false), (power, true)]) {
                let mut builder = SystemBuilder::new(2 * n + 1);
                for k in 0..n {
                    let difference = [(k, 1.0), (k + 1, -1.0)];
                    if is_prescribed {
                        builder.equation(difference.into_iter().chain([(n + 1 + k, -(base as f64))]), 0.0);
                        builder.prescribe(n + 1 + k, number(k, power - 1));
                    } else {
                        builder.equation(difference, number(k, power));
                    }
                }
                builder.equation([(0, 1.0), (n, -1.0)], 0.0);
                let options = Options { effort: Effort::Proved, numbers, ..Options::default() };
                let analysis = analyse(&builder.build().expect("valid"), &options).expect("small");
                let (kind, proof) = (analysis.kinds()[n], analysis.proof().expect("asked for"));
                let name = format!("{count} primes, {numbers:?}, power {power}, prescribed: {is_prescribed}");
                assert_eq!((kind, proof.exact, proof.unproved.len()), (Kind::Conflicting, 1, 0), "{name}");
            }
        }
    }

    #[test]
    fn least_common_multiples_are_least() {
        for (a, b) in (1..=60_u64).flat_map(|a| (1..=60_u64).map(move |b| (a, b))) {
            let least = (1..=a * b).find(|multiple| multiple % a == 0 && multiple % b == 0);
            assert_eq!(least_common_multiple(u128::from(a), b), least.map(u128::from), "{a} and {b}");
        }
        assert_eq!(least_common_multiple(u128::MAX, 2), None);
    }
}

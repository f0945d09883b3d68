//! Compares the right-hand sides of a certificate to rounding: `b_k - sum_i c_i b_i - sum_p (row_kp - sum_i c_i row_ip) u_p`.

use super::ROUNDING;
use crate::diagnosis::certificate::CertificateTerm;
use crate::input::noise::{TYPED, digits};
use crate::input::numbering::LocalSystem;

/// Returns true if a coefficient of free DOFs in an explanation was computed: it has more digits than typed numbers have.
pub(super) fn is_computed(local: LocalSystem, row: usize, terms: &[CertificateTerm]) -> bool {
    let of_row = |i: usize| local.row(i).any(|(j, v)| local.free()[j] && digits(v) > *TYPED.end());
    std::iter::once(row).chain(terms.iter().map(|term| term.row)).any(of_row)
}

/// Returns true if a number in the right-hand sides of an explanation was computed.
pub(super) fn has_computed_sides(local: LocalSystem, row: usize, terms: &[CertificateTerm]) -> bool {
    let computed = |v: f64| digits(v) > *TYPED.end();
    let of_row = |i: usize| computed(local.rhs()[i]) || local.row(i).any(|(j, v)| !local.free()[j] && computed(v));
    std::iter::once(row).chain(terms.iter().map(|term| term.row)).any(of_row)
        || local.prescribed().iter().any(|&(_, value)| computed(value))
}

/// True if the right-hand sides agree to rounding, false if they differ by more than any rounding; None if neither is certain.
pub(super) fn sides_agree(local: LocalSystem, row: usize, terms: &[CertificateTerm]) -> Option<bool> {
    let mut value = vec![];
    let prescribed: std::collections::HashMap<usize, f64> = local.prescribed().iter().copied().collect();
    let own = CertificateTerm { row, coefficient: -1.0 };
    for &CertificateTerm { row: i, coefficient } in terms.iter().chain([&own]) {
        value.push(coefficient * local.rhs()[i]);
        let known = local.row(i).filter_map(|(j, v)| Some(v * prescribed.get(&j)?));
        value.extend(known.map(|part| -coefficient * part));
    }
    let (sum, size) =
        value.iter().fold((Compensated::default(), 0.0), |(sum, size), &part| (sum.add(part), size + part.abs()));
    let n = value.len() as f64 * f64::EPSILON;
    // Each term has at most three roundings, and their sum one.
    let error = (2.0 * f64::EPSILON + n * n) * size;
    let difference = (sum.value + sum.lost).abs();
    match difference {
        _ if !(size == 0.0 || size > 1e-290 && size.is_finite()) => None,
        difference if difference + error <= ROUNDING * size => Some(true),
        difference if difference - error > ROUNDING * size => Some(false),
        _ => None,
    }
}

/// A sum and its rounding error (Neumaier 1974).
#[derive(Clone, Copy, Default)]
struct Compensated {
    value: f64,
    lost: f64,
}

impl Compensated {
    fn add(self, part: f64) -> Self {
        let sum = self.value + part;
        let second = sum - self.value;
        Self { value: sum, lost: self.lost + ((self.value - (sum - second)) + (part - second)) }
    }
}

#[cfg(test)]
mod tests {
    use super::Compensated;
    use crate::common::SplitMix64;

    /// Whole numbers up to `2^70` that cancel, with 1 to 9 between them. Plain sums miss by up to `2^20`.
    #[test]
    fn what_rounding_loses_is_added() {
        let mut random = SplitMix64::new(1);
        for seed in 0..100 {
            let large: Vec<f64> = (0..20).map(|k| random.next() as f64 * 2_f64.powi(k % 7)).collect();
            let small: Vec<f64> = (0..20).map(|_| 1.0 + (random.next() % 9) as f64).collect();
            let parts = large.iter().copied().chain(small.iter().copied()).chain(large.iter().rev().map(|v| -v));
            let sum = parts.fold(Compensated::default(), Compensated::add);
            assert_eq!((sum.value + sum.lost).round(), small.iter().sum::<f64>(), "{seed}");
        }
    }
}

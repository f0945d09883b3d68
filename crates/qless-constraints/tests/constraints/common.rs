use qless::{Options, analyse};
use qless_constraints::ConstraintSet;

pub type Outcome<T = ()> = Result<T, Box<dyn std::error::Error>>;

/// `G du = -c` at u = 0.
pub fn at_rest(set: &ConstraintSet, prescribed: &[(usize, f64)]) -> Outcome<qless::ConstraintSystem> {
    Ok(set.linearised_at(&vec![0.0; set.dofs()], prescribed)?)
}

/// Rank of G at u.
pub fn rank(set: &ConstraintSet, u: &[f64]) -> Outcome<usize> {
    Ok(analyse(&set.linearised_at(u, &[])?, &Options::default())?.rank())
}

/// A number in [-0.5, 0.5], the same for a seed.
pub fn random(seed: usize) -> f64 {
    let z = (seed as u64 + 11).wrapping_mul(0x9E37_79B9_7F4A_7C15).rotate_left(29).wrapping_mul(0xD6E8_FEB8_6659_FD93);
    f64::from((z ^ (z >> 32)) as u32) / f64::from(u32::MAX) - 0.5
}

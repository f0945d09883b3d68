use qless::{Options, analyse};
use qless_constraints::ConstraintSet;
use qless_constraints::types::Point;

pub type Outcome<T = ()> = Result<T, Box<dyn std::error::Error>>;

/// `G du = -c` at u = 0.
pub fn at_rest(set: &ConstraintSet, prescribed: &[(usize, f64)]) -> Outcome<qless::ConstraintSystem> {
    Ok(set.linearised_at(&vec![0.0; set.dofs()], prescribed)?)
}

/// Rank of G at u.
pub fn rank(set: &ConstraintSet, u: &[f64]) -> Outcome<usize> {
    Ok(analyse(&set.linearised_at(u, &[])?, &Options::default())?.rank())
}

/// A node whose three DOFs start at `3 node`.
pub fn point(node: usize, at: [f64; 3]) -> Point {
    Point::new([3 * node, 3 * node + 1, 3 * node + 2], at)
}

/// Any displacement that is linear in the coordinates.
pub fn field(x: [f64; 3]) -> [f64; 3] {
    let a = [[0.3, -0.2, 0.5], [0.1, 0.4, -0.6], [-0.7, 0.2, 0.9]];
    std::array::from_fn(|i| 0.1 * i as f64 + (0..3).map(|k| a[i][k] * x[k]).sum::<f64>())
}

/// A number in [-0.5, 0.5], the same for a seed.
pub fn random(seed: usize) -> f64 {
    let z = (seed as u64 + 11).wrapping_mul(0x9E37_79B9_7F4A_7C15).rotate_left(29).wrapping_mul(0xD6E8_FEB8_6659_FD93);
    f64::from((z ^ (z >> 32)) as u32) / f64::from(u32::MAX) - 0.5
}

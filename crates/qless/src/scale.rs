//! `C' = D_r C D_c` with powers of two: exact, and it makes every tolerance relative.
//!
//! Rows are always scaled, so that the largest coefficient of a free DOF in each row lies in `[1, 2)`. Columns are
//! scaled only where units mix, that is where more than one column in twenty with two entries or more lies below
//! `2^-10` after row scaling; then rows and columns are balanced by geometric means (Curtis and Reid 1972)
//! before the rows get their final scale.

use crate::local::Local;

/// Exponents of the scaling: `C'_ij = C_ij 2^(row[i] + col[j])`.
#[derive(Clone, Debug)]
pub(crate) struct Scaling {
    pub row: Vec<i32>,
    /// Empty where no column is scaled.
    pub col: Vec<i32>,
}

impl Scaling {
    pub fn col(&self, j: usize) -> i32 {
        self.col.get(j).copied().unwrap_or(0)
    }

    /// The scaled coefficient.
    pub fn entry(&self, i: usize, j: usize, value: f64) -> f64 {
        ldexp(value, self.row[i] + self.col(j))
    }
}

/// `x 2^k`, exact unless the result leaves the range of doubles.
pub(crate) fn ldexp(x: f64, k: i32) -> f64 {
    let power = |k: i32| f64::from_bits(((k + 1023) as u64) << 52);
    match k {
        0 => x,
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

/// Scales `C` by its free columns; a row without free DOFs is scaled by its prescribed ones.
pub(crate) fn equilibrate(system: Local) -> Scaling {
    let mut scaling = Scaling { row: vec![0; system.equations()], col: Vec::new() };
    let some_small = scale_rows(system, &mut scaling);
    if some_small && small_columns(system, &scaling) {
        balance(system, &mut scaling);
        scale_rows(system, &mut scaling);
    }
    scaling
}

/// Entries below this power of two in their rows are small.
const SMALL: i32 = -10;

/// Scales every row; true if some free entry is small.
fn scale_rows(system: Local, scaling: &mut Scaling) -> bool {
    let mut any_small = false;
    for i in 0..system.equations() {
        let (mut least, mut free, mut any) = (i32::MAX, i32::MIN, i32::MIN);
        for (j, v) in system.row(i) {
            let e = exponent(v) + scaling.col(j);
            any = any.max(e);
            if system.free()[j] {
                free = free.max(e);
                least = least.min(e);
            }
        }
        let top = if free > i32::MIN { free } else { any };
        scaling.row[i] = if top > i32::MIN { -top } else { 0 };
        any_small |= least < i32::MAX && least - top < SMALL;
    }
    any_small
}

/// Whether more than one in twenty of the columns with two entries or more are small in all their rows.
fn small_columns(system: Local, scaling: &Scaling) -> bool {
    let mut top = vec![i32::MIN; system.dofs()];
    let mut count = vec![0_u32; system.dofs()];
    for i in 0..system.equations() {
        for (j, v) in system.row(i) {
            top[j] = top[j].max(exponent(v) + scaling.row[i]);
            count[j] += 1;
        }
    }
    let shared = || (0..system.dofs()).filter(|&j| system.free()[j] && count[j] >= 2);
    20 * shared().filter(|&j| top[j] < SMALL).count() > shared().count()
}

/// Alternating geometric means of the free part, ten sweeps.
fn balance(c: Local, scaling: &mut Scaling) {
    let mut row = vec![0.0; c.equations()];
    let mut col = vec![0.0; c.dofs()];
    for _ in 0..10 {
        let mut sum = vec![(0.0, 0.0); c.dofs()];
        for i in 0..c.equations() {
            let free = || c.row(i).filter(|&(j, _)| c.free()[j]);
            let total: f64 = free().map(|(j, v)| v.abs().log2() + col[j]).sum();
            row[i] = -total / (free().count().max(1) as f64);
            free().for_each(|(j, v)| {
                sum[j].0 += v.abs().log2() + row[i];
                sum[j].1 += 1.0;
            });
        }
        for (j, &(total, count)) in sum.iter().enumerate().filter(|(_, s)| s.1 > 0.0) {
            col[j] = -total / count;
        }
    }
    scaling.col = col.iter().map(|&e: &f64| e.round() as i32).collect();
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ConstraintSystem;
    use crate::local::Numbering;

    #[test]
    fn powers_of_two_are_exact_over_the_whole_range() {
        assert_eq!(ldexp(3.0, 4), 48.0);
        assert_eq!(ldexp(f64::MIN_POSITIVE, 2000), f64::MIN_POSITIVE * 2f64.powi(1000) * 2f64.powi(1000));
        assert_eq!(ldexp(1.5, -1060), 1.5 * 2f64.powi(-1000) * 2f64.powi(-60));
        assert_eq!((exponent(1.0), exponent(-7.9), exponent(0.25), exponent(5e-324)), (0, 2, -2, -1074));
    }

    #[test]
    fn columns_in_other_units_come_back_to_one_size() {
        let mut triplets = Vec::new();
        for i in 0..30_usize {
            for k in 0..4 {
                let j = (i * 7 + k * 5) % 40;
                let unit = [1e-6, 1.0, 1e6][j % 3];
                triplets.push((i, j, unit * (1.0 + k as f64)));
            }
        }
        let system = ConstraintSystem::from_triplets(30, 40, &triplets, &[0.0; 30], &[]).expect("valid");
        let (numbering, _) = Numbering::new(&system);
        let local = numbering.view(&system, system.rhs());
        let scaling = equilibrate(local);
        for i in 0..30 {
            for (j, v) in local.row(i) {
                let scaled = scaling.entry(i, j, v);
                assert!((0.05..2.0).contains(&scaled), "row {i} DOF {j}: {scaled}");
            }
        }
    }
}

//! `C' = D_r C D_c` with powers of two: exact, and it makes every tolerance relative.
//!
//! Rows are always scaled, so that the largest coefficient of a free DOF in each row lies in `[1, 2)`. Columns are
//! scaled only where units mix, that is where more than one column in twenty with two entries or more lies below
//! `2^-10` after row scaling; then rows and columns are balanced by geometric means (Curtis and Reid 1972)
//! before the rows get their final scale.

use crate::{ConstraintSystem, Csr};

/// Exponents of the scaling: `C'_ij = C_ij 2^(row[i] + col[j])`.
#[derive(Clone, Debug)]
pub(crate) struct Scaling {
    pub row: Vec<i32>,
    /// Empty where no column is scaled.
    pub col: Vec<i32>,
}

impl Scaling {
    /// Rows only, whatever the columns are.
    pub fn rows(system: &ConstraintSystem, is_free: &[bool]) -> Self {
        let mut scaling = Self { row: vec![0; system.equations()], col: Vec::new() };
        scale_rows(system.matrix(), is_free, &mut scaling);
        scaling
    }

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
pub(crate) fn equilibrate(system: &ConstraintSystem, is_free: &[bool]) -> Scaling {
    let c = system.matrix();
    let mut scaling = Scaling::rows(system, is_free);
    if units_mix(c, is_free, &scaling) {
        balance(c, is_free, &mut scaling);
        scale_rows(c, is_free, &mut scaling);
    }
    scaling
}

fn scale_rows(c: &Csr, is_free: &[bool], scaling: &mut Scaling) {
    for i in 0..c.rows() {
        let mut free = i32::MIN;
        let mut any = i32::MIN;
        for (j, v) in c.row(i) {
            let e = exponent(v) + scaling.col(j);
            any = any.max(e);
            if is_free[j] {
                free = free.max(e);
            }
        }
        let top = if free > i32::MIN { free } else { any };
        scaling.row[i] = if top > i32::MIN { -top } else { 0 };
    }
}

fn units_mix(c: &Csr, is_free: &[bool], scaling: &Scaling) -> bool {
    const SMALL: i32 = -10;
    let mut top = vec![i32::MIN; c.cols];
    let mut small_entries = false;
    for i in 0..c.rows() {
        for (j, v) in c.row(i) {
            let e = exponent(v) + scaling.row[i];
            small_entries |= e < SMALL && is_free[j];
            top[j] = top[j].max(e);
        }
    }
    if !small_entries {
        return false;
    }
    let mut count = vec![0_u32; c.cols];
    c.col.iter().for_each(|&j| count[j as usize] += 1);
    let shared = || (0..c.cols).filter(|&j| is_free[j] && count[j] >= 2);
    20 * shared().filter(|&j| top[j] < SMALL).count() > shared().count()
}

/// Alternating geometric means of the free part, ten sweeps.
fn balance(c: &Csr, is_free: &[bool], scaling: &mut Scaling) {
    let mut row = vec![0.0; c.rows()];
    let mut col = vec![0.0; c.cols];
    for _ in 0..10 {
        let mut sum = vec![(0.0, 0.0); c.cols];
        for i in 0..c.rows() {
            let free = || c.row(i).filter(|&(j, _)| is_free[j]);
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
        let scaling = equilibrate(&system, &[true; 40]);
        for i in 0..30 {
            for (j, v) in system.matrix().row(i) {
                let scaled = scaling.entry(i, j, v);
                assert!((0.05..2.0).contains(&scaled), "row {i} DOF {j}: {scaled}");
            }
        }
    }
}

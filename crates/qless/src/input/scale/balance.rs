//! Rows and columns in units that make their entries as equal as they can be.

use super::{Scaling, free};
use crate::input::numbering::LocalSystem;

/// Where the largest of each row and column is 1, no unit explains an entry below this power of two: it is rounding.
pub(crate) const ROUNDING: i32 = -46;
/// Sweeps of equilibration; each halves what is missing, in powers of two.
const SWEEPS: usize = 12;

/// Alternating geometric means of the free part, ten sweeps, then a largest number of 1: the former find the units, the latter
/// what numbers of many sizes in one row made of them.
///
/// A mean over an entry of 1e-159, which is what is left of a zero, would move its row and column by hundreds of powers: entries that no unit
/// explains have no part in it.
pub fn balance(c: LocalSystem, scaling: &mut Scaling) {
    let (mut row, mut col) = (vec![0.0; c.equations()], vec![0.0; c.dofs()]);
    let (of_row, of_col) = equilibrated(c, row.clone(), col.clone());
    let counting = |i: usize| {
        let (of_row, of_col) = (&of_row, &of_col);
        let powers = free(c, i).map(|(j, v)| (j, v.abs().log2()));
        powers.filter(move |&(j, power)| power + of_row[i] + of_col[j] > f64::from(ROUNDING))
    };
    for _ in 0..10 {
        let mut sum = vec![(0.0, 0.0); c.dofs()];
        for i in 0..c.equations() {
            let total: f64 = counting(i).map(|(j, power)| power + col[j]).sum();
            row[i] = -total / (counting(i).count().max(1) as f64);
            counting(i).for_each(|(j, power)| {
                sum[j].0 += power + row[i];
                sum[j].1 += 1.0;
            });
        }
        for (j, &(total, count)) in sum.iter().enumerate().filter(|(_, s)| s.1 > 0.0) {
            col[j] = -total / count;
        }
    }
    scaling.col = equilibrated(c, row, col).1.iter().map(|e| e.round() as i32).collect();
}

/// Exponents for rows and columns with which the largest free number of each is 1 (Ruiz 2001), from those given.
pub(crate) fn equilibrated(system: LocalSystem, mut row: Vec<f64>, mut col: Vec<f64>) -> (Vec<f64>, Vec<f64>) {
    for _ in 0..SWEEPS {
        let mut of_row = vec![f64::NEG_INFINITY; row.len()];
        let mut of_col = vec![f64::NEG_INFINITY; col.len()];
        for i in 0..row.len() {
            for (j, v) in free(system, i) {
                let power = v.abs().log2() + row[i] + col[j];
                (of_row[i], of_col[j]) = (of_row[i].max(power), of_col[j].max(power));
            }
        }
        let halve = |scale: &mut Vec<f64>, most: &[f64]| {
            scale
                .iter_mut()
                .zip(most)
                .filter(|(_, most)| most.is_finite())
                .for_each(|(scale, most)| *scale -= most / 2.0);
        };
        halve(&mut row, &of_row);
        halve(&mut col, &of_col);
    }
    (row, col)
}

//! `u_s = -R1^-1 R2 u_q - R1^-1 Q^T C_p u_p + R1^-1 Q^T b` for blocks whose T would be too large as a dense array.
//!
//! Column by column, from the last non-zero down, so that the cost is that of the numbers that are there; what is rounding
//! is dropped from each column at once. Slaves and masters change places later, in the reduction, where T is sparse too.

use rayon::prelude::*;

use super::slaves::NOISE;
use crate::Csr;
use crate::qr::Factor;

/// `[-T' -G' g']` by columns: r rows, a column for each master, each prescribed DOF, and the constant.
pub(super) fn columns(factor: &Factor, prescribed: usize) -> (Csr, Vec<f64>) {
    let (r, by_column) = (factor.rank, factor.r.transpose());
    let masters = (r..by_column.rows()).into_par_iter().map_init(
        || vec![0.0; r],
        |work, k| {
            by_column.row(k).for_each(|(i, v)| work[i] = v);
            take(&by_column, work, -1.0)
        },
    );
    let mut columns: Vec<_> = masters.collect();
    let solve = |c: usize, sign: f64| take(&by_column, &mut factor.rhs[c * r..(c + 1) * r].to_vec(), sign);
    columns.extend((0..prescribed).map(|c| solve(c, -1.0)));
    let mut all = Csr::empty(r);
    columns.into_iter().for_each(|column| all.push_row(column));
    let mut constant = vec![0.0; r];
    solve(prescribed, 1.0).into_iter().for_each(|(i, v)| constant[i] = v);
    (all, constant)
}

/// `sign R1^-1 z` without rounding; leaves z zero.
fn take(columns: &Csr, z: &mut [f64], sign: f64) -> Vec<(usize, f64)> {
    let top = z.iter().rposition(|&v| v != 0.0).map_or(0, |top| top + 1);
    let mut largest = 0.0_f64;
    for i in (0..top).rev() {
        if z[i] == 0.0 {
            continue;
        }
        let entries = columns.row(i);
        let above = entries.len() - 1;
        let (_, diagonal) = entries.clone().last().expect("R1 has a diagonal");
        let x = z[i] / diagonal;
        entries.take(above).for_each(|(row, v)| z[row] -= v * x);
        z[i] = x;
        largest = largest.max(x.abs());
    }
    let drain = z[..top].iter_mut().map(|v| sign * std::mem::take(v)).enumerate();
    drain.filter(|(_, v)| v.abs() > NOISE * largest).collect()
}

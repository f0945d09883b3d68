//! The paper's elimination by one factorization `C_f P = Q [R1 R2; 0 0]` (Eq. 21-26), which any QR library can do:
//! `T = -R1^-1 R2`, `G = -R1^-1 Q^T C_p`, `g = R1^-1 Q^T b`. C_f and C_p are the columns of C for free and prescribed
//! DOFs. No scaling, no presolve, no check of the rank.

use qless::backend::{Backend, BackendError, Factor};
use qless::{ConstraintSystem, Csr, Reduction};

use super::free_columns;

/// Computes T, G and g. The slaves are the columns that the factorization finds independent.
///
/// # Errors
/// Those of the backend.
pub fn eliminate(system: &ConstraintSystem, backend: &dyn Backend, tolerance: f64) -> Result<Reduction, BackendError> {
    let prescribed: Vec<usize> = system.prescribed().iter().map(|&(j, _)| j).collect();
    let free: Vec<usize> = (0..system.dofs()).filter(|j| prescribed.binary_search(j).is_err()).collect();
    let columns = free_columns(system);
    let (m, k) = (system.equations(), prescribed.len());
    let mut rhs = vec![0.0; m * (k + 1)];
    for (i, row) in (0..m).map(|i| (i, system.matrix().row(i))) {
        let fixed = row.filter_map(|(j, v)| Some((prescribed.binary_search(&j).ok()?, v)));
        fixed.for_each(|(c, v)| rhs[c * m + i] = v);
    }
    rhs[m * k..].copy_from_slice(system.rhs());
    let factor = backend.factor(&columns, &rhs, tolerance)?;
    Ok(reduction(&factor, &free, prescribed))
}

fn reduction(factor: &Factor, free: &[usize], prescribed: Vec<usize>) -> Reduction {
    let (r, n) = (factor.rank, free.len());
    let (slaves, slave_places) = sorted(&factor.order[..r], free);
    let (masters, master_places) = sorted(&factor.order[r..], free);
    let by_master = solved(factor);
    let mut t = Csr::empty(r);
    master_places.iter().for_each(|&q| t.push_row(by_master.row(q)).expect("a row of another matrix"));
    let t = ordered(&t.transpose().expect("as many columns as slaves"), &slave_places);
    let fixed: Vec<Vec<f64>> = factor.rhs.chunks(r.max(1)).map(|z| factor.solve(z).expect("as long as R1")).collect();
    let mut g_matrix = Csr::empty(prescribed.len());
    let mut g = vec![0.0; r];
    for (i, &place) in slave_places.iter().enumerate() {
        let row = fixed[..prescribed.len().min(fixed.len())].iter().enumerate().map(|(c, x)| (c, -x[place]));
        g_matrix.push_row(row.filter(|&(_, v)| v != 0.0)).expect("prescribed DOFs ascend");
        g[i] = fixed.last().map_or(0.0, |x| x[place]);
    }
    debug_assert_eq!(slaves.len() + masters.len(), n);
    Reduction::from_parts([slaves, masters, prescribed], t, g_matrix, g).expect("each DOF is once in the order")
}

/// The DOFs of `order` in ascending order, and for each its place in `order`.
fn sorted(order: &[usize], free: &[usize]) -> (Vec<usize>, Vec<usize>) {
    let mut places: Vec<usize> = (0..order.len()).collect();
    places.sort_unstable_by_key(|&place| order[place]);
    (places.iter().map(|&place| free[order[place]]).collect(), places)
}

fn ordered(rows: &Csr, places: &[usize]) -> Csr {
    let mut out = Csr::empty(rows.cols());
    places.iter().for_each(|&place| out.push_row(rows.row(place)).expect("a row of another matrix"));
    out
}

/// `-R1^-1 R2`, a row for each column of R2, computed from the last nonzero of each column upwards, so that zeros cost almost nothing.
fn solved(factor: &Factor) -> Csr {
    let columns = factor.r.transpose().expect("as many columns as free DOFs");
    let start = columns.starts();
    let mut out = Csr::empty(factor.rank);
    let mut x = vec![0.0; factor.rank];
    for q in factor.rank..columns.rows() {
        let last = columns.row(q).map(|(i, v)| x[i] = -v).count();
        let from = if last == 0 { 0 } else { columns.columns()[start[q + 1] - 1] as usize + 1 };
        let mut entries = Vec::new();
        for j in (0..from).rev().filter(|&j| start[j + 1] > start[j]) {
            let value = std::mem::take(&mut x[j]);
            if value != 0.0 {
                let diagonal = columns.values()[start[j + 1] - 1];
                let value = value / diagonal;
                let above = columns.row(j).len() - 1;
                columns.row(j).take(above).for_each(|(i, v)| x[i] -= v * value);
                entries.push((j, value));
            }
        }
        out.push_row(entries.into_iter().rev()).expect("from the last to the first");
    }
    out
}

//! Motions that K resists only through entries of T that are rounding.

use faer::sparse::{SparseColMat, Triplet};
use qless::elimination::View;
use qless::{ConstraintSystem, Elimination, Options, SystemBuilder, analyse};
use qless_solve::enforce::{EnforceError, Lu, Problem, Steps, reduced};

use crate::linkages::Outcome;

/// Exponents of the units of DOFs and of equations.
const DOFS: [i32; 13] = [-1, 6, 0, -5, 7, -8, -3, 8, 5, -2, -8, 6, 7];
const ROWS: [i32; 10] = [7, 8, 5, -3, -3, -1, -7, 2, -4, 2];
const STIFFNESS: [(usize, usize, f64); 6] =
    [(3, 3, 1.0), (3, 6, -3.0), (6, 3, -3.0), (6, 6, 2.0), (7, 7, 1.0), (12, 12, 2.0)];

fn unit(j: usize) -> f64 {
    2_f64.powi(DOFS[j])
}

/// K does not resist two combined motions, of DOFs 0, 2, 5, 10 and of 1 and 4. DOFs 3, 6, 7 and 12 have stiffness but do not take part.
fn system() -> Outcome<ConstraintSystem> {
    let rows: [&[(usize, f64)]; 10] = [
        &[(6, 1.0), (12, 1.0)],
        &[(0, 2.0), (5, 2.0), (10, 2.0)],
        &[(8, 1.0)],
        &[(1, -1.0), (4, -1.0), (6, -1.0)],
        &[(8, -3.0), (9, 1.0)],
        &[(5, 1.0), (7, 1.0), (10, 2.0)],
        &[(1, 1.0), (3, -3.0), (4, 1.0)],
        &[(0, -1.0), (2, 1.0), (12, 1.0)],
        &[(0, 1.0), (2, 1.0), (5, 1.0)],
        &[(9, 1.0), (11, -3.0)],
    ];
    let values = [-4.0, 0.0, 1.0, -2.0, -2.0, 5.0, 4.0, 1.0, -1.0, 4.0];
    let mut builder = SystemBuilder::new(DOFS.len());
    for ((terms, value), power) in rows.into_iter().zip(values).zip(ROWS) {
        let scale = 2_f64.powi(power);
        builder.equation(terms.iter().map(|&(j, v)| (j, scale * v / unit(j))), scale * value);
    }
    Ok(builder.build()?)
}

fn is_refused<T>(solved: &Result<T, EnforceError>) -> bool {
    matches!(solved, Err(EnforceError::Unsupported(motion)) if !motion.dofs.is_empty())
}

#[test]
fn motions_that_only_rounding_of_t_holds_are_refused() -> Outcome {
    let system = system()?;
    let entries = STIFFNESS.map(|(i, j, v)| Triplet::new(i, j, v / 4096.0 / unit(i) / unit(j)));
    let k = SparseColMat::try_new_from_triplets(13, 13, &entries)?;
    let loads = [-5.0, -3.0, 3.0, 5.0, -4.0, 4.0, 1.0, 4.0, -4.0, 4.0, 2.0, -1.0, 4.0];
    let f: Vec<f64> = loads.iter().enumerate().map(|(j, f)| f / 4096.0 / unit(j)).collect();
    let reduction = analyse(&system, &Options::default())?.reduction()?;
    assert!(is_refused(&reduced(&k, &f, &reduction, &[])));
    assert!(is_refused(&Problem::new(&k, &f, &system)?.transformation()));
    let (starts, index) = (k.symbolic().col_ptr(), k.symbolic().row_idx());
    let mut steps =
        Steps::new(Elimination::new(&system, &Options::default())?, View::columns(starts, index), Lu::default())?;
    assert!(is_refused(&steps.solve(k.val(), &f, &mut [0.0; 13])));
    Ok(())
}

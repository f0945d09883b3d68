//! Half of a symmetric K is read if it is declared, and refused if it is not.

use faer::sparse::{SparseColMat, Triplet};
use qless::elimination::View;
use qless::{Elimination, Options};
use qless_solve::enforce::{EnforceError, Llt, Problem, Steps, Stiffness};

use super::models::{Kind, Lack, all_units, model};
use crate::linkages::Outcome;

type Matrix = SparseColMat<usize, f64>;

fn half(k: &Matrix, lower: bool) -> Outcome<Matrix> {
    let entries: Vec<_> = (0..k.ncols())
        .flat_map(|j| k.symbolic().row_idx_of_col(j).zip(k.val_of_col(j)).map(move |(i, &v)| Triplet::new(i, j, v)))
        .filter(|entry| entry.row == entry.col || (entry.row > entry.col) == lower)
        .collect();
    Ok(Matrix::try_new_from_triplets(k.nrows(), k.ncols(), &entries)?)
}

/// The same bits as with the full K.
#[test]
fn a_half_that_is_declared_is_the_whole() -> Outcome {
    for (case, units) in all_units().enumerate() {
        let kind = [Kind::Symmetric, Kind::Indefinite][case % 2];
        let model = model(3 * case, kind, Lack::Nothing, units)?;
        let (lower, upper) = (half(&model.k, true)?, half(&model.k, false)?);
        let whole = Problem::new(&model.k, &model.f, &model.system)?;
        for stiffness in [Stiffness::lower(&lower), Stiffness::upper(&upper)] {
            let problem = Problem::new(stiffness, &model.f, &model.system)?;
            assert_eq!(problem.transformation()?, whole.transformation()?, "{}", model.name);
            assert_eq!(problem.lagrange()?, whole.lagrange()?, "{}", model.name);
        }
    }
    Ok(())
}

#[test]
fn a_half_that_is_not_declared_is_refused() -> Outcome {
    for (case, units) in all_units().enumerate() {
        let model = model(case, Kind::Symmetric, Lack::Nothing, units)?;
        for lower in [true, false] {
            let k = half(&model.k, lower)?;
            match Problem::new(&k, &model.f, &model.system) {
                Err(error @ EnforceError::Triangle { lower: found }) => {
                    assert_eq!(found, lower);
                    let name = if lower { "Stiffness::lower" } else { "Stiffness::upper" };
                    assert!(error.to_string().contains(name), "{error}");
                }
                _ => return Err("a triangle was read as all of K".into()),
            }
            let other = if lower { Stiffness::upper(&k) } else { Stiffness::lower(&k) };
            assert!(matches!(
                Problem::new(other, &model.f, &model.system),
                Err(EnforceError::WrongHalf { row, column }) if (row > column) == lower
            ));
            let map = Elimination::new(&model.system, &Options::default())?;
            let view = View::columns(k.symbolic().col_ptr(), k.symbolic().row_idx());
            assert!(matches!(Steps::new(map, view, Llt::default()), Err(EnforceError::Triangle { .. })));
        }
    }
    Ok(())
}

/// A chain of DOFs in which each acts on the next only is an intended triangle; a diagonal matrix has no halves.
#[test]
fn triangles_and_diagonals_can_be_meant() -> Outcome {
    let system = qless::SystemBuilder::new(3).build()?;
    let entries = [(0, 0, 2.0), (1, 1, 2.0), (2, 2, 2.0), (1, 0, -1.0), (2, 1, -1.0)];
    let k = Matrix::try_new_from_triplets(3, 3, &entries.map(|(i, j, v)| Triplet::new(i, j, v)))?;
    let u = Problem::new(Stiffness::unsymmetric(&k), &[4.0, 0.0, 0.0], &system)?.lagrange()?.u;
    assert_eq!(u, [2.0, 1.0, 0.5]);
    let diagonal = half(&half(&k, true)?, false)?;
    let u = Problem::new(&diagonal, &[4.0, 2.0, 0.0], &system)?.lagrange()?.u;
    assert!((u[0] - 2.0).abs() < 1e-15 && (u[1] - 1.0).abs() < 1e-15 && u[2] == 0.0);
    // Explicit zeros on the other side do not make a second half.
    let mut with_zero = entries.to_vec();
    with_zero.push((0, 1, 0.0));
    let with_zero: Vec<_> = with_zero.into_iter().map(|(i, j, v)| Triplet::new(i, j, v)).collect();
    let k = Matrix::try_new_from_triplets(3, 3, &with_zero)?;
    assert!(matches!(Problem::new(&k, &[0.0; 3], &system), Err(EnforceError::Triangle { lower: true })));
    Ok(())
}

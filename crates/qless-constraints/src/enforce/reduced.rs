//! `T^T K T q = T^T (f - K u_0)`, `u = T q + u_0` (Eq. 6-9) with T, G and g that are given.

use faer::sparse::SparseColMat;
use qless::Reduction;

use super::EnforceError;
use super::expansion::triplets;
use super::matrix::{Factor, from_triplets, product, times, transposed};

/// u of all DOFs, by transformation with a reduction, whoever made it; `prescribed` are the values of its prescribed DOFs.
///
/// [`super::Problem`] makes its own reduction; this one shows what another does to the solution.
///
/// ```
/// use faer::sparse::{SparseColMat, Triplet};
/// use qless::{Options, SystemBuilder, analyse};
/// use qless_constraints::enforce::reduced;
/// // Two springs of stiffness 2 and 4 to the ground, tied to one another, under a load of 3.
/// let k = SparseColMat::try_new_from_triplets(2, 2, &[Triplet::new(0, 0, 2.0), Triplet::new(1, 1, 4.0)])?;
/// let mut builder = SystemBuilder::new(2);
/// builder.equation([(0, 1.0), (1, -1.0)], 0.0);
/// let system = builder.build()?;
/// let reduction = analyse(&system, &Options::default())?.reduction(&system)?;
/// let u = reduced(&k, &[3.0, 0.0], &reduction, &[])?;
/// assert!((u[0] - 0.5).abs() < 1e-15 && (u[1] - 0.5).abs() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`EnforceError::Size`] where K, f or the values do not fit to the reduction, [`EnforceError::Singular`] if the constraints
/// do not hold the model.
pub fn reduced(
    k: &SparseColMat<usize, f64>,
    f: &[f64],
    reduction: &Reduction,
    prescribed: &[f64],
) -> Result<Vec<f64>, EnforceError> {
    let dofs = reduction.slaves.len() + reduction.masters.len() + reduction.prescribed.len();
    let given = dofs - reduction.prescribed.len() + prescribed.len();
    for (what, found) in [
        ("rows of K", k.nrows()),
        ("columns of K", k.ncols()),
        ("loads", f.len()),
        ("DOFs with the prescribed values", given),
    ] {
        if found != dofs {
            return Err(EnforceError::Size { what, found, dofs });
        }
    }
    let t = from_triplets(dofs, reduction.masters.len(), triplets(reduction))?;
    let back = transposed(&t)?;
    let stiffness = product(&back, &product(k, &t)?)?;
    let constant = reduction.expand(&vec![0.0; reduction.masters.len()], prescribed);
    let load: Vec<f64> = f.iter().zip(times(k, &constant)).map(|(f, stressed)| f - stressed).collect();
    let q = Factor::new(&stiffness, "the reduced stiffness")?.solve(&times(&back, &load))?;
    Ok(times(&t, &q).iter().zip(&constant).map(|(u, c)| u + c).collect())
}

//! Solves by transformation with a given reduction, whose rows `u_s = T u_q + G u_p + g` become the equations of a [`Problem`].

use faer::sparse::SparseColMat;
use qless::reduction::FactoredBlock;
use qless::{Reduction, ReductionError, SystemBuilder};

use super::problem::Problem;
use super::transform_noise::TransformNoise;
use super::{EnforceError, Stiffness};

/// Computes u of all DOFs by transformation with any reduction; `prescribed` are the values of its prescribed DOFs.
///
/// [`Problem`] makes its own reduction. This function shows how a reduction from elsewhere affects the solution. Entries of T that are
/// rounding of zeros are left out, since they would support nothing.
///
/// ```
/// use faer::sparse::{SparseColMat, Triplet};
/// use qless::{Options, SystemBuilder, analyse};
/// use qless_solve::enforce::reduced;
/// // Two springs of stiffness 2 and 4 to the ground, tied to one another, under a load of 3.
/// let k = SparseColMat::try_new_from_triplets(2, 2, &[Triplet::new(0, 0, 2.0), Triplet::new(1, 1, 4.0)])?;
/// let mut builder = SystemBuilder::new(2);
/// builder.equation([(0, 1.0), (1, -1.0)], 0.0);
/// let system = builder.build()?;
/// let reduction = analyse(&system, &Options::default())?.reduction()?;
/// let u = reduced(&k, &[3.0, 0.0], &reduction, &[])?;
/// assert!((u[0] - 0.5).abs() < 1e-15 && (u[1] - 0.5).abs() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`EnforceError::Argument`] if the values do not match the reduction, and as [`Problem::new`] and [`Problem::transformation`].
pub fn reduced(
    k: &SparseColMat<usize, f64>,
    f: &[f64],
    reduction: &Reduction,
    prescribed: &[f64],
) -> Result<Vec<f64>, EnforceError> {
    let dofs = reduction.slaves().len() + reduction.masters().len() + reduction.prescribed().len();
    let constant = reduction.expand(&vec![0.0; reduction.masters().len()], prescribed)?;
    let mut builder = SystemBuilder::new(dofs);
    reduction.prescribed().iter().zip(prescribed).for_each(|(&dof, &value)| builder.prescribe(dof, value));
    for row in explicit_rows(reduction).chain(factored_rows(reduction)?) {
        let rhs = row.iter().map(|&(j, v)| v * constant[j]).sum();
        builder.equation(row, rhs);
    }
    Ok(Problem::new(Stiffness::unsymmetric(k), f, &builder.build()?)?.transformation()?.u)
}

/// A row of C on free DOFs.
type Row = Vec<(usize, f64)>;

/// The left-hand sides `u_s - T u_q` for slaves whose T is explicit.
fn explicit_rows(reduction: &Reduction) -> impl Iterator<Item = Row> + '_ {
    let (noise, rows) = (TransformNoise::new(reduction.t()), reduction.t().rows());
    let mut is_factored = vec![false; reduction.slaves().len()];
    let factored = reduction.factored().iter().flat_map(FactoredBlock::slaves);
    factored.for_each(|dof| is_factored[reduction.slaves().partition_point(|slave| slave < dof)] = true);
    let slaves = reduction.slaves().iter().enumerate().filter(move |&(i, _)| !is_factored[i]);
    slaves.map(move |(i, &slave)| {
        let real = reduction.t().row(i).filter(|&(q, v)| noise.size((i, q, rows), v) == v.abs());
        std::iter::once((slave, 1.0)).chain(real.map(|(q, v)| (reduction.masters()[q], -v))).collect()
    })
}

/// The left-hand sides `C_S u_s + C_M u_q` for slaves whose T is kept as factors `C_S = (L U)^T`.
fn factored_rows(reduction: &Reduction) -> Result<Vec<Row>, EnforceError> {
    let mut all = Vec::new();
    for block in reduction.factored() {
        let out_of_range = || ReductionError::NotFinite { dof: block.slaves()[0] };
        let parts = block.parts().ok_or_else(out_of_range)?;
        let of_masters = |i| parts.of_masters.row(i).map(|(j, v)| (block.masters()[j], v)).collect();
        let mut rows: Vec<Row> = (0..block.slaves().len()).map(of_masters).collect();
        for (j, &slave) in block.slaves().iter().enumerate() {
            let upper = |(k, lower)| parts.upper.row(k).map(move |(i, upper)| (i, lower * upper));
            parts.lower.row(j).flat_map(upper).for_each(|(i, v)| rows[i].push((slave, v)));
        }
        all.extend(rows);
    }
    Ok(all)
}

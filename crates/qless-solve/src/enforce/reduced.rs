//! Transformation with a given reduction T, G, g: `T^T K T q = T^T (f - K u_0)`, `u = T q + u_0` (Eq. 6-9).
//!
//! Slaves of factored components stay unknowns, with `C_S du_s + C_M du_q = 0` by multipliers; `C_S` is the product of the factors.
//! Residuals are compared with the terms of K, T and f, since K_q does not show the terms that it was summed from.

use faer::sparse::SparseColMat;
use qless::{Csr, Reduction, ReductionError};

use super::condensation::TransformNoise;
use super::matrix::{
    ScaledFactor, add_sizes, add_sizes_transposed, add_transposed, bordered, entries, from_triplets, product, shifted,
    transposed,
};
use super::problem::check_arguments;
use super::refinement::{MeasuredEquations, RefinementGoal, refine};
use super::singularity::{SHIFTS, SupportVerdict, check_support, null_motion};
use super::{EnforceError, FreeMotion, units};
use crate::common::{SparseMatrix, times};

/// Computes u of all DOFs by transformation with any reduction; `prescribed` are the values of its prescribed DOFs.
///
/// [`super::Problem`] makes its own reduction. This function shows how a reduction from elsewhere affects the solution.
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
/// [`EnforceError::Size`] if K, f or the values do not match the reduction, [`EnforceError::NotFinite`], [`EnforceError::Unsupported`] if
/// the model is not supported, [`EnforceError::OutOfBalance`] if a residual is larger than 1e-10 of its terms.
pub fn reduced(
    k: &SparseColMat<usize, f64>,
    f: &[f64],
    reduction: &Reduction,
    prescribed: &[f64],
) -> Result<Vec<f64>, EnforceError> {
    let dofs = reduction.slaves().len() + reduction.masters().len() + reduction.prescribed().len();
    let with_values = dofs - reduction.prescribed().len() + prescribed.len();
    check_arguments(k, f, (prescribed, with_values), dofs)?;
    let slaves = factored_slaves(reduction);
    let t = from_triplets(dofs, reduction.masters().len() + slaves.len(), triplets(reduction))?;
    let back = transposed(&t)?;
    let stiffness = product(&back, &product(k, &t)?)?;
    let constant = reduction.expand(&vec![0.0; reduction.masters().len()], prescribed)?;
    let load: Vec<f64> = f.iter().zip(times(k, &constant)).map(|(f, stressed)| f - stressed).collect();
    let mut rhs = times(&back, &load);
    let constraints = product(&equations(reduction, dofs)?, &t)?;
    rhs.resize(t.ncols() + slaves.len(), 0.0);
    let units = units::units(&stiffness, &constraints);
    let matrix = bordered(&stiffness, &constraints)?;
    let parts = units::parts(rhs.len(), entries(&matrix).map(|(i, j, _)| (i, j)));
    let t_sizes = sizes_of_t(&t, reduction)?;
    let mut rhs_sizes = sizes_of_load(k, &t_sizes, &constant, f);
    rhs_sizes.resize(rhs.len(), 0.0);
    let model = ReducedEquations { k, t, t_sizes, constraints, units, parts };
    let x = model.solved(&matrix, (&rhs, &rhs_sizes))?;
    Ok(times(&model.t, &x[..model.t.ncols()]).iter().zip(&constant).map(|(u, c)| u + c).collect())
}

/// `|T|^T (|f| + |K| |u_0|)`.
fn sizes_of_load(k: &SparseMatrix, t: &SparseMatrix, constant: &[f64], f: &[f64]) -> Vec<f64> {
    let mut of_dofs: Vec<f64> = f.iter().map(|f| f.abs()).collect();
    add_sizes(k, constant, &mut of_dofs);
    let mut sizes = vec![0.0; t.ncols()];
    add_sizes_transposed(t, &of_dofs, &mut sizes);
    sizes
}

/// The sizes of the terms of T's entries.
fn sizes_of_t(t: &SparseMatrix, reduction: &Reduction) -> Result<SparseMatrix, EnforceError> {
    let noise = TransformNoise::new(reduction.t());
    let mut place = vec![None; t.nrows()];
    reduction.slaves().iter().enumerate().for_each(|(i, &dof)| place[dof] = Some(i));
    let of_slaves = 0..reduction.masters().len();
    let size = |(dof, q, v): (usize, usize, f64)| {
        let slave = place[dof].filter(|_| of_slaves.contains(&q));
        (dof, q, slave.map_or(v, |i| noise.size(i, q, v)))
    };
    from_triplets(t.nrows(), t.ncols(), entries(t).map(size))
}

/// The equations of factored components on their free DOFs.
fn equations(reduction: &Reduction, dofs: usize) -> Result<SparseMatrix, EnforceError> {
    let (mut all, mut first) = (Vec::new(), 0);
    for block in reduction.factored() {
        let out_of_range = || ReductionError::NotFinite { dof: block.slaves()[0] };
        let parts = block.parts().ok_or_else(out_of_range)?;
        let lower = from_triplets(block.slaves().len(), block.slaves().len(), rows(&parts.lower))?;
        let upper = from_triplets(block.slaves().len(), block.slaves().len(), rows(&parts.upper))?;
        let of_slaves = product(&transposed(&upper)?, &transposed(&lower)?)?;
        let slaves = entries(&of_slaves).map(|(i, j, v)| (first + i, block.slaves()[j], v));
        let masters = rows(&parts.of_masters).map(|(i, j, v)| (first + i, block.masters()[j], v));
        all.extend(slaves.chain(masters));
        first += block.slaves().len();
    }
    from_triplets(first, dofs, all)
}

fn rows(matrix: &Csr) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
    (0..matrix.rows()).flat_map(|i| matrix.row(i).map(move |(j, v)| (i, j, v)))
}

/// Slaves of factored components, ascending; they are unknowns.
fn factored_slaves(reduction: &Reduction) -> Vec<usize> {
    let mut slaves: Vec<usize> = reduction.factored().iter().flat_map(|block| block.slaves().iter().copied()).collect();
    slaves.sort_unstable();
    slaves
}

/// Entries of T: eliminated slaves, then masters, then the slaves that stay unknowns.
fn triplets(reduction: &Reduction) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
    let slaves = reduction.slaves().iter().enumerate();
    let of_slaves = slaves.flat_map(|(i, &dof)| reduction.t().row(i).map(move |(q, v)| (dof, q, v)));
    let kept = reduction.masters().iter().copied().chain(factored_slaves(reduction));
    of_slaves.chain(kept.enumerate().map(|(q, dof)| (dof, q, 1.0)))
}

/// Most solves, including refinements.
const REFINEMENTS: usize = 6;

/// `T^T K T q + B^T lambda = f_q`, `B q = 0`, with the sizes of all terms.
pub struct ReducedEquations<'a> {
    pub k: &'a SparseMatrix,
    pub t: SparseMatrix,
    /// The sizes of the terms of T's entries.
    pub t_sizes: SparseMatrix,
    pub constraints: SparseMatrix,
    pub units: Vec<f64>,
    pub parts: Vec<usize>,
}

impl ReducedEquations<'_> {
    /// Solves for q and lambda, and refines.
    ///
    /// # Errors
    /// The residual of a row stays too large for its terms, or the matrix is singular.
    pub fn solved(&self, matrix: &SparseMatrix, rhs: (&[f64], &[f64])) -> Result<Vec<f64>, EnforceError> {
        let singular = EnforceError::Singular { what: "the reduced stiffness" };
        let Ok(mut factor) = ScaledFactor::new(matrix, self.units.clone(), false) else {
            return Err(self.free_motion(matrix).unwrap_or(singular));
        };
        let mut solve = |r: &[f64]| factor.solve(r);
        match check_support(self, &mut solve) {
            Ok(SupportVerdict::Supported(_)) => {}
            Ok(SupportVerdict::Mechanism(motion, resistance)) => return Err(self.unsupported(&motion, resistance)),
            Err(_) => return Err(self.free_motion(matrix).unwrap_or(singular)),
        }
        let refined = refine(self, &mut solve, rhs, &RefinementGoal::balance(REFINEMENTS))?;
        if refined.share > 1.0 {
            let row = format!("the forces on unknown {}", refined.row);
            return Err(EnforceError::OutOfBalance { row, imbalance: refined.imbalance });
        }
        Ok(refined.x)
    }

    fn free_motion(&self, matrix: &SparseMatrix) -> Option<EnforceError> {
        let motion = |shift: f64| {
            let matrix = shifted(matrix, &self.units, self.t.ncols(), shift).ok()?;
            let mut factor = ScaledFactor::new(&matrix, self.units.clone(), false).ok()?;
            let (motion, resistance) = null_motion(self, &mut |r: &[f64]| factor.solve(r))?;
            Some(self.unsupported(&motion, resistance))
        };
        SHIFTS.into_iter().find_map(motion)
    }

    fn unsupported(&self, motion: &[f64], resistance: f64) -> EnforceError {
        let (u, units) = (times(&self.t, &motion[..self.t.ncols()]), units::units_of(self.k));
        EnforceError::Unsupported(FreeMotion::new(&u, &units, resistance))
    }
}

impl MeasuredEquations for ReducedEquations<'_> {
    fn apply(&self, x: &[f64]) -> Vec<f64> {
        let (q, lambda) = x.split_at(self.t.ncols());
        let mut y = vec![0.0; q.len()];
        add_transposed(&self.t, &times(self.k, &times(&self.t, q)), &mut y);
        add_transposed(&self.constraints, lambda, &mut y);
        y.extend(times(&self.constraints, q));
        y
    }

    fn size(&self, x: &[f64]) -> Vec<f64> {
        let (q, lambda) = x.split_at(self.t.ncols());
        let (mut u, mut forces, mut y) = (vec![0.0; self.k.nrows()], vec![0.0; self.k.nrows()], vec![0.0; q.len()]);
        add_sizes(&self.t_sizes, q, &mut u);
        add_sizes(self.k, &u, &mut forces);
        add_sizes_transposed(&self.t_sizes, &forces, &mut y);
        add_sizes_transposed(&self.constraints, lambda, &mut y);
        let mut gaps = vec![0.0; lambda.len()];
        add_sizes(&self.constraints, q, &mut gaps);
        [y, gaps].concat()
    }

    fn units(&self) -> &[f64] {
        &self.units
    }

    fn parts(&self) -> &[usize] {
        &self.parts
    }
}

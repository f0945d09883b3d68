//! Generated boundary conditions: free DOFs that the equations fix to a value (section 2.2 and Figure 6 of the paper).
//!
//! DOF s is fixed iff it does not move in any vector of the null space of the free part of C. A random vector u of the null space shows this
//! without T: a fixed DOF is zero to rounding, and any other DOF is zero with probability zero. What rounding is, y tells in any units:
//!
//! ```text
//! C u = 0,   C y = +-|C'| |u| with random signs, C' the coefficients that may be rounded:   |E| <= e |C'| changes u_s by about e |y_s|
//! s is fixed   iff   |u_s| <= e |y_s|   for the rounding e of coefficients
//! ```
//!
//! The solve itself has an error, of about `e |z_s|` with `C z = +-eps |C| |u_0|` for its start u_0: a DOF that rests is fixed within that.
//!
//! Cost: one solve for u, and one for all samples of y and the values of the fixed DOFs; none if every DOF moves.

use std::collections::BTreeMap;

use crate::Csr;
use crate::common::random::signed;
use crate::diagnosis::certificate::{CertificateTerm, History};
use crate::diagnosis::confidence::NEAR;
use crate::diagnosis::distance::KeptRows;
use crate::diagnosis::nullspace_probe::{RandomKeys, random_motions};
use crate::diagnosis::refined::SolveKept;
use crate::factor::backend::many::Slab;
use crate::factor::backend::{Backend, BackendError};
use crate::factor::block::Block;
use crate::factor::block::dependent::NO_PIVOT;
use crate::input::noise::SUSPECT;
use crate::input::numbering::LocalSystem;
use crate::input::scale::{Scaling, free, ldexp};
use crate::presolve::basis::{Basis, RowOrigin};

/// A sum that cancels to this fraction of its terms is zero.
const NOISE: f64 = 1e-11;

/// Fixed DOFs, ascending by the user's numbers.
#[derive(Default)]
pub(crate) struct Generated {
    /// The fixed DOFs in the user's numbers, with their values.
    pub values: Vec<(usize, f64)>,
    /// The fixed DOFs in local numbers.
    pub dofs: Vec<u32>,
}

/// The rounding error of coefficients: that of a sum of a hundred terms, as for suspect coefficients.
const ROUNDED: f64 = f64::EPSILON * (1_u64 << (SUSPECT + 52)) as f64;
/// A coefficient of at most 26 bits, half of those of a double, is exact: it is not the result of rounding.
const SHORT: u32 = 26;
/// The error of the solve is not less than this, beside motions of size 1: the rounding of sums of two doubles at distances from dependence
/// that cause no doubt.
const REST: f64 = f64::EPSILON * f64::EPSILON / NEAR;
/// Number of samples of y and of z each. A sample is 64 times smaller than typical with a probability of about 1/64, so all are with one of 4e-6.
const SAMPLES: usize = 3;
/// Number of solutions: that of the equations, and all samples.
const LANES: usize = 1 + 2 * SAMPLES;
/// Seeds of the signs of the samples.
const SEEDS: [u64; SAMPLES] = [0x243f_6a88, 0x1319_8a2e, 0x0370_7344];

/// The fixed DOFs among the slow ones, ascending by the user's numbers, and a solution of the kept equations; both are empty if no DOF is
/// slow.
///
/// The solution is computed in sums of two doubles. Elimination row by row in doubles can lose all digits of a DOF:
/// `1e-20 u_1 + u_2 = 0.1` leaves no digit of u_1 if u_2 is rounded to a double.
pub(crate) fn find(kept: &KeptRows, slow: &[(u32, bool)], keys: &RandomKeys) -> (Vec<u32>, Vec<f64>) {
    let (system, scaling) = (kept.system, kept.scaling);
    if slow.is_empty() {
        return Default::default();
    }
    let start: Slab<1> = random_motions(system, kept.basis, scaling, keys).into_iter().map(|u| [u]).collect();
    let none = |_| [0.0];
    let u = kept.complete(kept.solve(start.clone(), none), none);
    let rounded = |i: usize| free(system, i).filter(|&(_, v)| !is_short(v));
    let size = |i: usize| rounded(i).map(|(j, v)| (v * u[j][0]).abs()).sum();
    let error = |i: usize| free(system, i).map(|(j, v)| f64::EPSILON * (v * start[j][0]).abs()).sum();
    let sizes: Vec<[f64; 2]> = (0..system.equations()).map(|i| [size(i), error(i)]).collect();
    let sides = |i: usize| {
        let [[a, b, c], [d, e, f]] = sizes[i].map(|size| SEEDS.map(|seed| size * signed(seed, keys.row(i as u32))));
        [system.rhs()[i], a, b, c, d, e, f]
    };
    let mut start: Slab<LANES> = vec![[0.0; LANES]; system.dofs()];
    system.prescribed().iter().for_each(|&(j, value)| start[j][0] = value);
    let found = kept.complete(kept.solve(start, sides), sides);
    let largest = |lanes: &[f64]| lanes.iter().fold(0.0, |most: f64, y| most.max(y.abs()));
    let is_fixed = |&(j, rests): &(u32, bool)| {
        let (motion, found) = (u[j as usize][0].abs(), &found[j as usize]);
        let (y, z) = found[1..].split_at(SAMPLES);
        let error = (ROUNDED * largest(z)).max(ldexp(REST, scaling.col(j as usize)));
        motion <= ROUNDED * largest(y) || rests && motion <= error
    };
    let mut fixed: Vec<u32> = slow.iter().filter(|one| is_fixed(one)).map(|&(j, _)| j).collect();
    fixed.sort_unstable_by_key(|&j| system.numbering.dofs[j as usize]);
    let solution: Vec<f64> = found.into_iter().map(|[solution, ..]| solution).collect();
    let is_finite = solution.iter().all(|u| u.is_finite());
    (fixed, if is_finite { solution } else { kept.basis.particular(system, scaling) })
}

fn is_short(v: f64) -> bool {
    v.to_bits().trailing_zeros() >= f64::MANTISSA_DIGITS - SHORT
}

/// The values `G u_p + g` of fixed DOFs in the solution u.
pub(crate) fn evaluate(dofs: Vec<u32>, system: LocalSystem, u: &[f64]) -> Generated {
    let named = |&j: &u32| (system.numbering.dofs[j as usize] as usize, u[j as usize]);
    Generated { values: dofs.iter().map(named).collect(), dofs }
}

/// What remains of a vector after equations are subtracted, by DOF. The DOFs are sorted by the rows of the basis that define them
/// ([`times`]).
struct GeneratedRemainder {
    parts: BTreeMap<(u32, u32), f64>,
}

impl GeneratedRemainder {
    fn add(&mut self, time: u32, dof: u32, value: f64) {
        *self.parts.entry((time, dof)).or_default() += value;
    }
}

/// Expresses vectors, such as the unit vector `e_s` of a fixed DOF s, by the kept equations: `e_s = sum_i c_i row_i` over the free DOFs.
pub(crate) struct Explainer<'a> {
    pub system: LocalSystem<'a>,
    pub basis: &'a Basis,
    pub blocks: &'a [Block],
    pub history: &'a History,
    pub scaling: &'a Scaling,
    pub backend: &'a dyn Backend,
    /// For each DOF, the row of the basis that defines it: the result of [`times`].
    pub time: &'a [u32],
}

/// For each DOF, the row of the basis that defines it. For DOFs of block k, this is the number of rows plus k; for other masters and
/// prescribed DOFs, `u32::MAX`.
pub(crate) fn times(basis: &Basis, dofs: usize) -> Vec<u32> {
    let mut time = vec![u32::MAX; dofs];
    basis.slaves().iter().zip(0..).for_each(|(&slave, t)| time[slave as usize] = t);
    for (block, t) in basis.blocks.iter().zip(basis.rows() as u32..) {
        block.dofs.iter().for_each(|&j| time[j as usize] = t);
    }
    time
}

impl Explainer<'_> {
    /// Expresses a vector of free DOFs (local) as a combination of the kept equations, if it is one.
    pub fn because(&self, vector: impl IntoIterator<Item = (u32, f64)>) -> Result<Vec<CertificateTerm>, BackendError> {
        let parts = vector.into_iter().map(|(j, value)| ((self.time[j as usize], j), value)).collect();
        let mut rest = GeneratedRemainder { parts };
        let (mut own, mut of_steps, mut of_blocks) = (Vec::new(), Vec::new(), Vec::new());
        while let Some((&(time, dof), &value)) = rest.parts.first_key_value() {
            if time == u32::MAX {
                break;
            }
            match self.basis.origin(time as usize) {
                RowOrigin::Block(block) => of_blocks.extend(self.take_block(&mut rest, block)?),
                part => {
                    rest.parts.pop_first();
                    let t = time as usize;
                    let terms = self.basis.row(self.system, t).entries();
                    terms.for_each(|(j, v)| rest.add(self.time[j as usize], j, value * v));
                    if part == RowOrigin::Peeled {
                        let row = self.basis.peeled[t];
                        let coefficient = value / self.system.coefficient(row as usize, dof);
                        own.push(CertificateTerm { row: row as usize, coefficient });
                    } else {
                        let step = t - self.basis.peeled.len();
                        let pivot = ldexp(self.basis.pivot_of_step(step), -self.scaling.col(dof as usize));
                        of_steps.push((step as u32, value / pivot));
                    }
                }
            }
        }
        own.extend(self.history.combination(&of_steps, &of_blocks, 0));
        own.retain(|term| term.coefficient != 0.0);
        own.sort_unstable_by_key(|term| term.row);
        Ok(own)
    }

    /// Removes the remainder in all DOFs of one block at once, by solving `C_kept^T y = rest` with the kept rows of the block.
    fn take_block(&self, rest: &mut GeneratedRemainder, k: usize) -> Result<Vec<(u32, f64)>, BackendError> {
        let (block, solved) = (&self.blocks[k], &self.basis.blocks[k]);
        let mut right = vec![0.0; block.dofs.len()];
        for (position, &dof) in block.dofs.iter().enumerate() {
            if let Some(value) = rest.parts.remove(&(self.time[dof as usize], dof)) {
                right[position] = ldexp(value, self.scaling.col(dof as usize));
            }
        }
        let mut columns = Csr::empty(block.dofs.len());
        let kept: Vec<usize> = solved.rows.iter().filter_map(|row| block.rows.binary_search(row).ok()).collect();
        kept.iter().for_each(|&i| columns.append(block.matrix.row(i)));
        let factor = self.backend.factor(&columns, &right, NO_PIVOT)?;
        let y = factor.solved(&factor.rhs);
        let largest = y.iter().fold(0.0, |a: f64, v| a.max(v.abs()));
        let terms = y.iter().zip(&factor.order).filter(|(v, _)| v.abs() > NOISE * largest);
        Ok(terms.map(|(v, &i)| (block.rows[kept[i]], ldexp(*v, block.exponents[kept[i]]))).collect())
    }
}

//! Decides whether a matrix A is singular up to rounding. The measure is how far the unknowns move if each entry of A changes in its last
//! place. In each step, v is the vector of unknowns:
//!
//! ```text
//! v <- A^-1 (r |A| |v|),  g = max |v after| / max |v before|       random r in +-[1/2, 1], dimensionless
//! ```
//!
//! The growth g tends to the condition number of Skeel and Bauer, `| |A^-1| |A| |`: rounding of the entries of A changes x by a fraction of
//! about `g eps`. Units of rows and columns do not change g, and stiff parts on soft ones do not make it large. `|A|` holds the sizes of
//! the terms that were summed into A: a stiffness `0.1 + 0.2 - 0.3` has the size 0.6.
//!
//! If g is so large that rounding decides, v is refined to a null vector, `v <- v - M^-1 A v`, where M^-1 applies the computed factors. If
//! `|A v|` is rounding of `|A| max |v|` in every row, then a matrix that differs from A by rounding is singular (Rigal and Gaches).
//!
//! If the load is incompatible with a singular A, g can stay small, for example if the zero pattern alone makes A singular. The factors are
//! then not an inverse: `M^-1 A v` differs from v. Such a v is a candidate for a null vector, whatever g is.

use qless::{Form, Options, SystemBuilder, analyse};

use super::equations::{Equations, ROUNDING, Solve};
use super::matrix::{ScaledFactor, entries};
use super::{EnforceError, SolverError};
use crate::common::{ENTRY_ROUNDING, RandomForces};

/// Number of power iterations. The growth in the first one does not count, since it depends on the start vector.
const STEPS: usize = 2;
/// Largest number of refinements of a null vector.
const SHARPENINGS: usize = 6;
/// Growth above which a null vector is searched for. A singular A has a growth of at least `1 / ROUNDING`; one power step finds at least a
/// hundredth of it.
const SUSPICIOUS: f64 = 0.01 / ROUNDING;

/// Whether the model is supported.
pub enum SupportVerdict {
    /// The model is supported. The number is the growth of rounding.
    Supported(f64),
    /// A motion that is free, and the largest force that resists it, relative to its terms.
    Mechanism(Vec<f64>, f64),
}

/// Decides whether the model is supported; returns the error of `solve`, if there is one.
pub fn check_support(equations: &Equations, solve: &mut Solve<'_>) -> Result<SupportVerdict, EnforceError> {
    let (growth, candidates) = rounding_growth(equations, solve)?;
    if growth < SUSPICIOUS && candidates.len() < 2 {
        return Ok(SupportVerdict::Supported(growth));
    }
    let refined = candidates.into_iter().map(|v| refined_null_vector(equations, solve, v));
    let best = refined.min_by(|a, b| a.1.total_cmp(&b.1));
    Ok(match best {
        // A growth of 1 / ENTRY_ROUNDING leaves u without a correct digit.
        Some((motion, resistance)) if resistance <= ROUNDING || growth * ENTRY_ROUNDING >= 1.0 => {
            SupportVerdict::Mechanism(motion, resistance)
        }
        _ => SupportVerdict::Supported(growth),
    })
}

/// The growth g, and candidates for null vectors of A: the last iterate, and also the first one if the factors do not invert A.
fn rounding_growth(equations: &Equations, solve: &mut Solve<'_>) -> Result<(f64, Vec<Vec<f64>>), EnforceError> {
    let (mut v, mut growth, mut candidates) = (vec![1.0; equations.parts.len()], 0.0_f64, Vec::new());
    let mut random = RandomForces::default();
    for step in 0..STEPS {
        // A row without terms gets a force of size one, which reveals that it has no stiffness.
        let force = |size: f64| random.next() * if size > 0.0 { size } else { 1.0 };
        let forces: Vec<f64> = equations.size(&v).into_iter().map(force).collect();
        let y = solve(&forces)?;
        let largest = largest(&y);
        if largest == 0.0 {
            break;
        }
        if !largest.is_finite() {
            return Err(SolverError("the solution leaves the range of doubles".into()).into());
        }
        growth = if step == 0 { 1.0 } else { growth.max(largest) };
        v = y.iter().map(|y| y / largest).collect();
        if step == 0 && is_not_inverted(equations, solve, (&v, largest), &forces) {
            candidates.push(v.clone());
        }
    }
    candidates.push(v);
    Ok((growth, candidates))
}

/// Whether the factors are no inverse of A: `M^-1 A v` differs from the first iterate v, scaled to size one, by more than a half.
/// Refinement then diverges. This needs a solve only if the solution is huge or its residual is larger than half of the forces.
fn is_not_inverted(equations: &Equations, solve: &mut Solve<'_>, (v, size): (&[f64], f64), forces: &[f64]) -> bool {
    let off = |a: &[f64], b: &[f64]| largest(&a.iter().zip(b).map(|(a, b)| a - b).collect::<Vec<_>>());
    let product = equations.apply(v);
    let residual = off(&product, &forces.iter().map(|f| f / size).collect::<Vec<_>>());
    if size < SUSPICIOUS && residual * size <= 0.5 * largest(forces) {
        return false;
    }
    solve(&product).map_or(true, |again| off(&again, v) > 0.5)
}

/// A refined null vector, and the relative force that resists it.
fn refined_null_vector(equations: &Equations, solve: &mut Solve<'_>, mut v: Vec<f64>) -> (Vec<f64>, f64) {
    let mut best = unsupported_part(equations, &v);
    for _ in 0..SHARPENINGS {
        if best.1 <= f64::EPSILON {
            break;
        }
        let Ok(wrong) = solve(&equations.apply(&v)) else { break };
        v.iter_mut().zip(wrong).for_each(|(v, wrong)| *v -= wrong);
        let largest = largest(&v);
        if !(largest > 0.0 && largest.is_finite()) {
            break;
        }
        v.iter_mut().for_each(|v| *v /= largest);
        let found = unsupported_part(equations, &v);
        if found.1 < best.1 {
            best = found;
        }
    }
    best
}

/// Restricts v to the connected parts without support, and returns the largest `|A v|_i / (|A| |v'|)_i` there, where every entry of v' is
/// as large as the largest of its part. If all parts are supported, restricts v to the part with the weakest support.
fn unsupported_part(equations: &Equations, v: &[f64]) -> (Vec<f64>, f64) {
    let levels = equations.levelled(v);
    let (residual, size, parts) = (equations.apply(v), equations.size(&levels), &equations.parts);
    let mut worst = vec![f64::INFINITY; v.len()];
    (0..v.len()).filter(|&j| levels[j] > 0.0).for_each(|j| worst[parts[j]] = 0.0);
    for (i, residual) in residual.iter().enumerate().filter(|(_, residual)| **residual != 0.0) {
        worst[parts[i]] = worst[parts[i]].max(residual.abs() / size[i]);
    }
    let limit = worst.iter().copied().fold(f64::INFINITY, f64::min).max(ROUNDING);
    let of_part = |(v, &part): (&f64, &usize)| if worst[part] <= limit { *v } else { 0.0 };
    let most = worst.iter().copied().filter(|worst| *worst <= limit).fold(0.0, f64::max);
    (v.iter().zip(parts).map(of_part).collect(), most)
}

fn largest(x: &[f64]) -> f64 {
    x.iter().fold(0.0, |most: f64, x| most.max(x.abs()))
}

/// Finds the free motion of a model whose factorization failed, and the relative force that resists it. It tries LU of A, which has other
/// pivots, and then a rank-revealing elimination with the rows of A as equations. The first `dofs` unknowns are DOFs, one of which must
/// move.
pub fn free_motion(equations: &Equations, dofs: usize) -> Option<(Vec<f64>, f64)> {
    let n = equations.parts.len();
    if let Ok(mut factor) = ScaledFactor::new(&equations.a, vec![0; n], false)
        && let Ok(SupportVerdict::Mechanism(motion, resistance)) = check_support(equations, &mut |r| factor.solve(r))
    {
        return Some((motion, resistance));
    }
    let mut rows = vec![Vec::new(); n];
    entries(&equations.a).for_each(|(i, j, v)| rows[i].push((j, v)));
    let mut builder = SystemBuilder::new(n);
    rows.into_iter().for_each(|row| {
        builder.equation(row, 0.0);
    });
    let reduction = analyse(&builder.build().ok()?, &Options::default()).ok()?.reduction_in(Form::Explicit).ok()?;
    let mode = |master: usize| {
        let mut masters = vec![0.0; reduction.masters().len()];
        masters[master] = 1.0;
        let (motion, resistance) = unsupported_part(equations, &reduction.expand(&masters, &[]).ok()?);
        (resistance <= ROUNDING && motion[..dofs].iter().any(|u| *u != 0.0)).then_some((motion, resistance))
    };
    (0..reduction.masters().len()).find_map(mode)
}

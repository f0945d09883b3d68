//! A problem that shows the effect of a reduction on a solution: `K u + C^T lambda = f`, `C u = b`, with `K = I + L`.
//!
//! L are springs of stiffness 1 from each DOF to the next, `f_j = 1 + j mod 7`. The solution u* is computed with a multiplier for each
//! independent equation ([`Saddle`]; in large systems [`with_multipliers`]), so it needs no T. It is refined with
//! residuals in twice the precision, and is therefore exact to rounding even if equations are nearly dependent.

use faer::linalg::solvers::Solve;
use faer::sparse::linalg::solvers::Lu;
use faer::sparse::{SparseColMat, Triplet};
use faer::{Col, ColRef};
use qless::{ConstraintSystem, Kind, Options, SystemBuilder, analyse};

use super::chain::Chain;
use super::gradients::{with_masters, with_multipliers};
use super::run::Done;

/// Largest number of DOFs for sparse LU, which takes minutes for more; larger systems are solved by conjugate gradients.
const MOST_DOFS: usize = 3_000;
/// Largest number of entries of T; with more, `T^T K T` may be dense.
const MOST_ENTRIES: usize = 200_000;
/// Limit for the steps of refinement.
const STEPS: usize = 20;
/// Refinement ends after a step of at most this relative size.
const SETTLED: f64 = 4.0 * f64::EPSILON;

/// The loads f and the solution u*.
pub struct Springs {
    f: Vec<f64>,
    /// The solution u*.
    pub solution: Vec<f64>,
    prescribed: Vec<f64>,
}

impl Springs {
    /// The problem for a system of this rank; `None` if qless finds another rank, or if u* cannot be computed, for example because
    /// conjugate gradients do not converge.
    pub fn new(system: &ConstraintSystem, rank: usize) -> Option<Self> {
        Self::solved(system, rank, system.dofs() <= MOST_DOFS)
    }

    fn solved(system: &ConstraintSystem, rank: usize, by_factors: bool) -> Option<Self> {
        let analysis = analyse(system, &Options::default()).ok().filter(|analysis| analysis.rank() == rank)?;
        let rows: Vec<usize> = (0..system.equations()).filter(|&i| analysis.kinds()[i] == Kind::Independent).collect();
        let kept = with_rows(system, &rows);
        let (mut free, mut u) = (vec![true; system.dofs()], vec![0.0; system.dofs()]);
        system.prescribed().iter().for_each(|&(j, value)| (free[j], u[j]) = (false, value));
        let (chain, f) = (Chain::new(free), forces(system.dofs()));
        let saddle = if by_factors { Some(Saddle::new(&chain, &kept)?) } else { None };
        let step = |left: &[f64], apart: &[f64]| match &saddle {
            Some(saddle) => Some(saddle.solve(left, apart)),
            None => with_multipliers(&chain, &kept, left, apart),
        };
        let solution = refined(&f, &kept, (u, vec![0.0; rows.len()]), step)?;
        let prescribed = system.prescribed().iter().map(|&(_, value)| value).collect();
        Some(Self { f, solution, prescribed })
    }

    /// `max |u - u*| / max |u*|` with u from T, G and g ([`with_masters`]); `None` if T has too many entries, or if there is no T or no u.
    pub fn error(&self, done: &Done) -> Option<f64> {
        let reduction = done.reduction.as_ref()?;
        if reduction.t().nnz() > MOST_ENTRIES {
            return None;
        }
        let u = with_masters(&self.f, reduction, &self.prescribed)?;
        let off = largest(u.iter().zip(&self.solution).map(|(u, exact)| u - exact));
        Some(off / largest(self.solution.iter().copied()))
    }
}

fn largest(x: impl Iterator<Item = f64>) -> f64 {
    x.fold(0.0, |most, v| most.max(v.abs()))
}

/// Corrections of u and of the multipliers for the residuals of both equations.
type SpringStep = (Vec<f64>, Vec<f64>);

/// Refines u until it no longer changes; `None` without convergence.
fn refined(
    f: &[f64],
    system: &ConstraintSystem,
    (mut u, mut lambda): SpringStep,
    step: impl Fn(&[f64], &[f64]) -> Option<SpringStep>,
) -> Option<Vec<f64>> {
    for _ in 0..STEPS {
        let (left, apart) = residuals(system, f, &u, &lambda);
        let (du, dl) = step(&left, &apart)?;
        u.iter_mut().zip(&du).for_each(|(u, du)| *u += du);
        lambda.iter_mut().zip(dl).for_each(|(l, dl)| *l += dl);
        if largest(du.iter().copied()) <= SETTLED * largest(u.iter().copied()) {
            return Some(u);
        }
    }
    None
}

/// The loads `f_j = 1 + j mod 7`.
fn forces(dofs: usize) -> Vec<f64> {
    (0..dofs).map(|j| 1.0 + (j % 7) as f64).collect()
}

/// The factors of `[K C^T; C 0]` on the free DOFs; the other DOFs do not move.
struct Saddle {
    factors: Lu<usize, f64>,
    free: Vec<bool>,
}

impl Saddle {
    fn new(chain: &Chain, kept: &ConstraintSystem) -> Option<Self> {
        let (free, n) = (chain.free().to_vec(), kept.dofs());
        let size = n + kept.equations();
        let is_free = |j: usize| j >= n || free[j];
        let ground = (0..n).map(|j| (j, j, 1.0));
        let springs = (1..n).flat_map(|j| [(j - 1, j - 1, 1.0), (j, j, 1.0), (j - 1, j, -1.0), (j, j - 1, -1.0)]);
        let rows = (0..kept.equations()).flat_map(|i| kept.matrix().row(i).map(move |(j, v)| (n + i, j, v)));
        let both = rows.flat_map(|(i, j, v)| [(i, j, v), (j, i, v)]);
        let terms = ground.chain(springs).chain(both).filter(|&(i, j, _)| i == j || (is_free(i) && is_free(j)));
        let terms: Vec<_> = terms.map(|(i, j, v)| Triplet::new(i, j, v)).collect();
        let matrix = SparseColMat::try_new_from_triplets(size, size, &terms).ok()?;
        Some(Self { factors: matrix.sp_lu().ok()?, free })
    }

    /// Solves `K du + C^T dl = left`, `C du = apart` for du and dl.
    fn solve(&self, left: &[f64], apart: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let n = left.len();
        let left = left.iter().zip(&self.free).map(|(&left, &free)| if free { left } else { 0.0 });
        let right: Vec<f64> = left.chain(apart.iter().copied()).collect();
        let mut solution: Col<f64> = ColRef::from_slice(&right).to_owned();
        self.factors.solve_in_place(solution.as_mat_mut());
        let values: Vec<f64> = solution.iter().copied().collect();
        (values[..n].to_vec(), values[n..].to_vec())
    }
}

/// The system with the equations `rows` only.
pub fn with_rows(system: &ConstraintSystem, rows: &[usize]) -> ConstraintSystem {
    let mut builder = SystemBuilder::new(system.dofs());
    rows.iter().for_each(|&i| _ = builder.equation(system.matrix().row(i), system.rhs()[i]));
    system.prescribed().iter().for_each(|&(dof, value)| builder.prescribe(dof, value));
    // A subset of a valid system is valid.
    builder.build().expect("part of a valid system")
}

/// The residuals `f - K u - C^T lambda` and `b - C u`, in twice the precision.
fn residuals(system: &ConstraintSystem, f: &[f64], u: &[f64], lambda: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let n = u.len();
    let mut left: Vec<Twice> = f.iter().map(|&f| Twice(f, 0.0)).collect();
    for j in 0..n {
        left[j].subtract(1.0, u[j]);
        for other in [j.checked_sub(1), Some(j + 1).filter(|&other| other < n)].into_iter().flatten() {
            left[j].subtract(1.0, u[j]);
            left[j].subtract(-1.0, u[other]);
        }
    }
    let mut apart: Vec<Twice> = system.rhs().iter().map(|&b| Twice(b, 0.0)).collect();
    for (i, apart) in apart.iter_mut().enumerate() {
        for (j, v) in system.matrix().row(i) {
            apart.subtract(v, u[j]);
            left[j].subtract(v, lambda[i]);
        }
    }
    let rounded = |sums: Vec<Twice>| sums.into_iter().map(|Twice(high, low)| high + low).collect();
    (rounded(left), rounded(apart))
}

/// A sum in twice the precision: the value is the sum of both numbers.
struct Twice(f64, f64);

impl Twice {
    /// Subtracts `a b`; the rounding errors of the product and of the sum are added to the second number.
    fn subtract(&mut self, a: f64, b: f64) {
        let product = -a * b;
        let lost = (-a).mul_add(b, -product);
        let sum = self.0 + product;
        let part = sum - self.0;
        self.1 += (self.0 - (sum - part)) + (product - part) + lost;
        self.0 = sum;
    }
}

#[cfg(test)]
mod tests {
    use qless::{Options, SystemBuilder, analyse};

    use super::super::run::Done;
    use super::{Springs, Twice};

    #[test]
    fn a_sum_keeps_what_a_double_loses() {
        let left = |terms: &[(f64, f64)]| {
            let mut sum = Twice(1.0, 0.0);
            terms.iter().for_each(|&(a, b)| sum.subtract(a, b));
            sum.0 + sum.1
        };
        assert_eq!(left(&[(1.0 + f64::EPSILON, 1.0 - f64::EPSILON)]), f64::EPSILON * f64::EPSILON);
        assert_eq!(left(&[(-1e17, 1.0), (1e17, 1.0)]), 1.0);
    }

    /// `u0 = u1`, `u1 = (1 + eps) u2`, `u0 = u2 + eps`: the difference of the last two gives `eps u2 = eps`.
    #[test]
    fn the_solution_is_right_where_equations_are_nearly_dependent() {
        let eps = f64::powi(2.0, -24);
        let mut builder = SystemBuilder::new(3);
        builder.equation([(0, 1.0), (1, -1.0)], 0.0);
        builder.equation([(1, 1.0), (2, -1.0 - eps)], 0.0);
        builder.equation([(0, 1.0), (2, -1.0)], eps);
        let system = builder.build().expect("valid");
        let springs = Springs::new(&system, 3).expect("small");
        let exact = [1.0 + eps, 1.0 + eps, 1.0];
        for (found, exact) in springs.solution.iter().zip(exact) {
            assert!((found - exact).abs() <= 4.0 * f64::EPSILON, "{found} for {exact}");
        }
        let good = analyse(&system, &Options::default()).expect("valid").reduction().expect("within the gate");
        let lists = [good.slaves(), good.masters(), good.prescribed()].map(<[usize]>::to_vec);
        let g = good.g().iter().map(|g| g * 1.5).collect();
        let reduction = qless::Reduction::from_parts(lists, good.t().clone(), good.g_matrix().clone(), g);
        let reduction = reduction.expect("of the same DOFs");
        let error =
            springs.error(&Done { time: 0.0, rank: 0, reduction: Some(reduction), analysis: None }).expect("small");
        // The deviation from 0.5 is at most the condition of the equations, about 1e8, times rounding.
        assert!((error - 0.5).abs() < 1e-7, "{error}");
    }

    /// The solution of the same equations is the same with a factorization and with conjugate gradients.
    #[test]
    fn large_systems_have_the_same_solution() {
        let ring = qless_scenes::families::cycle(60, 0.0).expect("a scene").system;
        let grid = qless_scenes::families::grid_2d(12, 12).expect("a scene").system;
        let mut builder = SystemBuilder::new(9);
        builder.equation([(0, 1.0), (4, -2.0), (5, 3.0)], 0.5);
        builder.equation([(1, 1e3), (4, -2e3), (8, 5e2)], 2.0);
        builder.prescribe(5, 0.25);
        builder.prescribe(2, -1.0);
        let held = builder.build().expect("valid");
        for system in [ring, grid, held] {
            let analysis = analyse(&system, &Options::default()).expect("valid");
            let [small, large] =
                [true, false].map(|factors| Springs::solved(&system, analysis.rank(), factors).expect("solved"));
            let size = small.solution.iter().fold(0.0, |most: f64, u| most.max(u.abs()));
            let off = small.solution.iter().zip(&large.solution).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(off <= 1e-15 * size, "{off:e} of {size}");
            let reduction = analysis.reduction().expect("within the gate");
            let done = Done { time: 0.0, rank: 0, reduction: Some(reduction), analysis: None };
            let errors = [small, large].map(|springs| springs.error(&done).expect("sparse"));
            assert!(errors.iter().all(|error| *error < 1e-13), "{errors:?}");
        }
    }
}

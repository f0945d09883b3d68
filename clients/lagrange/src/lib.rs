//! `[K C^T; C 0] [u; lambda] = [f; b]` by sparse LU: what the clients are checked against.
//!
//! C holds the equations that are independent, and `u_p = ...` for the prescribed DOFs, whose multipliers are the reactions with their
//! signs turned. Nothing is taken from the map but which equations are independent: no T, no slaves, no condensed matrix.

use faer::Mat;
use faer::prelude::Solve;
use faer::sparse::linalg::solvers::Lu;
use faer::sparse::{SparseColMat, Triplet};
use qless::{Kind, Elimination};

/// How far results may be from one another, relative to the largest.
pub const TOLERANCE: f64 = 1e-10;

/// The saddle-point matrix and its factors.
pub struct Lagrange {
    matrix: SparseColMat<usize, f64>,
    lu: Lu<usize, f64>,
    independent: Vec<usize>,
    dofs: usize,
    equations: usize,
}

/// What the map's results are compared with.
pub struct Expected {
    /// All DOFs.
    pub u: Vec<f64>,
    /// By equation; zero where it is dependent.
    pub multipliers: Vec<f64>,
    /// In the order of the prescribed DOFs.
    pub reactions: Vec<f64>,
}

impl Lagrange {
    /// Factors, for the entries `(row, column, value)` of all of K.
    pub fn new(map: &Elimination, k: impl IntoIterator<Item = (usize, usize, f64)>) -> Result<Self, String> {
        let (n, kinds, system) = (map.dofs(), map.kinds(), map.analysis().expect("made from equations").system());
        let independent: Vec<usize> = (0..kinds.len()).filter(|&i| kinds[i] == Kind::Independent).collect();
        let mut entries: Vec<_> = k.into_iter().map(|(i, j, v)| Triplet::new(i, j, v)).collect();
        let mut border =
            |i: usize, j: usize, v: f64| entries.extend([Triplet::new(n + i, j, v), Triplet::new(j, n + i, v)]);
        for (row, &i) in independent.iter().enumerate() {
            system.matrix().row(i).for_each(|(j, v)| border(row, j, v));
        }
        let given = map.prescribed().iter().enumerate();
        given.for_each(|(p, &j)| border(independent.len() + p, j, 1.0));
        let size = n + independent.len() + map.prescribed().len();
        let matrix = SparseColMat::try_new_from_triplets(size, size, &entries).map_err(|error| format!("{error:?}"))?;
        let lu = matrix.sp_lu().map_err(|error| format!("the saddle-point matrix: {error:?}"))?;
        Ok(Self { matrix, lu, independent, dofs: n, equations: kinds.len() })
    }

    /// Solves, with one step of refinement, for forces, right-hand sides by equation, and prescribed values.
    pub fn solve(&self, f: &[f64], rhs: impl Fn(usize) -> f64, prescribed: &[f64]) -> Expected {
        let constants = self.independent.iter().map(|&i| rhs(i)).chain(prescribed.iter().copied());
        let b: Vec<f64> = f.iter().copied().chain(constants).collect();
        let b = Mat::from_fn(b.len(), 1, |i, _| b[i]);
        let first = self.lu.solve(&b);
        let x = &first + self.lu.solve(&b - &self.matrix * &first);
        let x: Vec<f64> = x.col(0).iter().copied().collect();
        let mut multipliers = vec![0.0; self.equations];
        self.independent.iter().zip(&x[self.dofs..]).for_each(|(&i, &lambda)| multipliers[i] = lambda);
        let reactions = x[self.dofs + self.independent.len()..].iter().map(|v| -v).collect();
        Expected { u: x[..self.dofs].to_vec(), multipliers, reactions }
    }
}

/// The largest difference, relative to the largest number; an error if it is more than [`TOLERANCE`], no number, or if all that is
/// expected is zero, which would say nothing.
pub fn agree(what: &str, found: &[f64], expected: &[f64]) -> Result<f64, String> {
    if found.len() != expected.len() {
        return Err(format!("{what}: {} numbers for {}", found.len(), expected.len()));
    }
    let largest = expected.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
    let differences = found.iter().zip(expected).map(|(a, b)| (a - b).abs());
    // `max` would lose a NaN.
    let worst = differences.fold(0.0, |most: f64, d| if most.is_nan() || d <= most { most } else { d }) / largest;
    if worst <= TOLERANCE { Ok(worst) } else { Err(format!("{what}: off by {worst:e} of the largest, {largest:e}")) }
}

#[test]
fn only_what_agrees_does() {
    assert_eq!(agree("u", &[1.0, -2.0], &[1.0, -2.0]), Ok(0.0));
    let refused = |found: &[f64], expected: &[f64]| assert!(agree("u", found, expected).is_err(), "{found:?}");
    refused(&[1.0, 2.0 + 1e-9], &[1.0, 2.0]);
    refused(&[f64::NAN, 2.0], &[1.0, 2.0]);
    refused(&[1.0, f64::NAN], &[1.0, 2.0]);
    refused(&[1.0], &[1.0, 2.0]);
    refused(&[0.0], &[0.0]);
}

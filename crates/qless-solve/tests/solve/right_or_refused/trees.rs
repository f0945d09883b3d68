//! Trees of ties whose DOFs have very different units. Each tie is well-conditioned, but chains of them look nearly dependent.

use faer::sparse::{SparseColMat, Triplet};
use qless::elimination::View;
use qless::{ConstraintSystem, Elimination, Options, SystemBuilder};
use qless_solve::enforce::{EnforceError, Llt, Problem, Steps};

use super::Random;
use crate::linkages::Outcome;

const TREES: usize = 4_000;

/// Terms, value, and exponent of the row's unit, a power of two.
pub type Tie = (Vec<(usize, f64)>, f64, i32);

/// Ties that `right` satisfies, with the exponent of each DOF's unit.
pub struct Tree {
    pub rows: Vec<Tie>,
    pub units: Vec<i32>,
    pub right: Vec<f64>,
}

impl Tree {
    pub fn new(seed: usize) -> Self {
        let mut random = Random::new(seed);
        let n = 2 + random.below(9);
        let mut order: Vec<usize> = (0..n).collect();
        (1..n).rev().for_each(|i| order.swap(i, random.below(i + 1)));
        // Every second tree has mostly zeros, and coefficients that are not whole.
        let (is_whole, mut right) = (seed.is_multiple_of(2), vec![0.0; n]);
        let values = right.iter_mut().filter(|_| is_whole || random.below(3) == 0).collect::<Vec<_>>();
        values.into_iter().for_each(|value| *value = random.below(7) as f64 - 3.0);
        let mut rows = Vec::new();
        for i in 0..n {
            let whole = |random: &mut Random| [1.0, -1.0, 1.0, 2.0, -3.0][random.below(5)];
            let mut factor = || if is_whole { whole(&mut random) } else { random.between(0.3, 3.0) };
            let mut terms = vec![(order[i], factor())];
            if i > 0 {
                terms.push((order[i - 1], factor()));
            }
            let value = terms.iter().map(|&(j, v)| v * right[j]).sum();
            let power = random.below(41) as i32 - 20;
            if random.below(10) > 0 {
                rows.push((terms, value, power));
            }
        }
        (1..rows.len()).rev().for_each(|i| rows.swap(i, random.below(i + 1)));
        let units = (0..n).map(|_| random.below(41) as i32 - 20).collect();
        Self { rows, units, right }
    }

    pub fn system(&self) -> Outcome<ConstraintSystem> {
        let mut builder = SystemBuilder::new(self.units.len());
        for (terms, value, power) in &self.rows {
            let terms = terms.iter().map(|&(j, v)| (j, v * 2_f64.powi(power - self.units[j])));
            builder.equation(terms, value * 2_f64.powi(*power));
        }
        Ok(builder.build()?)
    }

    /// Springs of stiffness one in the units of the DOFs, unloaded where all ties hold, plus loads of one.
    pub fn model(&self) -> (Vec<f64>, Vec<f64>) {
        let inverse = self.units.iter().map(|unit| 2_f64.powi(-unit));
        let stiffness = inverse.clone().map(|v| v * v).collect();
        (stiffness, inverse.zip(&self.right).map(|(v, right)| v * (right + 1.0)).collect())
    }

    /// The largest gap of a tie, dimensionless.
    fn gap(&self, u: &[f64]) -> f64 {
        let plain: Vec<f64> = u.iter().zip(&self.units).map(|(u, unit)| u * 2_f64.powi(-unit)).collect();
        let gap = |(terms, value, _): &Tie| (terms.iter().map(|&(j, v)| v * plain[j]).sum::<f64>() - value).abs();
        self.rows.iter().map(gap).fold(0.0, |most, gap| if gap > most || gap.is_nan() { gap } else { most })
    }
}

/// A solution satisfies every tie, also those that the analysis takes for redundant. Few models are refused, and none because of a rounded
/// zero.
#[test]
fn every_tie_holds_or_the_model_is_refused() -> Outcome {
    let (mut solved, mut doubted) = (0, 0);
    for seed in 0..TREES {
        let tree = Tree::new(seed);
        let (system, (k, f)) = (tree.system()?, tree.model());
        let n = k.len();
        let diagonal: Vec<_> = k.iter().enumerate().map(|(j, &k)| Triplet::new(j, j, k)).collect();
        let matrix = SparseColMat::try_new_from_triplets(n, n, &diagonal)?;
        let mut check = |name: &str, u: Result<Vec<f64>, EnforceError>| match u {
            Ok(u) => {
                assert!(tree.gap(&u) < 1e-6, "seed {seed}, {name}: a tie is open by {:e}", tree.gap(&u));
                solved += 1;
            }
            Err(error @ EnforceError::OutOfBalance { .. }) => panic!("seed {seed}, {name}: {error}"),
            Err(_) => doubted += 1,
        };
        match Problem::new(&matrix, &f, &system) {
            Ok(problem) => {
                check("transformation", problem.transformation().map(|solution| solution.u));
                check("lagrange", problem.lagrange().map(|solution| solution.u));
                check("penalty", problem.penalty(1e9, 1e-7).map(|solution| solution.u));
            }
            Err(error) => check("problem", Err(error)),
        }
        check("steps", by_steps(&system, &k, &f));
    }
    assert!(doubted * 50 < solved, "{doubted} refused, {solved} solved");
    Ok(())
}

fn by_steps(system: &ConstraintSystem, k: &[f64], f: &[f64]) -> Result<Vec<f64>, EnforceError> {
    let (starts, index): (Vec<usize>, Vec<usize>) = ((0..=k.len()).collect(), (0..k.len()).collect());
    let map = Elimination::new(system, &Options::default())?;
    let mut u = vec![0.0; k.len()];
    Steps::new(map, View::columns(&starts, &index), Llt::default())?.solve(k, f, &mut u)?;
    Ok(u)
}

//! A penalty is refused for its error: the relative error of u, recomputed from the dimensionless `[K C^T; C -1/D]`.

use faer::Mat;
use faer::prelude::Solve;
use faer::sparse::{SparseColMat, Triplet};
use qless_solve::enforce::{EnforceError, Problem};

use super::trees::Tree;
use crate::linkages::Outcome;

const TREES: usize = 2_000;
const FACTOR: f64 = 1e9;
const ACCURACY: f64 = 1e-7;
/// Factor by which an estimate may be wrong.
const MARGIN: f64 = 1.01;
/// Largest difference of two solutions with numbers near one.
const ROUNDING: f64 = 1e-12;

/// u for unit stiffness, with exact ties or with springs of this factor.
fn displacements(tree: &Tree, factor: Option<f64>) -> Vec<f64> {
    let (n, m) = (tree.units.len(), tree.rows.len());
    let (mut a, mut b) = (Mat::<f64>::zeros(n + m, n + m), Mat::<f64>::zeros(n + m, 1));
    (0..n).for_each(|j| (a[(j, j)], b[(j, 0)]) = (1.0, tree.right[j] + 1.0));
    for (row, (terms, value, _)) in tree.rows.iter().enumerate() {
        terms.iter().for_each(|&(j, v)| (a[(n + row, j)], a[(j, n + row)]) = (v, v));
        b[(n + row, 0)] = *value;
        // Units of rows cancel. Those of DOFs do not, since k and |C|^2 are of the given numbers.
        let inverse = |j: usize| 2_f64.powi(-tree.units[j]);
        let near = terms.iter().map(|&(j, _)| inverse(j).powi(2)).fold(0.0, f64::max);
        let square: f64 = terms.iter().map(|&(j, v)| (v * inverse(j)).powi(2)).sum();
        a[(n + row, n + row)] = factor.map_or(0.0, |factor| -square / (factor * near));
    }
    let factors = a.col_piv_qr();
    let mut x = factors.solve(&b);
    for _ in 0..4 {
        x = &x + factors.solve(&b - &a * &x);
    }
    (0..n).map(|j| x[(j, 0)]).collect()
}

/// The relative error of u in each part. If the loads alone would cause a larger u, the error is relative to that.
fn cost(tree: &Tree) -> f64 {
    let (exact, soft) = (displacements(tree, None), displacements(tree, Some(FACTOR)));
    let n = exact.len();
    let mut part: Vec<usize> = (0..n).collect();
    for (terms, ..) in (0..n).flat_map(|_| &tree.rows) {
        let least = terms.iter().map(|&(j, _)| part[j]).min().unwrap_or(0);
        terms.iter().for_each(|&(j, _)| part[j] = least);
    }
    let of_part = |name: usize| {
        let largest = |size: &dyn Fn(usize) -> f64| (0..n).filter(|&j| part[j] == name).map(size).fold(0.0, f64::max);
        let off = largest(&|j| (soft[j] - exact[j]).abs());
        if off > ROUNDING { off / largest(&|j| exact[j].abs().max((tree.right[j] + 1.0).abs())) } else { 0.0 }
    };
    (0..n).map(of_part).fold(0.0, f64::max)
}

#[test]
fn a_penalty_is_refused_for_what_it_costs() -> Outcome {
    let (mut solved, mut refused) = (0, 0);
    for seed in 0..TREES {
        let tree = Tree::new(seed);
        let (system, (k, f)) = (tree.system()?, tree.model());
        let diagonal: Vec<_> = k.iter().enumerate().map(|(j, &k)| Triplet::new(j, j, k)).collect();
        let matrix = SparseColMat::try_new_from_triplets(k.len(), k.len(), &diagonal)?;
        let Ok(problem) = Problem::new(&matrix, &f, &system) else { continue };
        let right = if problem.redundant().is_empty() { cost(&tree) } else { continue };
        match problem.penalty(FACTOR, ACCURACY) {
            Ok(_) => {
                assert!(right <= MARGIN * ACCURACY, "seed {seed}: {right:e}");
                solved += 1;
            }
            Err(EnforceError::PenaltyTooSmall { cost, .. }) => {
                assert!(
                    cost > ACCURACY && cost <= MARGIN * right && right <= MARGIN * cost,
                    "{seed}: {right:e}, {cost:e}"
                );
                refused += 1;
            }
            Err(other) => return Err(format!("seed {seed}: {other}").into()),
        }
    }
    assert!(solved > 1500 && refused > 50, "{solved} solved, {refused} refused");
    Ok(())
}

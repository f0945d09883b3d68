use crate::linkages::Outcome;

#[path = "../../examples/contact.rs"]
mod example;

use example::{Contact, Strips};

/// Solves a dense system by Gauss elimination with pivoting.
fn dense(mut a: Vec<Vec<f64>>, mut b: Vec<f64>) -> Vec<f64> {
    let n = b.len();
    for k in 0..n {
        let pivot = (k..n).max_by(|&i, &j| a[i][k].abs().total_cmp(&a[j][k].abs())).unwrap_or(k);
        a.swap(k, pivot);
        b.swap(k, pivot);
        for i in k + 1..n {
            let factor = a[i][k] / a[k][k];
            (k..n).for_each(|j| a[i][j] -= factor * a[k][j]);
            b[i] -= factor * b[k];
        }
    }
    for k in (0..n).rev() {
        b[k] = (b[k] - (k + 1..n).map(|j| a[k][j] * b[j]).sum::<f64>()) / a[k][k];
    }
    b
}

/// Among all sets of closed gaps, the one without negative gaps and pressures. It is unique, since K is positive definite.
fn by_trying_all(strips: &Strips) -> Option<(Vec<f64>, Vec<f64>)> {
    let (n, size) = (strips.dofs(), strips.stiffness);
    for closed in 0..1_usize << strips.upper {
        let active: Vec<usize> = (0..strips.upper).filter(|i| closed >> i & 1 == 1).collect();
        let total = n + active.len();
        let (mut a, mut b) = (vec![vec![0.0; total]; total], strips.loads());
        for (i, other, k) in strips.springs() {
            a[i][i] += k;
            if let Some(j) = other {
                a[j][j] += k;
                a[i][j] -= k;
                a[j][i] -= k;
            }
        }
        // -C^T p, and C u = -gap multiplied by the stiffness, so that all pivots have one size.
        for (row, &i) in (n..).zip(&active) {
            let (terms, gap) = strips.gap(i);
            for (j, v) in terms {
                a[row][j] = v * size;
                a[j][row] = -v * size;
            }
            b.push(-gap * size);
        }
        let x = dense(a, b);
        let mut pressures = vec![0.0; strips.upper];
        active.iter().zip(&x[n..]).for_each(|(&i, &p)| pressures[i] = p * size);
        let gap = |i: usize| {
            let (terms, gap) = strips.gap(i);
            terms.iter().map(|&(j, v)| v * x[j]).sum::<f64>() + gap
        };
        let open = (0..strips.upper).filter(|i| !active.contains(i)).all(|i| gap(i) >= 0.0);
        if open && pressures.iter().all(|&p| p >= 0.0) {
            return Some((x[..n].to_vec(), pressures));
        }
    }
    None
}

fn close(found: &[f64], truth: &[f64]) -> bool {
    let size = truth.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    found.iter().zip(truth).all(|(a, b)| (a - b).abs() <= 1e-10 * size)
}

/// Flat and curved strips, matching and non-matching meshes, light and heavy loads, several units: the solution of the quadratic program,
/// found by trying all active sets.
#[test]
fn contact_is_that_of_the_quadratic_program() -> Outcome {
    let (mut sizes, mut left) = (std::collections::BTreeSet::new(), 0);
    for (upper, lower) in [(7, 5), (6, 6), (8, 3), (5, 11)] {
        for (curvature, force) in [(0.05, 50.0), (0.02, 5.0), (0.2, 400.0), (-0.05, 20.0), (0.1, -3.0)] {
            for [length, unit] in [[1.0, 1.0], [1e6, 1.0], [1e-6, 1e6], [1.0, 1e-6]] {
                let strips = Strips {
                    upper,
                    lower,
                    length: 8.0 * length,
                    curvature: curvature / length,
                    stiffness: 1000.0 * unit / length,
                    force: force * unit,
                };
                let Contact { u, gaps, pressures, ranks } = strips.solve()?;
                let (truth, forces) = by_trying_all(&strips).ok_or("no active set is right")?;
                assert!(close(&u, &truth) && close(&pressures, &forces), "{upper}, {lower}, {curvature}, {force}");
                let closed = pressures.iter().filter(|&&p| p > 0.0).count();
                assert_eq!(ranks.last(), Some(&closed));
                assert!(gaps.iter().zip(&pressures).all(|(&gap, &p)| p > 0.0 || gap >= 0.0));
                sizes.insert(closed);
                left += usize::from(ranks.windows(2).any(|pair| pair[1] < pair[0]));
            }
        }
    }
    assert!(sizes.contains(&0) && sizes.len() > 3, "all active sets look alike: {sizes:?}");
    assert!(left > 0, "no node ever leaves the active set");
    Ok(())
}

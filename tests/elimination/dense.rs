//! Dense L and u_0, and random systems.

use qless::elimination::PrescribedDofs;
use qless::{ConstraintSystem, Elimination, Form, Options, SystemBuilder, analyse};
use qless_scenes::Rng;

/// Rows of numbers.
pub type Dense = Vec<Vec<f64>>;

/// A consistent system with some repeated equations and some prescribed DOFs.
pub fn random_system(rng: &mut Rng) -> ConstraintSystem {
    let n = 2 + rng.below(14);
    let mut builder = SystemBuilder::new(n);
    let u: Vec<f64> = (0..n).map(|_| rng.real() - 0.5).collect();
    for _ in 0..rng.below(n) {
        let mut terms: Vec<(usize, f64)> = Vec::new();
        for j in 0..n {
            if rng.below(n) < 3 {
                terms.push((j, [1.0, -1.0, 0.5, 2.0][rng.below(4)]));
            }
        }
        let b: f64 = terms.iter().map(|&(j, v)| v * u[j]).sum();
        builder.equation(terms.clone(), b);
        if rng.below(3) == 0 {
            builder.equation(terms.iter().map(|&(j, v)| (j, 2.0 * v)), 2.0 * b);
        }
    }
    for j in 0..n {
        if rng.below(5) == 0 {
            builder.prescribe(j, u[j]);
        }
    }
    builder.build().expect("a system")
}

/// Its elimination; `None` if rounding made equations conflict.
pub fn map_of(system: &ConstraintSystem, form: Form) -> Option<Elimination> {
    Elimination::from_analysis(analyse(system, &Options::default()).expect("small"), form).ok()
}

/// L and u_0 from [`Elimination::row`].
pub fn parts(map: &Elimination, given: PrescribedDofs) -> (Dense, Vec<f64>) {
    let n = map.dofs();
    let mut unknowns = map.masters().to_vec();
    if given == PrescribedDofs::Kept {
        unknowns.extend(map.prescribed());
        unknowns.sort_unstable();
    }
    let mut l = vec![vec![0.0; unknowns.len()]; n];
    let mut constant = vec![0.0; n];
    if given == PrescribedDofs::Eliminated {
        map.prescribed().iter().zip(map.prescribed_values()).for_each(|(&j, &v)| constant[j] = v);
    }
    unknowns.iter().enumerate().for_each(|(c, &j)| l[j][c] = 1.0);
    for &slave in map.slaves() {
        let (terms, g) = map.row(slave).expect("a slave");
        constant[slave] = g;
        for (j, v) in terms {
            match unknowns.binary_search(&j) {
                Ok(c) => l[slave][c] = v,
                Err(_) => constant[slave] += v * constant[j],
            }
        }
    }
    (l, constant)
}

/// `L^T K L` and `L^T (f - K u_0)`.
pub fn condensed(k: &Dense, f: &[f64], (l, constant): &(Dense, Vec<f64>)) -> (Dense, Vec<f64>) {
    let (n, q) = (l.len(), l.first().map_or(0, Vec::len));
    let mut k_q = vec![vec![0.0; q]; q];
    let mut f_q = vec![0.0; q];
    for i in 0..n {
        let stress: f64 = (0..n).map(|j| k[i][j] * constant[j]).sum();
        for a in 0..q {
            f_q[a] += l[i][a] * (f[i] - stress);
            for b in 0..q {
                k_q[a][b] += l[i][a] * (0..n).map(|j| k[i][j] * l[j][b]).sum::<f64>();
            }
        }
    }
    (k_q, f_q)
}

pub fn close(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-11 * (1.0 + a.abs().max(b.abs()))
}

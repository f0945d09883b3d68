//! `|C_i u - b_i| / (sum_j |C_ij| max_k s_k + |b_i|)` for T, G and g each on their own.
//!
//! s_k is the sum of the sizes of the parts that make u_k, and k runs over the DOFs connected with equation i by other
//! equations through free DOFs. DOFs are taken in units of one size.

use qless::{Analysis, ConstraintSystem, Kind, Reduction};
use qless_scenes::Rng;

/// The largest residual, its equation, and which of T, G and g it is of.
pub type Worst = (f64, usize, &'static str);

/// All DOFs for one part, with the sizes of what makes them.
struct Part {
    name: &'static str,
    u: Vec<f64>,
    size: Vec<f64>,
    /// 1 where b belongs to the part.
    constant: f64,
}

/// Of the independent equations, for some random u_q and u_p.
pub fn worst(system: &ConstraintSystem, units: &[f64], analysis: &Analysis, reduction: &Reduction, seed: u64) -> Worst {
    let component = components(system);
    let mut worst = (0.0, 0, "T");
    for part in parts(reduction, units.len(), seed) {
        let mut largest = vec![0.0_f64; system.equations()];
        for i in 0..system.equations() {
            let of = &mut largest[component[i]];
            system.matrix().row(i).for_each(|(j, _)| *of = of.max(part.size[j] * units[j]));
        }
        for i in (0..system.equations()).filter(|&i| analysis.kinds()[i] == Kind::Independent) {
            let b = part.constant * system.rhs()[i];
            let sum: f64 = system.matrix().row(i).map(|(j, v)| v * part.u[j]).sum();
            let weight: f64 = system.matrix().row(i).map(|(j, v)| (v / units[j]).abs()).sum();
            let residual = if sum == b { 0.0 } else { (sum - b).abs() / (weight * largest[component[i]] + b.abs()) };
            if residual.is_nan() || residual > worst.0 {
                worst = (if residual.is_nan() { f64::INFINITY } else { residual }, i, part.name);
            }
        }
    }
    worst
}

fn parts(reduction: &Reduction, dofs: usize, seed: u64) -> Vec<Part> {
    let mut rng = Rng::new(seed);
    let mut random = |n: usize| (0..n).map(|_| rng.real()).collect::<Vec<f64>>();
    let (masters, prescribed) = (random(reduction.masters().len()), random(reduction.prescribed().len()));
    let mut of_t = Part { name: "T", u: vec![0.0; dofs], size: vec![0.0; dofs], constant: 0.0 };
    let mut of_g = Part { name: "G", u: vec![0.0; dofs], size: vec![0.0; dofs], constant: 0.0 };
    let mut constant = Part { name: "g", u: vec![0.0; dofs], size: vec![0.0; dofs], constant: 1.0 };
    let set = |part: &mut Part, j: usize, terms: &mut dyn Iterator<Item = f64>| {
        (part.u[j], part.size[j]) = terms.fold((0.0, 0.0), |(u, size), term| (u + term, size + term.abs()));
    };
    reduction.masters().iter().zip(&masters).for_each(|(&j, &v)| set(&mut of_t, j, &mut std::iter::once(v)));
    reduction.prescribed().iter().zip(&prescribed).for_each(|(&j, &v)| set(&mut of_g, j, &mut std::iter::once(v)));
    for (i, &slave) in reduction.slaves().iter().enumerate() {
        set(&mut of_t, slave, &mut reduction.t().row(i).map(|(j, v)| v * masters[j]));
        set(&mut of_g, slave, &mut reduction.g_matrix().row(i).map(|(j, v)| v * prescribed[j]));
        set(&mut constant, slave, &mut std::iter::once(reduction.g()[i]));
    }
    vec![of_t, of_g, constant]
}

/// For each equation the first one that it is connected with.
fn components(system: &ConstraintSystem) -> Vec<usize> {
    let free = |j: usize| system.prescribed().binary_search_by_key(&j, |p| p.0).is_err();
    let mut label: Vec<usize> = (0..system.equations()).collect();
    let mut of_dof = vec![usize::MAX; system.dofs()];
    loop {
        let before = label.clone();
        for i in (0..system.equations()).chain((0..system.equations()).rev()) {
            let dofs = || system.matrix().row(i).map(|(j, _)| j).filter(|&j| free(j));
            let least = dofs().map(|j| of_dof[j]).fold(label[i], usize::min);
            label[i] = least;
            dofs().for_each(|j| of_dof[j] = least);
        }
        if label == before {
            return label;
        }
    }
}

//! A periodic cube of solid elements, half of it ten times stiffer, under a macroscopic strain: its mean stress.
//!
//! The pairs of opposite nodes make `3 n^2` equations per component, of which `3 n - 1` at edges and corners are redundant.
//! The example assembles the elements; the library finds the redundant equations. It compares the stress of the homogeneous cube with Hooke's
//! law, and that of the layered one with the rule of layers in series.
//!
//! `cargo run --release -p qless-solve --example periodic_cube`

use std::array::from_fn;

use faer::sparse::{SparseColMat, Triplet};
use qless::ConstraintSystem;
use qless_constraints::ConstraintSet;
use qless_constraints::types::{MacroStrain, Periodic, Point};
use qless_solve::enforce::Problem;

/// Nodes along an edge of the unit cube.
const NODES: usize = 7;
/// Lame's constants of the softer material.
const LAMBDA: f64 = 1.0;
const MU: f64 = 0.8;
/// Stretch across the layers.
const STRETCH: f64 = 0.01;

type Outcome<T> = Result<T, Box<dyn std::error::Error>>;

fn main() -> Outcome<()> {
    let soft = LAMBDA + 2.0 * MU;
    for (name, ratio) in [("one material", 1.0), ("two layers", 10.0)] {
        let k = stiffness(ratio)?;
        let system = constraints()?;
        let f = vec![0.0; system.dofs()];
        let problem = Problem::new(&k, &f, &system)?;
        let solution = problem.transformation()?;
        // sigma : E = 2 energy / volume, where only E_xx is nonzero.
        let energy: f64 = energy_twice(&k, &solution.u);
        let (stress, truth) = (energy / STRETCH, STRETCH * 2.0 / (1.0 / soft + 1.0 / (ratio * soft)));
        println!(
            "{name}: {} equations, {} redundant; stress {stress:.6e}, by theory {truth:.6e}",
            system.equations(),
            problem.redundant().len()
        );
        assert!((stress / truth - 1.0).abs() < 1e-9);
    }
    Ok(())
}

fn number([i, j, k]: [usize; 3]) -> usize {
    (k * NODES + j) * NODES + i
}

fn point(place: [usize; 3]) -> Point {
    let node = number(place);
    Point::new([3 * node, 3 * node + 1, 3 * node + 2], place.map(|p| p as f64 / (NODES - 1) as f64))
}

/// All pairs of opposite nodes; one corner is fixed.
fn constraints() -> Outcome<ConstraintSystem> {
    let mut builder = ConstraintSet::builder(3 * NODES.pow(3));
    let strain = MacroStrain::Given([[STRETCH, 0.0, 0.0], [0.0; 3], [0.0; 3]]);
    for face in 0..3 {
        for (i, j) in (0..NODES).flat_map(|i| (0..NODES).map(move |j| (i, j))) {
            let at = |end: usize| {
                let mut place = [i, j, j];
                (place[(face + 1) % 3], place[(face + 2) % 3], place[face]) = (i, j, end);
                place
            };
            let pair = Periodic { a: point(at(0)), b: point(at(NODES - 1)), strain };
            builder.add(format!("face {}, node ({i}, {j})", face + 1), pair)?;
        }
    }
    let set = builder.build()?;
    let mut evaluation = set.allocate();
    set.evaluate(&vec![0.0; set.dofs()], &mut evaluation)?;
    Ok(set.linearised(&evaluation, &[(0, 0.0), (1, 0.0), (2, 0.0)])?)
}

/// Bricks of eight nodes; the half with x above 1/2 is `ratio` times stiffer.
fn stiffness(ratio: f64) -> Outcome<SparseColMat<usize, f64>> {
    let cells = NODES - 1;
    let brick = brick(1.0 / cells as f64);
    let mut entries = Vec::new();
    for cell in 0..cells.pow(3) {
        let place = [cell % cells, cell / cells % cells, cell / cells / cells];
        let factor = if 2 * place[0] >= cells { ratio } else { 1.0 };
        let dof = |k: usize| 3 * number(from_fn(|axis| place[axis] + ((k / 3) >> axis & 1))) + k % 3;
        for (a, b) in (0..24).flat_map(|a| (0..24).map(move |b| (a, b))) {
            entries.push(Triplet::new(dof(a), dof(b), factor * brick[a][b]));
        }
    }
    let n = 3 * NODES.pow(3);
    Ok(SparseColMat::try_new_from_triplets(n, n, &entries)?)
}

/// `int lambda div u div v + 2 mu eps(u) : eps(v)` of a cube with edge length h, by Gauss's rule with two points per direction.
fn brick(h: f64) -> Vec<[f64; 24]> {
    let mut k = vec![[0.0; 24]; 24];
    for gauss in 0..8 {
        let xi: [f64; 3] = from_fn(|axis| 0.5 + if gauss >> axis & 1 == 1 { 0.5 } else { -0.5 } / 3.0_f64.sqrt());
        let gradient = |node: usize| -> [f64; 3] {
            let high = |axis: usize| node >> axis & 1 == 1;
            let value = |axis: usize| if high(axis) { xi[axis] } else { 1.0 - xi[axis] };
            let slope = |axis: usize| if high(axis) { 1.0 / h } else { -1.0 / h };
            from_fn(|axis| slope(axis) * value((axis + 1) % 3) * value((axis + 2) % 3))
        };
        let weight = h * h * h / 8.0;
        for (a, b) in (0..24).flat_map(|a| (0..24).map(move |b| (a, b))) {
            let (p, q, i, j) = (gradient(a / 3), gradient(b / 3), a % 3, b % 3);
            let same = if i == j { (0..3).map(|d| p[d] * q[d]).sum() } else { 0.0 };
            k[a][b] += weight * (LAMBDA * p[i] * q[j] + MU * (p[j] * q[i] + same));
        }
    }
    k
}

/// `u . K u`.
fn energy_twice(k: &SparseColMat<usize, f64>, u: &[f64]) -> f64 {
    let column = |j: usize| {
        let rows = k.symbolic().row_idx_of_col(j).zip(k.val_of_col(j));
        u[j] * rows.map(|(i, v)| v * u[i]).sum::<f64>()
    };
    (0..u.len()).map(column).sum()
}

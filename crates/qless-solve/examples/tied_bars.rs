//! The tie of the paper's Figure 1, with bars: four parts meet at the nodes D, F, I and L and are tied line to line, all around.
//!
//! Three equations per component suffice for the four nodes to move together; the four ties make four. A further tie lies between two fixed
//! nodes. The analysis finds, names and ignores both, and all methods give the same displacements.
//!
//! `cargo run -p qless-solve --example tied_bars`

use faer::sparse::{SparseColMat, Triplet};
use qless::ConstraintSystem;
use qless_constraints::ConstraintSet;
use qless_constraints::types::{LineTie, PlanarPoint};
use qless_solve::enforce::Problem;

/// `(name, coordinates)`: one square part in each quarter of the plane; its last corner lies at the centre.
const NODES: [(&str, [f64; 2]); 12] = [
    ("B", [-1.0, -1.0]),
    ("C", [0.0, -1.0]),
    ("D", [0.0, 0.0]),
    ("H", [0.0, -1.0]),
    ("G", [1.0, -1.0]),
    ("F", [0.0, 0.0]),
    ("K", [1.0, 1.0]),
    ("J", [0.0, 1.0]),
    ("I", [0.0, 0.0]),
    ("N", [0.0, 1.0]),
    ("M", [-1.0, 1.0]),
    ("L", [0.0, 0.0]),
];

/// Bars of each part, and the bars on the rim that keep its shape.
const BARS: [(usize, usize); 8] = [(0, 1), (0, 2), (3, 4), (4, 5), (6, 7), (6, 8), (9, 10), (10, 11)];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let system = constraints()?;
    let (k, f) = (stiffness()?, loads());
    let problem = Problem::new(&k, &f, &system)?;
    for &row in problem.redundant() {
        println!("redundant: {}", system.equation_label(row));
    }
    let truth = problem.transformation()?;
    let methods = [
        ("multipliers", problem.lagrange()?),
        ("mixed", problem.mixed(&problem.plan(4.0)?)?),
        ("augmented", problem.augmented(1e4, 1e-13)?),
        ("penalty 1e6", problem.penalty(1e6, 1e-3)?),
    ];
    for (name, solution) in methods {
        let off = solution.u.iter().zip(&truth.u).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
        println!("{name:>12}: differs from the transformation by {off:.1e}");
    }
    for node in [2, 5, 8, 11] {
        println!("{}: u = {:+.6}, {:+.6}", NODES[node].0, truth.u[2 * node], truth.u[2 * node + 1]);
    }
    Ok(())
}

fn point(node: usize) -> PlanarPoint {
    PlanarPoint::new([2 * node, 2 * node + 1], NODES[node].1)
}

/// Ties each line to the one on top of it; the outer nodes of the lower parts are fixed.
fn constraints() -> Result<ConstraintSystem, Box<dyn std::error::Error>> {
    let mut builder = ConstraintSet::builder(24);
    for (label, slave, master) in [
        ("line DC to line FH", [2, 1], [5, 3]),
        ("line F to line IJ", [5, 5], [8, 7]),
        ("line IJ to line LN", [8, 7], [11, 9]),
        ("line L to line DC", [11, 11], [2, 1]),
    ] {
        let mut slave = slave.map(point).to_vec();
        slave.dedup();
        builder.add(label, LineTie { slave, master: master.map(point).to_vec(), tolerance: 1e-9 })?;
    }
    let set = builder.build()?;
    let mut evaluation = set.allocate();
    set.evaluate(&[0.0; 24], &mut evaluation)?;
    let fixed: Vec<_> = [0, 1, 3, 4].into_iter().flat_map(|node| [(2 * node, 0.0), (2 * node + 1, 0.0)]).collect();
    Ok(set.linearised(&evaluation, &fixed)?)
}

/// Bars of stiffness 1 / length, and a soft bed that supports the remaining motions.
fn stiffness() -> Result<SparseColMat<usize, f64>, Box<dyn std::error::Error>> {
    let mut entries: Vec<_> = (0..24).map(|j| Triplet::new(j, j, 0.01)).collect();
    for (a, b) in BARS {
        let d: [f64; 2] = std::array::from_fn(|k| NODES[b].1[k] - NODES[a].1[k]);
        let length = d[0].hypot(d[1]);
        for (i, j, sign) in [(a, a, 1.0), (a, b, -1.0), (b, a, -1.0), (b, b, 1.0)] {
            for (p, q) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                entries.push(Triplet::new(2 * i + p, 2 * j + q, sign * d[p] * d[q] / length.powi(3)));
            }
        }
    }
    Ok(SparseColMat::try_new_from_triplets(24, 24, &entries)?)
}

/// The upper right part is pulled outwards.
fn loads() -> Vec<f64> {
    let mut f = vec![0.0; 24];
    (f[12], f[13]) = (0.1, 0.2);
    f
}

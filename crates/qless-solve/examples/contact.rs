//! Node-to-face contact: gaps `g(u) = C u - b >= 0`, pressures `p >= 0`, `p g = 0`, by an active set.
//!
//! A string on springs is pressed down on a curved rigid floor. Each of its nodes has the inequality "the gap is not negative". The result
//! minimises `u^T K u / 2 - f^T u` subject to `g(u) >= 0`.
//!
//! `cargo run -p qless-solve --example contact`

use faer::sparse::{SparseColMat, Triplet};
use qless_constraints::types::LinearEquation;
use qless_constraints::{ConstraintSet, Inequalities};
use qless_solve::enforce::Problem;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (nodes, stiffness, force) = (9, 1000.0, -60.0);
    let floor = |i: usize| -0.05 * (i as f64 - 4.0).powi(2);
    // Springs between neighbours, and soft ones to the ground.
    let spring = |i: usize| [(i, i, 1.0), (i + 1, i + 1, 1.0), (i, i + 1, -1.0), (i + 1, i, -1.0)];
    let springs = (0..nodes - 1).flat_map(spring).chain((0..nodes).map(|i| (i, i, 0.05)));
    let entries: Vec<_> = springs.map(|(i, j, k)| Triplet::new(i, j, stiffness * k)).collect();
    let k = SparseColMat::try_new_from_triplets(nodes, nodes, &entries)?;
    let loads = vec![force; nodes];

    let (mut set, mut contact) = (ConstraintSet::builder(nodes).build()?, Inequalities::default());
    for i in 0..nodes {
        contact.add(&mut set, format!("node {i}"), LinearEquation { terms: vec![(i, 1.0)], rhs: floor(i) })?;
    }
    let (u, multipliers) = contact.solve(&mut set, |set| -> Result<_, Box<dyn std::error::Error>> {
        let active = set.linearised_at(&vec![0.0; nodes], &[])?;
        let solution = Problem::new(&k, &loads, &active)?.lagrange()?;
        Ok((solution.u, set.by_constraint(&solution.multipliers)?))
    })?;

    for (i, (&node, u)) in contact.ids().iter().zip(&u).enumerate() {
        let pressure = -multipliers.of(node).first().copied().unwrap_or(0.0);
        println!("node {i}: gap {:9.2e}, contact force {pressure:9.4}", u - floor(i));
    }
    Ok(())
}

//! A parallelogram linkage with a redundant arm: which equations are redundant, where, and how Newton's method reaches a driven position.
//!
//! `cargo run -p qless-solve --example mechanism`

use qless_constraints::ConstraintSet;
use qless_constraints::types::{Distance, LinearEquation, OnSphere, PlanarPoint};
use qless_solve::newton::{NewtonOptions, redundancies, solve};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let set = linkage()?;
    let options = NewtonOptions::default();
    println!("{} coordinates, {} equations", set.dofs(), set.equations());

    // The crank moves by 0.6 in one step; the rest follows.
    let solution = solve(&set, &[0.0; 6], &[(0, 0.6)], &options)?;
    println!("{:>4} {:>11} {:>5}  left out", "step", "residual", "rank");
    for (step, iterate) in solution.iterates.iter().enumerate() {
        let names: Vec<String> = iterate.ignored.iter().map(|&row| set.label(row)).collect::<Result<_, _>>()?;
        println!("{step:>4} {:>11.3e} {:>5}  {}", iterate.residual, iterate.rank, names.join("; "));
    }
    println!("u = {:.6?}", solution.u);

    // Folded flat, the coupler adds a second redundancy, in that configuration only.
    for (name, u) in [("driven", solution.u), ("folded flat", vec![1.0, -1.0, 1.0, -1.0, 1.0, -1.0])] {
        for (row, place) in redundancies(&set, &u, &options)? {
            println!("{name}: redundant, {:?}: {}", place, set.label(row)?);
        }
    }
    Ok(())
}

/// Three arms of length 1 with a coupler of length 2.
fn linkage() -> Result<ConstraintSet, Box<dyn std::error::Error>> {
    let top = |i: usize| PlanarPoint::new([2 * i, 2 * i + 1], [i as f64, 1.0]);
    let mut builder = ConstraintSet::builder(6);
    for i in 0..3 {
        let arm = OnSphere { point: top(i), centre: [i as f64, 0.0], radius: None };
        builder.add(format!("arm {}", i + 1), arm)?;
    }
    builder.add("coupler", Distance::new(top(0), top(2)))?;
    for axis in 0..2 {
        let terms = vec![(2 + axis, 1.0), (axis, -0.5), (4 + axis, -0.5)];
        builder.add(format!("middle of the coupler, {}", ["x", "y"][axis]), LinearEquation { terms, rhs: 0.0 })?;
    }
    Ok(builder.build()?)
}

//! A driven crank pushes a slider against a spring: load steps, iterates and residuals, through a dead centre.
//!
//! `cargo run -p qless-solve --example equilibrium`

use std::error::Error;

use qless_constraints::ConstraintSet;
use qless_constraints::types::{Distance, LinearEquation, OnSphere, PlanarPoint};
use qless_solve::equilibrium::{Assembly, EquilibriumOptions, Model, Start, Target, solve};

/// Springs from DOFs to the ground: `f_j = k_j u_j + a_j u_j^3`, in newtons and metres.
struct Springs {
    k: [f64; 4],
    a: [f64; 4],
}

impl Model for Springs {
    fn dofs(&self) -> usize {
        4
    }

    fn pattern(&self, entry: &mut dyn FnMut(usize, usize)) {
        (0..4).for_each(|j| entry(j, j));
    }

    fn assemble(&mut self, u: &[f64], out: &mut Assembly) -> Result<(), Box<dyn Error + Send + Sync>> {
        for (j, &u) in u.iter().enumerate() {
            out.force(j, self.k[j] * u + self.a[j] * u.powi(3));
            out.stiffness(j, j, self.k[j] + 3.0 * self.a[j] * u * u);
        }
        Ok(())
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let set = slider_crank()?;
    let mut springs = Springs { k: [0.0, 0.0, 2e3, 0.0], a: [0.0, 0.0, 1e4, 0.0] };
    let mut start = Start::at_rest(&set);
    let loads = [0.0; 4];
    // The slider is free; the pin is driven along x, from one dead centre to the other and half-way back.
    for x in [-0.05, -0.1, -0.15, -0.2, -0.1] {
        let target = Target { loads: &loads, prescribed: &[(0, x)] };
        let found = solve(&mut springs, &set, &start, &target, &EquilibriumOptions::default())?;
        println!("pin at x = {:.3} m", 0.1 + x);
        for step in &found.steps {
            println!("  load factor {:.4}{}", step.factor, if step.converged { "" } else { ", failed" });
            println!("  {:>4} {:>11} {:>11} {:>7}", "step", "force", "constraint", "length");
            for (k, i) in step.iterates.iter().enumerate() {
                println!("  {k:>4} {:>11.3e} {:>11.3e} {:>7.3}", i.force, i.constraint, i.length);
            }
        }
        println!("  slider at {:.6} m, force along the drive {:.3} N", 0.5 + found.u[2], found.reactions[0]);
        for (row, lambda) in found.multipliers.in_rows(&set)?.iter().enumerate() {
            println!("  {:>6}: {lambda:.3} N", set.label(row)?);
        }
        start = found.start();
    }
    Ok(())
}

/// A crank of 0.1 m and a rod of 0.4 m; DOFs of the pin, then of the slider.
fn slider_crank() -> Result<ConstraintSet, Box<dyn Error>> {
    let (pin, slider) = (PlanarPoint::new([0, 1], [0.1, 0.0]), PlanarPoint::new([2, 3], [0.5, 0.0]));
    let mut builder = ConstraintSet::builder(4);
    builder.add("crank", OnSphere { point: pin, centre: [0.0; 2], radius: None })?;
    builder.add("rod", Distance::new(pin, slider))?;
    builder.add("guide", LinearEquation { terms: vec![(3, 1.0)], rhs: 0.0 })?;
    Ok(builder.build()?)
}

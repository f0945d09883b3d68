//! Rotation vectors are kept short.

use std::f64::consts::{PI, TAU};

use qless_constraints::types::{Body, Fixed, LinearEquation, Point, Prescribed, Revolute, RigidBody, Spherical};
use qless_constraints::{Constraint, ConstraintSet};
use qless_solve::equilibrium::{self, Assembly, EquilibriumOptions, Model, Start, Target};
use qless_solve::newton::{NewtonOptions, solve};

use crate::linkages::{Outcome, random, rank};
use crate::poses::{norm, values};

fn arm(first: usize) -> Body {
    Body::with_vector([first, first + 1, first + 2], [0.3, 0.1, -0.2], [first + 3, first + 4, first + 5])
}

/// Two bodies and a node, with one more constraint.
fn model<C: Constraint>(extra: C) -> Outcome<ConstraintSet> {
    let mut builder = ConstraintSet::builder(15);
    builder.add("hinge", Revolute { a: arm(0), b: arm(6), at: [1.0, 0.0, 0.0], axis: [0.0, 0.0, 1.0] })?;
    builder.add("link", RigidBody { body: arm(0), nodes: vec![Point::new([12, 13, 14], [2.0, 1.0, 0.0]).into()] })?;
    builder.add("extra", extra)?;
    Ok(builder.build()?)
}

/// Shortening keeps the configuration: c stays, and no vector is longer than half a turn.
#[test]
fn shortened_vectors_are_the_same_rotations() -> Outcome {
    let set = model(Spherical { a: Body::ground(), b: arm(6), at: [0.5; 3] })?;
    assert_eq!(set.rotation_vectors(), [[3, 4, 5], [9, 10, 11]]);
    for case in 0..60 {
        let size = [1.0, 9.0, 40.0, 400.0][case % 4];
        let mut u: Vec<f64> = (0..15).map(|j| size * random(15 * case + j)).collect();
        let before = values(&set, &u)?;
        let long = [3, 9].into_iter().filter(|&j| norm([u[j], u[j + 1], u[j + 2]]) > PI).count();
        assert_eq!(set.shorten_rotations(&mut u)?, long, "case {case}");
        assert!([3, 9].into_iter().all(|j| norm([u[j], u[j + 1], u[j + 2]]) <= PI * (1.0 + 1e-15)));
        let after = values(&set, &u)?;
        let off = before.iter().zip(&after).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(off < 1e-14 * (1.0 + size), "case {case}: {off:e}");
    }
    assert!(set.shorten_rotations(&mut [0.0; 3]).is_err());
    Ok(())
}

/// A DOF that an equation uses is not changed.
#[test]
fn vectors_that_something_else_uses_stay() -> Outcome {
    let equation = LinearEquation { terms: vec![(5, 1.0), (11, -2.0)], rhs: 0.0 };
    assert_eq!(model(equation)?.rotation_vectors(), [[0; 3]; 0]);
    assert_eq!(model(Prescribed { values: vec![(4, 5.0)] })?.rotation_vectors(), [[9, 10, 11]]);
    Ok(())
}

/// From a rotation vector of a whole turn, which is singular, Newton's method reaches a weld with full rank.
#[test]
fn a_whole_turn_is_left_behind() -> Outcome {
    let mut builder = ConstraintSet::builder(6);
    builder.add("weld", Fixed { a: Body::ground(), b: arm(0), at: [0.5; 3] })?;
    let set = builder.build()?;
    let start = [0.1, 0.0, 0.0, TAU * 0.6, 0.0, TAU * 0.8];
    let solution = solve(&set, &start, &[], &NewtonOptions::default())?;
    assert!(solution.iterates.iter().all(|iterate| iterate.rank == 6), "{:?}", solution.iterates);
    assert!(solution.u.iter().all(|u| u.abs() < 1e-15), "{:?}", solution.u);
    // A prescribed vector is not shortened.
    let driven = solve(&set, &start, &[(3, TAU * 0.6), (4, 0.0), (5, TAU * 0.8)], &NewtonOptions::default())?;
    assert_eq!(driven.u[3..], start[3..]);
    assert_eq!(rank(&set, &solution.u)?, 6);
    Ok(())
}

/// A spring with the moment `sin((theta - 5) / 2)`, which a whole turn changes.
struct Spring;

impl Model for Spring {
    fn dofs(&self) -> usize {
        6
    }

    fn pattern(&self, entry: &mut dyn FnMut(usize, usize)) {
        entry(5, 5);
    }

    fn assemble(&mut self, u: &[f64], out: &mut Assembly) -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
        let (sin, cos) = (0.5 * (u[5] - 5.0)).sin_cos();
        out.force(5, sin);
        out.stiffness(5, 5, 0.5 * cos);
        Ok(())
    }
}

/// A vector with a spring is not shortened: the arm stays at 5 radians.
#[test]
fn vectors_with_a_spring_stay() -> Outcome {
    let mut builder = ConstraintSet::builder(6);
    builder.add("hinge", Revolute { a: Body::ground(), b: arm(0), at: [0.5; 3], axis: [0.0, 0.0, 1.0] })?;
    let set = builder.build()?;
    let hinged = solve(&set, &[0.0, 0.0, 0.0, 0.0, 0.0, 3.0], &[(5, 4.9)], &NewtonOptions::default())?;
    let start = Start { u: hinged.u, ..Start::at_rest(&set) };
    let target = Target { loads: &[0.0; 6], prescribed: &[] };
    let found = equilibrium::solve(&mut Spring, &set, &start, &target, &EquilibriumOptions::default())?;
    assert!((found.u[5] - 5.0).abs() < 1e-12, "{:?}", found.u);
    Ok(())
}

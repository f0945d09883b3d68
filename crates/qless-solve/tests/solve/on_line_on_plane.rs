//! Nodes on moving lines and planes: c is the distance in every position.

use qless_constraints::types::{Line, OnLine, OnPlane, Plane, Point};
use qless_constraints::{ConstraintSet, SetBuilder};
use qless_solve::newton::{NewtonError, NewtonOptions, solve};

use crate::linkages::{Outcome, random, rank};
use crate::poses::{Vector, add, cross, direction, dot, norm, scale, sub, turn, turned, values};

fn node(i: usize, at: Vector) -> Point {
    Point::new([3 * i, 3 * i + 1, 3 * i + 2], at)
}

fn moved(from: &[Vector], to: &[Vector]) -> Vec<f64> {
    from.iter().zip(to).flat_map(|(from, to)| sub(*to, *from)).collect()
}

fn bead(from: &[Vector; 3]) -> Outcome<ConstraintSet> {
    let mut builder = ConstraintSet::builder(9);
    let line = Line::Nodes(node(1, from[1]), node(2, from[2]));
    builder.add("bead", OnLine { point: node(0, from[0]), line })?;
    Ok(builder.build()?)
}

/// A line rotated by any angle about any axis, including half a turn: |c| is the distance of the node, and no other motion is constrained.
#[test]
fn beads_are_as_far_off_as_c_says() -> Outcome {
    let base = [[0.3, 0.0, 0.0], [0.0, 0.0, 0.0], [1.0, 0.0, 0.0]];
    for unit in [1e-6, 1.0, 1e6] {
        let from = base.map(|x| scale(unit, x));
        let set = bead(&from)?;
        let axes = [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], direction(3), direction(4)];
        for axis in axes {
            for quarter in 0..=24 {
                let q = turn(axis, quarter as f64 * std::f64::consts::PI / 12.0);
                let along = turned(q, [1.0, 0.0, 0.0]);
                let across = cross(along, direction(quarter + 9));
                for off in [0.0, 0.25] {
                    let a = scale(unit, direction(quarter));
                    let p = add(a, scale(unit, add(scale(1.7, along), scale(off, across))));
                    let u = moved(&from, &[p, a, add(a, scale(2.0 * unit, along))]);
                    let c = values(&set, &u)?;
                    let truth = off * unit * norm(across);
                    assert!((c[0].hypot(c[1]) - truth).abs() < 1e-14 * unit, "{axis:?}, {quarter}: {c:?}, {truth}");
                    assert_eq!(rank(&set, &u)?, 2, "{axis:?}, {quarter}");
                }
            }
        }
    }
    Ok(())
}

/// The line makes a full turn in the plane; a second line guides the node, which follows the intersection.
#[test]
fn a_bead_follows_its_line_all_the_way_round() -> Outcome {
    for unit in [1e-6, 1.0, 1e6] {
        let from = [[0.5, 0.0, 0.0], [0.0, 0.0, 0.0], [1.0, 0.0, 0.0]].map(|x| scale(unit, x));
        let set = bead(&from)?;
        let mut u = vec![0.0; 9];
        for step in 0..=72 {
            let angle = f64::from(step) * std::f64::consts::PI / 18.0;
            let along = [angle.cos(), angle.sin(), 0.0];
            let ends: Vec<_> =
                sub(scale(unit, along), from[2]).into_iter().enumerate().map(|(k, v)| (6 + k, v)).collect();
            let fixed: Vec<_> = (3..6).map(|j| (j, 0.0)).chain(ends).collect();
            u = solve(&set, &u, &fixed, &NewtonOptions::default())?.u;
            let p = add(from[0], [u[0], u[1], u[2]]);
            let off = norm(sub(p, scale(dot(p, along), along)));
            assert!(off < 1e-14 * unit, "unit {unit}, step {step}: {p:?} is off by {off:e}");
        }
    }
    Ok(())
}

/// A plane rotated by any angle, and a node above or below it.
#[test]
fn heights_above_a_plane_are_lengths() -> Outcome {
    for unit in [1e-6, 1.0, 1e6] {
        let from = [[0.2, 0.2, 0.0], [0.0; 3], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0]].map(|x| scale(unit, x));
        let mut builder = ConstraintSet::builder(12);
        let plane = Plane::Nodes(node(1, from[1]), node(2, from[2]), node(3, from[3]));
        builder.add("ball", OnPlane { point: node(0, from[0]), plane })?;
        let set = builder.build()?;
        for case in 0..40 {
            let q = turn(direction(case), 6.2 * random(case));
            let (origin, high) = (scale(unit, direction(case + 5)), random(case + 80));
            let to = [[0.4, -0.7, high], [0.0; 3], [3.0, 0.1, 0.0], [0.4, 0.6, 0.0]];
            let to = to.map(|x| add(origin, scale(unit, turned(q, x))));
            let u = moved(&from, &to);
            let c = values(&set, &u)?;
            assert!((c[0] - high * unit).abs() < 1e-14 * unit, "case {case}: {c:?}, {high}");
            assert_eq!(rank(&set, &u)?, 1);
        }
    }
    Ok(())
}

/// A line whose ends coincide and a plane whose corners are collinear are refused; they must not count as satisfied.
#[test]
fn what_has_no_direction_is_refused() -> Outcome {
    let from = [[0.3, 0.0, 0.0], [0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let meeting = moved(&from[..3], &[[5.0, 1.0, 0.0], [0.1; 3], [0.1; 3]]);
    let inline = moved(&from, &[[5.0, 1.0, 2.0], [0.1; 3], [0.2; 3], [0.7; 3]]);
    let mut builder = ConstraintSet::builder(12);
    let plane = Plane::Nodes(node(1, from[1]), node(2, from[2]), node(3, from[3]));
    builder.add("ball", OnPlane { point: node(0, from[0]), plane })?;
    for (name, set, u) in [("bead", bead(&[from[0], from[1], from[2]])?, meeting), ("ball", builder.build()?, inline)] {
        let held: Vec<_> = u.iter().copied().enumerate().collect();
        let refused = solve(&set, &u, &held, &NewtonOptions::default()).expect_err("no direction");
        assert!(matches!(refused, NewtonError::System { .. }) && refused.to_string().contains(name), "{refused}");
    }
    Ok(())
}

#[test]
fn degenerate_lines_are_refused_when_they_are_added() {
    let mut builder: SetBuilder = ConstraintSet::builder(9);
    let line = Line::Nodes(node(1, [1.0; 3]), node(2, [1.0; 3]));
    assert!(builder.add("bead", OnLine { point: node(0, [0.0; 3]), line }).is_err());
}

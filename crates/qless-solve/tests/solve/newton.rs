use std::array::from_fn;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use qless_constraints::scalar::Scalar;
use qless_constraints::types::{
    Body, Distance, Equal, LinearEquation, OnPlane, OnSphere, PlanarPoint, Plane, Point, Prescribed, RigidBody,
    Spherical, Volume,
};
use qless_constraints::{Constraint, ConstraintSet, EquationSink, Nonlinear};
use qless_solve::newton::{NewtonError, NewtonOptions, NewtonSolution, solve};

use crate::linkages::{Outcome, bricard, four_bar, parallelogram, random};

/// Prints the table of residuals; those below 5e-4 and above rounding are at most `bound` times the square of the one before.
fn assert_quadratic(name: &str, solution: &NewtonSolution, bound: f64) {
    let residuals: Vec<f64> = solution.iterates.iter().map(|iterate| iterate.residual).collect();
    println!("{name}\n{:>4} {:>12} {:>12} {:>5}", "step", "residual", "r / r_0^2", "rank");
    let mut fast = 0;
    for (k, iterate) in solution.iterates.iter().enumerate() {
        let ratio = if k == 0 { f64::NAN } else { residuals[k] / residuals[k - 1].powi(2) };
        println!("{k:>4} {:>12.3e} {ratio:>12.3e} {:>5}", residuals[k], iterate.rank);
        if k > 0 && residuals[k - 1] < 5e-4 {
            assert!(residuals[k] <= bound * residuals[k - 1].powi(2) + 1e-16, "{name}, step {k}: {residuals:?}");
            fast += 1;
        }
    }
    assert!(fast >= 2, "{name}: too few steps to judge, {residuals:?}");
}

/// Example 1, with a redundant arm: driven by a third of its length in one step.
#[test]
fn parallelogram_is_driven() -> Outcome {
    let set = parallelogram()?.build()?;
    let solution = solve(&set, &[0.0; 6], &[(0, 0.35)], &NewtonOptions::default())?;
    assert_quadratic("parallelogram", &solution, 30.0);
    assert_eq!(solution.redundant.len(), 1);
    // All points of the coupler move on equal circles.
    for i in 0..3 {
        assert!((solution.u[2 * i] - 0.35).abs() < 1e-14);
        assert!((solution.u[2 * i + 1] - (1.0 - 0.35_f64.powi(2)).sqrt() + 1.0).abs() < 1e-14);
    }
    Ok(())
}

/// Off the constraints the redundant arm is only almost redundant, and G almost singular. The correction is still no longer than the
/// disturbance and takes no more steps.
#[test]
fn disturbed_parallelogram_goes_back_to_what_is_near() -> Outcome {
    let set = parallelogram()?.build()?;
    for (case, size) in [1e-2, 1e-3, 1e-4, 1e-6].into_iter().enumerate() {
        let start: Vec<f64> = (0..6).map(|j| size * random(j + 17 * case)).collect();
        let solution = solve(&set, &start, &[], &NewtonOptions::default())?;
        let way = start.iter().zip(&solution.u).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
        assert!(way < 4.0 * size, "size {size}: {way}");
        assert_eq!(solution.redundant.len(), 1);
        assert!(solution.iterates.len() <= 7, "{:?}", solution.iterates);
    }
    Ok(())
}

/// Off the constraints, the redundant arm is independent by less than a step changes G. A step that satisfies it is far too long.
#[test]
fn parallelograms_converge_from_ordinary_starts() -> Outcome {
    let set = parallelogram()?.build()?;
    for size in [1e-3, 1e-2, 5e-2, 1e-1] {
        let (mut steps, mut most) = (Vec::new(), 0.0_f64);
        for case in 0..200 {
            let start: Vec<f64> = (0..6).map(|j| 2.0 * size * random(j + 17 * case)).collect();
            let solution = solve(&set, &start, &[], &NewtonOptions::default())?;
            assert_eq!(solution.redundant.len(), 1, "size {size}, case {case}");
            let way = start.iter().zip(&solution.u).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
            most = most.max(way / size);
            steps.push(solution.iterates.len() - 1);
        }
        steps.sort_unstable();
        println!("size {size}: {} steps in the middle, at most {}; {most} times as far", steps[100], steps[199]);
        assert!(steps[100] <= 6 && steps[199] <= 20 && most < 50.0, "size {size}: {most} {steps:?}");
    }
    Ok(())
}

/// Example 2, redundant and spatial: Bricard's linkage from a disturbed configuration.
#[test]
fn bricard_linkage_is_assembled() -> Outcome {
    let mut builder = bricard()?;
    builder.add("drive", Prescribed { values: vec![(2, 0.08)] })?;
    let start: Vec<f64> = (0..35).map(|j| 0.05 * random(j)).collect();
    let solution = solve(&builder.build().expect("few DOFs"), &start, &[], &NewtonOptions::default())?;
    assert_quadratic("Bricard's linkage", &solution, 500.0);
    assert_eq!(solution.redundant.len(), 1);
    Ok(())
}

/// Example 3: a block of constant volume on a rigid body, turned by arms of new lengths; a node slides on a plane through nodes.
#[test]
fn volume_and_rotation() -> Outcome {
    let corner = |i: usize| from_fn(|k| f64::from(i as u32 >> k & 1));
    let node = |i: usize| Point::new(from_fn(|k| 3 * i + k), corner(i));
    let body = Body::with_vector([24, 25, 26], [0.0; 3], [27, 28, 29]);
    let mut builder = ConstraintSet::builder(33);
    builder.add("base", RigidBody { body, nodes: (0..4).map(|i| node(i).into()).collect() })?;
    let tetrahedra = vec![[0, 1, 2, 4], [1, 3, 2, 7], [1, 7, 2, 4], [1, 5, 7, 4], [2, 7, 6, 4]];
    builder.add("block", Volume { nodes: (0..8).map(node).collect(), tetrahedra })?;
    let slider = Point::new([30, 31, 32], [0.3, 0.3, 1.0]);
    builder.add("slider", OnPlane { point: slider, plane: Plane::Nodes(node(4), node(5), node(6)) })?;
    for (i, centre) in [(1, [1.5, -0.7, 0.3]), (2, [-0.6, 1.2, -0.4]), (3, [1.7, 1.4, 0.6])] {
        let at: [f64; 3] = corner(i);
        let distance = (0..3).fold(0.0, |sum: f64, k| sum.hypot(at[k] - centre[k]));
        let arm = OnSphere { point: node(i), centre, radius: Some(distance * (1.0 + 0.1 * i as f64)) };
        builder.add(format!("arm {i}"), arm)?;
    }
    let origin = [(24, 0.0), (25, 0.0), (26, 0.0)];
    let start: Vec<f64> = (0..33).map(|j| 0.2 * random(j + 40)).collect();
    let solution = solve(&builder.build().expect("few DOFs"), &start, &origin, &NewtonOptions::default())?;
    assert_quadratic("block of constant volume", &solution, 300.0);
    assert_eq!(solution.redundant, []);
    Ok(())
}

/// A third arm of another length cannot be assembled with the other two; the error names it.
#[test]
fn what_cannot_be_assembled_is_named() -> Outcome {
    let mut builder = parallelogram()?;
    let end = PlanarPoint::new([4, 5], [2.0, 1.0]);
    builder.add("long arm", OnSphere { point: end, centre: [2.0, 0.0], radius: Some(1.1) })?;
    match solve(&builder.build().expect("few DOFs"), &[0.0; 6], &[(0, 0.2)], &NewtonOptions::default()) {
        Err(NewtonError::Conflict { labels, others, .. }) => {
            assert!(labels.iter().chain(&others).any(|label| label.contains("long arm")), "{labels:?} {others:?}");
        }
        other => panic!("expected a conflict, found {other:?}"),
    }
    Ok(())
}

/// Rods that cannot reach.
#[test]
fn what_cannot_be_reached_does_not_converge() -> Outcome {
    let end = PlanarPoint::new([0, 1], [1.0, 0.0]);
    let mut builder = ConstraintSet::builder(4);
    builder.add("arm", OnSphere { point: end, centre: [0.0; 2], radius: None })?;
    builder.add("rod", Distance::new(end, PlanarPoint::new([2, 3], [2.0, 0.0])))?;
    let far = solve(&builder.build().expect("few DOFs"), &[0.0; 4], &[(2, 5.0), (3, 0.0)], &NewtonOptions::default());
    assert!(far.is_err());
    Ok(())
}

/// The same in space, from many disturbed configurations.
#[test]
fn disturbed_linkages_go_back_to_what_is_near() -> Outcome {
    for (name, set, redundant) in [("bricard", bricard()?.build()?, 1), ("four-bar", four_bar()?.build()?, 3)] {
        for case in 0..40 {
            let size = [0.05, 1e-2, 1e-3, 1e-5][case % 4];
            let start: Vec<f64> = (0..set.dofs()).map(|j| size * random(j + 97 * case)).collect();
            let solution = solve(&set, &start, &[], &NewtonOptions::default())?;
            // DOFs that no slave needs do not move, so that some corrections are longer: up to 16 times the disturbance.
            let way = start.iter().zip(&solution.u).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
            assert!(way < 50.0 * size, "{name}, case {case}: {way}");
            assert!(solution.iterates.len() <= 7, "{name}, case {case}: {:?}", solution.iterates);
            assert_eq!(solution.redundant.len(), redundant, "{name}, case {case}");
        }
    }
    Ok(())
}

/// Linear equations only: analysed once; the second iterate, with another c, has the same rank and redundancy.
#[test]
fn linear_equations_need_one_step() -> Outcome {
    let mut builder = ConstraintSet::builder(5);
    for (label, dofs) in [("ab", [0, 1]), ("bc", [1, 2]), ("ca", [2, 0])] {
        builder.add(label, Equal::new(dofs))?;
    }
    builder.add("lever", LinearEquation { terms: vec![(2, 3.0), (3, -1.0), (4, 0.7)], rhs: 0.1 })?;
    let set = builder.build().expect("few DOFs");
    let start = [0.1, -0.4, 0.9, 3.0, -2.0];
    let solution = solve(&set, &start, &[(4, 0.3), (1, 1.5)], &NewtonOptions::default())?;
    assert_eq!(solution.iterates.len(), 2);
    assert!(solution.iterates.iter().all(|iterate| (iterate.rank, iterate.ignored.len()) == (3, 1)));
    let truth = [1.5, 1.5, 1.5, 3.0 * 1.5 + 0.7 * 0.3 - 0.1, 0.3];
    assert!(solution.u.iter().zip(truth).all(|(u, truth)| (u - truth).abs() < 1e-14), "{:?}", solution.u);
    // A gap that contradicts the closure of the ring is found from any start.
    let gap = set_with_gap(0.25)?;
    let error = solve(&gap, &[0.3, 0.1, -0.2], &[], &NewtonOptions::default()).expect_err("a gap");
    assert!(matches!(error, NewtonError::Conflict { amount, .. } if (amount - 0.25).abs() < 1e-14), "{error}");
    Ok(())
}

fn set_with_gap(gap: f64) -> Result<ConstraintSet, Box<dyn std::error::Error>> {
    let mut builder = ConstraintSet::builder(3);
    builder.add("ab", Equal::new([0, 1]))?;
    builder.add("bc", Equal::new([1, 2]))?;
    builder.add("ca", LinearEquation { terms: vec![(2, 1.0), (0, -1.0)], rhs: gap })?;
    Ok(builder.build().expect("few DOFs"))
}

/// Values that are not finite are refused, also at DOFs without equations; a prescribed DOF takes its value whatever it was.
#[test]
fn starts_that_are_no_numbers_are_refused() -> Outcome {
    let mut builder = ConstraintSet::builder(3);
    builder.add("tie", Equal::new([0, 1]))?;
    for set in [ConstraintSet::builder(3).build()?, builder.build()?] {
        for bad in [f64::NAN, f64::INFINITY] {
            let options = NewtonOptions::default();
            let found = solve(&set, &[0.0, 0.0, bad], &[(1, 1.0)], &options);
            assert!(matches!(found, Err(NewtonError::Argument { step: 0, .. })), "{found:?}");
            assert_eq!(solve(&set, &[0.0, 0.0, bad], &[(2, 1.0)], &options)?.u[2], 1.0);
        }
    }
    Ok(())
}

/// An arm with Euler parameters that is pulled to a target far outside of its reach does not stretch: the set keeps the length of the parameters.
/// Regression: the arm of 0.5 became 0.65 or 1.46.
#[test]
fn an_arm_keeps_its_length() -> Outcome {
    let arm = Body::with_euler([0, 1, 2], [0.5, 0.0, 0.0], [3, 4, 5, 6]);
    let mut builder = ConstraintSet::builder(7);
    builder.add("ball", Spherical { a: Body::ground(), b: arm, at: [0.0; 3] })?;
    let set = builder.build()?;
    for case in 0..20 {
        let start: Vec<f64> = (0..7).map(|j| 2.0 * random(7 * case + j)).collect();
        let Ok(solution) = solve(&set, &start, &[], &NewtonOptions::default()) else { continue };
        let place = [0.5 + solution.u[0], solution.u[1], solution.u[2]];
        let length = place.iter().fold(0.0, |sum: f64, x| sum.hypot(*x));
        assert!((length - 0.5).abs() < 1e-14, "case {case}: {length}");
    }
    let solution = solve(&set, &[0.3, -0.4, 0.2, 0.1, 0.5, -0.7, 0.9], &[], &NewtonOptions::default())?;
    assert_eq!(solution.redundant, [0_usize; 0]);
    Ok(())
}

/// `c = s + s^2 / 5 - 0.3` with `s = u_0 + slope u_1`, which counts its evaluations.
struct Counted {
    dofs: [usize; 2],
    slope: f64,
    count: Arc<AtomicUsize>,
}

impl Constraint for Counted {
    const NAME: &'static str = "counted";
    type Error = std::convert::Infallible;

    fn emit(self, sink: &mut EquationSink) -> Result<(), Self::Error> {
        let dofs = self.dofs;
        sink.nonlinear("", &dofs, self);
        Ok(())
    }
}

impl Nonlinear for Counted {
    const EQUATION_NAMES: &'static [&'static str] = &[""];

    fn value<S: Scalar>(&self, u: &[S], c: &mut [S]) {
        let s = u[0] + S::from(self.slope) * u[1];
        c[0] = s + S::from(0.2) * s * s - S::from(0.3);
    }

    fn value_and_jacobian(&self, u: &[f64], c: &mut [f64], g: &mut [f64]) {
        self.count.fetch_add(1, Ordering::Relaxed);
        self.value(u, c);
        let along = 1.0 + 0.4 * (u[0] + self.slope * u[1]);
        (g[0], g[1]) = (along, along * self.slope);
    }
}

/// A full step costs two evaluations, one to try it and one at its end, also if equations are nearly dependent: other steps are tried
/// only instead of short ones.
#[test]
fn full_steps_are_taken_at_once() -> Outcome {
    for near in [0.6, 0.1, 0.05, 0.01] {
        let count = Arc::new(AtomicUsize::new(0));
        let mut builder = ConstraintSet::builder(3);
        for (name, dofs, slope) in [("one", [0, 1], near), ("like it", [0, 1], -near), ("other", [1, 2], 1.0)] {
            builder.add(name, Counted { dofs, slope, count: Arc::clone(&count) })?;
        }
        let set = builder.build()?;
        count.store(0, Ordering::Relaxed);
        let found = solve(&set, &[0.0; 3], &[], &NewtonOptions::default())?;
        assert!(found.iterates.len() > 3 && found.iterates.iter().all(|i| i.rank == 3 && i.length == 1.0));
        assert_eq!(count.load(Ordering::Relaxed), 3 * (2 * found.iterates.len() - 1), "{near}: {:?}", found.iterates);
    }
    Ok(())
}

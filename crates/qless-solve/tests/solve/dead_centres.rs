use std::f64::consts::TAU;

use qless_constraints::scalar::Scalar;
use qless_constraints::types::{Distance, LinearEquation, OnSphere, PlanarPoint};
use qless_constraints::{Constraint, ConstraintSet, EquationSink, Nonlinear};
use qless_solve::newton::{NewtonError, NewtonOptions, NewtonSolution, Redundancy, redundancies, solve};

use crate::linkages::Outcome;

/// `c = (x - r cos(t))^2 + (r sin t)^2 - l^2) / (2 l)`: a crank angle t and a slider at `x = r + l + u`.
pub struct SliderCrank {
    pub dofs: [usize; 2],
    pub crank: f64,
    pub rod: f64,
}

impl Constraint for SliderCrank {
    const NAME: &'static str = "slider-crank";
    type Error = std::convert::Infallible;

    fn emit(self, sink: &mut EquationSink) -> Result<(), Self::Error> {
        let dofs = self.dofs;
        sink.nonlinear("", &dofs, self);
        Ok(())
    }
}

impl Nonlinear for SliderCrank {
    const EQUATION_NAMES: &'static [&'static str] = &[""];

    fn value<S: Scalar>(&self, u: &[S], c: &mut [S]) {
        let (r, l) = (S::from(self.crank), S::from(self.rod));
        let (x, y) = (r + l + u[1] - r * u[0].cos(), r * u[0].sin());
        c[0] = (x * x + y * y - l * l) / (S::from(2.0) * l);
    }
}

fn by_angle(unit: f64) -> Outcome<ConstraintSet> {
    let mut builder = ConstraintSet::builder(2);
    builder.add("rod", SliderCrank { dofs: [0, 1], crank: 0.5 * unit, rod: 2.0 * unit })?;
    Ok(builder.build()?)
}

/// The same linkage by points: the crank pin has DOFs 0 and 1, the slider 2 and 3.
fn by_points(unit: f64) -> Outcome<ConstraintSet> {
    let (pin, slider) = (PlanarPoint::new([0, 1], [0.5 * unit, 0.0]), PlanarPoint::new([2, 3], [2.5 * unit, 0.0]));
    let mut builder = ConstraintSet::builder(4);
    builder.add("crank", OnSphere { point: pin, centre: [0.0; 2], radius: None })?;
    builder.add("rod", Distance::new(pin, slider))?;
    builder.add("guide", LinearEquation { terms: vec![(3, 1.0)], rhs: 0.0 })?;
    Ok(builder.build()?)
}

/// The crank angle after the slider has moved inwards by `d`: the law of cosines, without cancellation.
fn angle(d: f64) -> f64 {
    let (r, l, x) = (0.5_f64, 2.0_f64, 2.5 - d);
    2.0 * (0.5 * (d * (2.0 * l - d) / (2.0 * r * x))).sqrt().asin()
}

const UNITS: [f64; 3] = [1e-6, 1.0, 1e6];

fn list(solution: &NewtonSolution) -> String {
    solution.iterates.iter().map(|i| format!("{:.1e} ({})", i.residual, i.length)).collect::<Vec<_>>().join(", ")
}

/// From the dead centre and from beside it, the crank turns until the rod has its length.
#[test]
fn cranks_leave_their_dead_centre() -> Outcome {
    let options = NewtonOptions::default();
    for unit in UNITS {
        for start in [0.0, 1e-60, 1e-15, 1e-12, 1e-10, 1e-8, -1e-8, 1e-6, 1e-3] {
            for d in [1e-12, 1e-6, 0.0357, 0.3, 0.9] {
                let found = solve(&by_angle(unit)?, &[start, 0.0], &[(1, -d * unit)], &options)?;
                println!("unit {unit}, start {start}, by {d}: {}", list(&found));
                assert_eq!(found.u[1], -d * unit);
                let truth = angle(d);
                // c is quadratic in the angle here: the angle is known to the rounding of c divided by the angle.
                let tolerance = 1e-12 * truth + 2e-13 / truth;
                // In either direction, but less than a turn.
                let turned = found.u[0].abs();
                let off = (turned - truth).abs().min((TAU - turned - truth).abs());
                assert!(off < tolerance && turned < TAU, "{unit} {start} {d}: {turned} {truth}");
                assert!(found.iterates.len() <= 12);

                let side = unit * 0.5 * start.sin();
                let found = solve(&by_points(unit)?, &[0.0, side, 0.0, 0.0], &[(2, -d * unit)], &options)?;
                println!("   points: {}", list(&found));
                let turned = (found.u[1].abs() / unit).atan2(0.5 + found.u[0] / unit);
                assert!((turned - truth).abs() < tolerance, "{unit} {start} {d}: points {turned} {truth}");
            }
        }
    }
    Ok(())
}

/// Out of reach, the error names the rod in every unit; starting beside the dead centre, there is no convergence.
#[test]
fn beyond_the_reach_there_is_no_solution() -> Outcome {
    let options = NewtonOptions::default();
    for unit in UNITS {
        for d in [1e-9, 1e-3, 0.5] {
            match solve(&by_angle(unit)?, &[0.0, 0.0], &[(1, d * unit)], &options) {
                Err(NewtonError::Conflict { labels, others, amount, .. }) => {
                    assert_eq!((labels, others), (vec!["rod".to_owned()], Vec::new()));
                    assert!((amount / (d * unit) - 1.0).abs() < 0.2, "{amount}");
                }
                other => panic!("{unit} {d}: {other:?}"),
            }
            let points = solve(&by_points(unit)?, &[0.0; 4], &[(2, d * unit)], &options);
            assert!(matches!(points, Err(NewtonError::Conflict { .. })), "{points:?}");
            assert!(solve(&by_angle(unit)?, &[1e-3, 0.0], &[(1, d * unit)], &options).is_err());
        }
    }
    Ok(())
}

/// A full turn driven by the slider: inwards to the second dead centre and out again, in steps that end on the dead centres.
#[test]
fn the_slider_goes_through_both_dead_centres() -> Outcome {
    for unit in UNITS {
        for set in [by_angle(unit)?, by_points(unit)?] {
            let slider = if set.dofs() == 2 { 1 } else { 2 };
            let (mut u, mut evaluation) = (vec![0.0; set.dofs()], set.allocate());
            for k in (0..=20).chain((0..20).rev()).chain(0..=3) {
                let found = solve(&set, &u, &[(slider, -0.05 * f64::from(k) * unit)], &NewtonOptions::default());
                u = found.map_err(|e| format!("unit {unit}, step {k}: {e}"))?.u;
                set.evaluate(&u, &mut evaluation)?;
                assert!(evaluation.c().iter().all(|c| c.abs() <= 5e-14 * unit), "{unit} {k} {:?}", evaluation.c());
            }
        }
    }
    Ok(())
}

/// A rod that is 32 % too long gets its length, whatever the length is, and also beside coordinates that are a million times larger.
#[test]
fn rods_of_all_lengths() -> Outcome {
    for length in [1e-12, 1e-6, 1.0, 1e6, 1e12] {
        for far in [0.0, 1e6] {
            let at = |dofs, x: f64| PlanarPoint::new(dofs, [x * length, far * length]);
            let (a, b) = (at([0, 1], 0.0), at([2, 3], 1.32));
            let mut builder = ConstraintSet::builder(4);
            builder.add("rod", Distance { a, b, length: Some(length) })?;
            let held = [(0, 0.0), (1, 0.0)];
            let found = solve(&builder.build()?, &[0.0; 4], &held, &NewtonOptions::default())?;
            assert!(found.iterates.len() > 2, "accepted as it is");
            let now = (1.32 * length + found.u[2]).hypot(found.u[3]);
            assert!((now / length - 1.0).abs() < 1e-9 * far.max(1e-4), "{length} {far}: {now}");
        }
    }
    Ok(())
}

/// Redundancies and their kinds are the same in all units.
#[test]
fn redundancy_has_no_unit() -> Outcome {
    for unit in UNITS {
        let point = |i: usize, x: f64| PlanarPoint::new([2 * i, 2 * i + 1], [x * unit, 0.0]);
        let (p, q) = (point(0, 1.0), point(1, 3.0));
        let mut builder = ConstraintSet::builder(4);
        builder.add("arm 1", OnSphere { point: p, centre: [0.0; 2], radius: None })?;
        builder.add("arm 2", OnSphere { point: q, centre: [2.0 * unit, 0.0], radius: None })?;
        builder.add("coupler", Distance::new(p, q))?;
        let found = redundancies(&builder.build()?, &[0.0; 4], &NewtonOptions::default())?;
        assert_eq!(found.iter().map(|f| f.1).collect::<Vec<_>>(), [Redundancy::OnlyHere], "unit {unit}");
    }
    Ok(())
}

#[test]
fn tolerances_below_rounding_are_refused() -> Outcome {
    for tolerance in [0.0, -1.0, 0.5, f64::NAN, f64::INFINITY] {
        let options = NewtonOptions { tolerance, ..NewtonOptions::default() };
        let refused = solve(&by_angle(1.0)?, &[0.1, 0.0], &[], &options);
        assert!(matches!(refused, Err(NewtonError::Tolerance(_))), "{refused:?}");
    }
    Ok(())
}

/// Any input gives a solution or an error, and never a panic.
#[test]
fn wrong_starts_are_refused() -> Outcome {
    let (set, options) = (by_points(1.0)?, NewtonOptions::default());
    for bad in [f64::NAN, f64::INFINITY, 1e300, -1e308] {
        assert!(solve(&set, &[bad; 4], &[], &options).is_err(), "{bad}");
        assert!(solve(&set, &[0.0; 4], &[(2, bad)], &options).is_err(), "{bad}");
    }
    for prescribed in [vec![(4, 0.0)], vec![(usize::MAX, 0.0)], vec![(0, 0.0), (0, 1.0)]] {
        assert!(matches!(solve(&set, &[0.0; 4], &prescribed, &options), Err(NewtonError::System { .. })));
    }
    for count in [0, 3, 5] {
        assert!(matches!(solve(&set, &vec![0.0; count], &[], &options), Err(NewtonError::Argument { .. })));
    }
    let none = ConstraintSet::builder(3).build()?;
    assert_eq!(solve(&none, &[1.0; 3], &[(1, 5.0)], &options)?.u, [1.0, 5.0, 1.0]);
    Ok(())
}

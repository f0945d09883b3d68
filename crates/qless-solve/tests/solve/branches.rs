//! Four-bar linkages whose crank moves far in one call stay on the branch where they started.
//!
//! The joint is one of two intersections of circles about both pivots. The sign of a determinant tells them apart, so that no path is needed
//! to know the right one.

use std::f64::consts::TAU;

use qless_constraints::types::{Distance, Driven, OnSphere, PlanarPoint};
use qless_constraints::{ConstraintSet, SetBuilder};
use qless_solve::equilibrium::{Equilibrium, EquilibriumError, EquilibriumOptions, Start, Target, drive, solve};

use crate::equilibria::Weights;
use crate::linkages::{Outcome, random};

type Place = [f64; 2];

/// A quarter of the seeds, which is a minute less; all with `QLESS_THOROUGH`.
fn share(count: usize) -> usize {
    if std::env::var_os("QLESS_THOROUGH").is_some() { count } else { count / 4 }
}

const UNITS: [f64; 3] = [1e-6, 1.0, 1e6];
/// If it comes closer to folding than this fraction of the shorter bar, a linkage may change its branch.
const FLAT: f64 = 0.02;

/// A joint with a coupler to the end of the crank and a rocker about a pivot, on one side of the line through both.
#[derive(Debug)]
struct FourBar {
    coupler: f64,
    rocker: f64,
    base: f64,
    side: f64,
}

impl FourBar {
    fn random(seed: usize) -> Self {
        let [coupler, rocker, base] = [0, 1, 2].map(|k| 0.2 + 4.0 * random(31 * seed + k).abs());
        Self { coupler, rocker, base, side: random(31 * seed + 3).signum() }
    }

    /// The joint for the crank's end at `pin`, and the height of its triangle over the shorter bar; none if the linkage does not close.
    fn joint(&self, [x, y]: Place) -> Option<(Place, f64)> {
        let (across, up) = (self.base - x, -y);
        let far = across.hypot(up);
        let along = (self.coupler.powi(2) - self.rocker.powi(2) + far * far) / (2.0 * far);
        let high = (self.coupler.powi(2) - along * along).sqrt();
        let off = self.side * high;
        let joint = [x + (along * across - off * up) / far, y + (along * up + off * across) / far];
        high.is_finite().then_some((joint, high / self.coupler.min(self.rocker)))
    }

    /// Whether no point of a path folds it nearly flat.
    fn is_sound(&self, way: impl Fn(f64) -> Place) -> bool {
        (0..=2000).all(|i| self.joint(way(f64::from(i) / 2000.0)).is_some_and(|(_, height)| height > FLAT))
    }

    /// Coupler and rocker with the crank's end at `pin`, in a unit of length; the caller adds the equations of the crank.
    fn builder(&self, pin: Place, unit: f64) -> Outcome<SetBuilder> {
        let (joint, _) = self.joint(pin).ok_or("it does not close")?;
        let [pin, joint] =
            [(0, pin), (2, joint)].map(|(dof, at)| PlanarPoint::new([dof, dof + 1], at.map(|x| unit * x)));
        let mut builder = ConstraintSet::builder(4);
        builder.add("coupler", Distance::new(pin, joint))?;
        builder.add("rocker", OnSphere { point: joint, centre: [unit * self.base, 0.0], radius: None })?;
        Ok(builder)
    }

    /// Drives the crank's end along a path, from time 0 to 1.
    fn driven(
        &self,
        pin: impl Fn(f64) -> Place + Copy + Send + Sync + 'static,
        unit: f64,
        options: &EquilibriumOptions,
    ) -> Outcome<Result<Equilibrium, EquilibriumError>> {
        let mut builder = self.builder(pin(0.0), unit)?;
        for k in 0..2 {
            builder.add("crank", Driven::new([(k, 1.0)], move |s| unit * (pin(s)[k] - pin(0.0)[k])))?;
        }
        let mut set = builder.build()?;
        let (start, target) = (Start::at_rest(&set), Target { loads: &[0.0; 4], prescribed: &[] });
        Ok(drive(&mut Weights { springs: vec![0.0; 4] }, &mut set, &start, &target, 1.0, options))
    }

    /// Distance of the joint from its right position, for `u` relative to the first pin.
    fn off(&self, [from, to]: [Place; 2], u: &[f64], unit: f64) -> f64 {
        let place = |pin| self.joint(pin).map_or([f64::NAN; 2], |(joint, _)| joint);
        let (from, to) = (place(from), place(to));
        (from[0] + u[2] / unit - to[0]).hypot(from[1] + u[3] / unit - to[1])
    }
}

/// Functions of time that turn a crank by turns and fractions of turns, in one load step or many.
#[test]
fn cranks_driven_through_whole_turns_keep_their_branch() -> Outcome {
    let (mut sound, mut steps) = (0, 0);
    for seed in 0..share(600) {
        let (bar, unit) = (FourBar::random(seed), UNITS[seed % 3]);
        let (crank, first) = (0.2 + 2.0 * random(17 * seed + 5).abs(), 6.0 * random(17 * seed + 6));
        let angle = [0.3, 1.0, 3.0, -2.2][seed / 3 % 4] * TAU + random(17 * seed + 7);
        let pin = move |s: f64| [0, 1].map(|k| crank * [f64::cos, f64::sin][k](first + s * angle));
        if !bar.is_sound(pin) {
            continue;
        }
        let options = EquilibriumOptions { first: [1.0, 0.1, 0.003][seed % 7 % 3], ..Default::default() };
        let found = bar.driven(pin, unit, &options)?.map_err(|error| format!("{seed} {bar:?}: {error}"))?;
        let off = bar.off([pin(0.0), pin(1.0)], &found.u, unit);
        assert!(off < 1e-8, "{seed} {bar:?}, crank {crank} by {angle}: {off:e}");
        sound += 1;
        steps += found.steps.len();
    }
    println!("{sound} linkages, {} load steps each", steps / sound);
    assert!(sound > share(100), "{sound}");
    Ok(())
}

/// The end of the crank is prescribed along a random polygon.
#[test]
fn cranks_prescribed_from_far_keep_their_branch() -> Outcome {
    let mut sound = 0;
    for seed in 0..share(800) {
        let (bar, unit) = (FourBar::random(seed), UNITS[seed % 3]);
        let corner = |k: usize| [4 * k, 4 * k + 2].map(|k| 4.0 * random(29 * seed + k));
        let Ok(builder) = bar.builder(corner(0), unit) else { continue };
        let set = builder.build()?;
        let mut start = Start::at_rest(&set);
        for k in 0..4 {
            let way = |s: f64| [0, 1].map(|i| corner(k)[i] + s * (corner(k + 1)[i] - corner(k)[i]));
            if !bar.is_sound(way) {
                break;
            }
            let prescribed = [0, 1].map(|i| (i, unit * (corner(k + 1)[i] - corner(0)[i])));
            let target = Target { loads: &[0.0; 4], prescribed: &prescribed };
            let mut model = Weights { springs: vec![0.0; 4] };
            let found = solve(&mut model, &set, &start, &target, &EquilibriumOptions::default())
                .map_err(|error| format!("{seed} {k} {bar:?}: {error}"))?;
            let off = bar.off([corner(0), corner(k + 1)], &found.u, unit);
            assert!(off < 1e-8, "{seed} {k} {bar:?}: {off:e}");
            start = found.start();
            sound += 1;
        }
    }
    println!("{sound} ways");
    assert!(sound > share(100), "{sound}");
    Ok(())
}

/// If a linkage cannot pass a position, no load step may skip it.
#[test]
fn what_folds_on_the_way_is_refused() -> Outcome {
    let mut refused = 0;
    for seed in 0..60 {
        let (bar, unit) = (FourBar { base: 1.0, coupler: 0.9, rocker: 0.8, side: 1.0 }, UNITS[seed % 3]);
        // A crank of 0.9 comes to a position where the pivot is out of reach, and would be back after a full turn.
        let first = 0.9 * random(seed);
        let pin = move |s: f64| [0, 1].map(|k| 0.9 * [f64::cos, f64::sin][k](first + s * TAU));
        let options = EquilibriumOptions { first: [1.0, 0.4][seed % 2], ..Default::default() };
        let found = bar.driven(pin, unit, &options)?;
        assert!(found.is_err(), "{seed}: {found:?}");
        refused += usize::from(matches!(found, Err(EquilibriumError::Branch { .. })));
    }
    // The others fail before anything turns: no configuration is found at all.
    assert!(refused > 15, "{refused} of 60 say that a branch ends");
    Ok(())
}

/// Whole turns that end where they started: a linkage that does not close on the way is refused. If a load step starts exactly where it
/// ceases to close, it may find where it closes again, and reports that branches meet.
#[test]
fn whole_turns_that_do_not_close_are_refused() -> Outcome {
    let (mut open, mut said) = (0, 0);
    for seed in 0..share(500) {
        let (bar, unit) = (FourBar::random(seed), UNITS[seed % 3]);
        let (crank, first) = (0.2 + 2.0 * random(17 * seed + 5).abs(), 6.0 * random(17 * seed + 6));
        let turns = [1.0, -1.0, 2.0, 3.0, 7.0, 25.0, 60.0][seed % 7];
        // An ellipse: the end of the crank has no constant speed.
        let flat = [1.0, 0.6][seed / 7 % 2];
        let pin = move |s: f64| {
            let angle = first + s * turns * TAU;
            [crank * angle.cos(), flat * crank * angle.sin()]
        };
        let closes = |s: f64| bar.joint(pin(s / turns)).is_some();
        let gaps = (0..2000).filter(|&i| !closes(f64::from(i) / 2000.0)).count();
        if gaps < 20 || !closes(0.0) {
            continue;
        }
        let found = bar.driven(pin, unit, &EquilibriumOptions::default())?;
        let met = found.ok().map(|found| found.steps.iter().any(|step| step.converged && step.branches_meet));
        assert!(met.unwrap_or(true), "{seed} {bar:?}, crank {crank} by {turns} turns, {gaps} gaps");
        said += usize::from(met.is_some());
        open += 1;
    }
    println!("{open} linkages that do not close, {said} of them found to close again");
    assert!(open > share(100) && said <= 1.max(open / 100), "{open} {said}");
    Ok(())
}

/// Close to folding flat, Newton's method chooses the branch; a load step reports this wherever the wrong one was taken.
#[test]
fn where_branches_meet_is_said() -> Outcome {
    let (mut right, mut refused) = (0, 0);
    // How many paths pass meeting branches, among those far from folding and those near to it.
    let mut said = [[0, 0]; 2];
    for seed in 0..share(2000) {
        let (mut bar, unit) = (FourBar::random(seed), UNITS[seed % 3]);
        let (crank, first) = (0.2 + 2.0 * random(17 * seed + 5).abs(), 6.0 * random(17 * seed + 6));
        let margin = 10_f64.powf(-3.0 - 8.0 * random(13 * seed).abs());
        bar.rocker = (bar.base + crank) * (1.0 + margin) - bar.coupler;
        let pin = move |s: f64| [0, 1].map(|k| crank * [f64::cos, f64::sin][k](first + s * 0.7 * TAU));
        let closes = (0..=2000).all(|i| bar.joint(pin(f64::from(i) / 2000.0)).is_some());
        if bar.rocker <= 0.1 || !closes || (bar.rocker - bar.coupler).abs() > 0.95 * (bar.base - crank).abs() {
            continue;
        }
        let Ok(found) = bar.driven(pin, unit, &EquilibriumOptions::default())? else {
            refused += 1;
            continue;
        };
        let met = found.steps.iter().any(|step| step.converged && step.branches_meet);
        let is_right = bar.off([pin(0.0), pin(1.0)], &found.u, unit) < 1e-5;
        assert!(is_right || met, "{seed} {bar:?}, crank {crank}, margin {margin:e}: {} load steps", found.steps.len());
        right += usize::from(is_right);
        let [all, through] = &mut said[usize::from(margin < 1e-5)];
        (*all, *through) = (*all + 1, *through + usize::from(met));
    }
    println!("{right} on their branch, {said:?} through where branches meet, {refused} refused");
    let [far, near] = said;
    assert!(right > share(100) && refused < right / 10, "{right} {refused}");
    assert!(near[1] * 4 > near[0] && far[1] * 8 < far[0], "{said:?}");
    Ok(())
}

/// A weight on a spring hangs from the joint of a driven linkage: the equations determine the linkage alone. The load steps and the path are
/// the same in all units of length and force.
#[test]
fn steps_are_the_same_in_all_units() -> Outcome {
    for seed in 0..6 {
        let bar = FourBar { coupler: 1.9, rocker: 1.7 + 0.2 * random(seed), base: 2.0, side: [1.0, -1.0][seed % 2] };
        let angle = [1.0, 2.5, TAU][seed / 2];
        let pin = move |s: f64| [0.5 * (1.0 + s * angle).cos(), 0.5 * (1.0 + s * angle).sin()];
        let (joint, _) = bar.joint(pin(0.0)).ok_or("it closes")?;
        let run = |unit: f64, force: f64| -> Outcome<Equilibrium> {
            let at = |dof: usize, place: Place| PlanarPoint::new([dof, dof + 1], place.map(|x| unit * x));
            let mut builder = ConstraintSet::builder(6);
            builder.add("coupler", Distance::new(at(0, pin(0.0)), at(2, joint)))?;
            let point = at(2, joint);
            builder.add("rocker", OnSphere { point, centre: [unit * bar.base, 0.0], radius: None })?;
            builder.add("rope", Distance::new(at(2, joint), at(4, [joint[0] + 0.4, joint[1] - 0.7])))?;
            for k in 0..2 {
                builder.add("crank", Driven::new([(k, 1.0)], move |s| unit * (pin(s)[k] - pin(0.0)[k])))?;
            }
            let (mut set, stiff) = (builder.build()?, 3.0 * force / unit);
            let loads = [0.0, 0.0, 0.0, 0.0, 0.2 * force, -force];
            let (start, target) = (Start::at_rest(&set), Target { loads: &loads, prescribed: &[] });
            let mut model = Weights { springs: vec![0.0, 0.0, 0.0, 0.0, stiff, stiff] };
            Ok(drive(&mut model, &mut set, &start, &target, 1.0, &EquilibriumOptions::default())?)
        };
        let plain = run(1.0, 1.0)?;
        for (unit, force) in
            [(-24, 0), (24, 0), (0, 30), (-24, -30)].map(|(unit, force)| (2.0_f64.powi(unit), 2.0_f64.powi(force)))
        {
            let other = run(unit, force)?;
            assert_eq!(other.steps.len(), plain.steps.len(), "{seed}: unit {unit:e}, force {force:e}");
            for (a, b) in plain.u.iter().zip(&other.u) {
                assert!((a - b / unit).abs() < 1e-8, "{seed}: unit {unit:e}, force {force:e}: {a} and {}", b / unit);
            }
        }
    }
    Ok(())
}

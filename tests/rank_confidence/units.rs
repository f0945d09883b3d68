//! The law of units: `D1 C D2` with positive diagonal D1 and D2 has the rank, the status, the doubt and the digits of C. In other units
//! numbers do not look typed or left of a computation any more, so all of them are taken as data.

use qless::{Analysis, BackendChoice, ConstraintSystem, Kind, Noise, Options, SystemBuilder, analyse};
use qless_scenes::Rng;
use rayon::prelude::*;

use super::{random, scenes};

/// Random systems for each range of exponents.
const COUNT: u64 = 1000;
/// Digits by which the distance may differ, ...
const DIGITS: f64 = 1.0;
/// ... and the part of the systems in which other units lead to other kept rows, and these to another bound.
const EXCEPTIONS: f64 = 0.03;
/// The part in which d or what is left lies beside a limit: one of both is in doubt.
const DOUBTS: f64 = 0.01;

/// `D1 C D2`, `D1 b` and `D2^-1 u_p`, with exponents of two up to `most`; powers of two, or others as well.
fn in_other_units(system: &ConstraintSystem, most: i32, whole: bool, rng: &mut Rng) -> ConstraintSystem {
    let mut unit = || {
        let power = f64::from(most) * rng.real();
        if whole { 2_f64.powi(power as i32) } else { power.exp2() }
    };
    let rows: Vec<f64> = (0..system.equations()).map(|_| unit()).collect();
    let dofs: Vec<f64> = (0..system.dofs()).map(|_| unit()).collect();
    let mut builder = SystemBuilder::new(system.dofs());
    for (i, d) in rows.iter().enumerate() {
        builder.equation(system.matrix().row(i).map(|(j, v)| (j, v * d * dofs[j])), system.rhs()[i] * d);
    }
    system.prescribed().iter().for_each(|&(j, value)| builder.prescribe(j, value / dofs[j]));
    builder.build().expect("in range")
}

/// Rank, whether there are conflicts.
type Said = (usize, bool);

fn said(analysis: &Analysis) -> (Said, bool, f64) {
    // Which equations are dropped, and so how many of them conflict, may differ.
    let conflicting = analysis.kinds().contains(&Kind::Conflicting);
    let confidence = analysis.confidence();
    ((analysis.rank(), conflicting), confidence.ambiguous, confidence.digits_kept())
}

/// By how much what is said differs.
struct Difference {
    digits: f64,
    /// What is said where the doubt differs.
    doubt: Option<String>,
}

/// An error if two sure verdicts differ.
fn compare(
    name: &str,
    system: &ConstraintSystem,
    other: &ConstraintSystem,
    options: &Options,
) -> Result<Difference, String> {
    let of = |system| analyse(system, options).map(|analysis| said(&analysis)).map_err(|e| format!("{name}: {e}"));
    let (before, after) = (of(system)?, of(other)?);
    let text = format!("{name}: {before:?} and {after:?}");
    if before.0 != after.0 && !before.1 && !after.1 {
        return Err(text);
    }
    let doubt = (before.1 != after.1).then_some(text);
    Ok(Difference { digits: (before.2 - after.2).abs(), doubt })
}

fn hold(found: Vec<Result<Difference, String>>) {
    let (same, faults): (Vec<_>, Vec<_>) = found.into_iter().partition(Result::is_ok);
    let faults: Vec<String> = faults.into_iter().filter_map(Result::err).collect();
    assert!(faults.is_empty(), "{} faults:\n{}", faults.len(), faults.join("\n"));
    let count = same.len() as f64;
    let off = same.iter().flatten().filter(|difference| difference.digits > DIGITS).count();
    let doubts: Vec<String> = same.into_iter().flatten().filter_map(|difference| difference.doubt).collect();
    println!(
        "of {count}: {off} differ by more than {DIGITS} digits, {} in doubt:\n{}",
        doubts.len(),
        doubts.join("\n")
    );
    assert!(off as f64 <= EXCEPTIONS * count, "{off} of {count}");
    assert!(doubts.len() as f64 <= DOUBTS * count, "{} of {count}:\n{}", doubts.len(), doubts.join("\n"));
}

#[test]
fn random_systems_are_the_same_in_all_units() {
    let backends = [BackendChoice::Faer, BackendChoice::Sparse, BackendChoice::Gauss];
    let all = [10, 60, 300].into_iter().flat_map(|most| (0..COUNT).map(move |seed| (most, seed)));
    let one = |(most, seed): (i32, u64)| {
        let case = random::case(seed);
        let options = Options {
            backend: backends[seed as usize / 2 % 3],
            presolve: seed.is_multiple_of(2),
            noise: Noise::None,
            ..Options::default()
        };
        let other = in_other_units(&case.base, most, seed % 4 < 2, &mut Rng::new(seed ^ 0x0017));
        compare(&format!("{}, 2^+-{most} [{:?}]", case.name, options.backend), &case.base, &other, &options)
    };
    hold(all.collect::<Vec<_>>().into_par_iter().map(one).collect());
}

#[test]
fn scenes_are_the_same_in_all_units() {
    let scenes = scenes::named();
    let all = [10, 60, 300].into_iter().flat_map(|most| scenes.iter().zip(0..).map(move |scene| (most, scene)));
    let one = |(most, ((name, scene), seed)): (i32, (&scenes::Named, u64))| {
        let options = Options { presolve: seed.is_multiple_of(2), noise: Noise::None, ..Options::default() };
        let other = in_other_units(&scene.system, most, seed % 4 < 2, &mut Rng::new(seed));
        compare(&format!("{name}, 2^+-{most}"), &scene.system, &other, &options)
    };
    hold(all.collect::<Vec<_>>().into_par_iter().map(one).collect());
}

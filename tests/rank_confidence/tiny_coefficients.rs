//! Entries of no size beside others take no rank away without a doubt: `rank(C + E) >= rank(C)` for every small enough E.
//!
//! C is a random system whose SVD is clear, in units of any sizes; E has a few entries of 1e-25 to 1e-300 where C has none. Numbers like
//! these are what cancellation leaves of a zero, or a sine of a whole turn.

use qless::{ConstraintSystem, Options, SystemBuilder, analyse};
use qless_scenes::Rng;
use rayon::prelude::*;

use super::checks::tolerance;
use super::random;
use super::svd_reference::{Case, Truth};

const COUNT: u64 = 4000;

/// A random system in its units with some entries of no size.
pub fn with_tiny(case: &Case, rng: &mut Rng) -> ConstraintSystem {
    let (m, n) = (case.system.equations(), case.system.dofs());
    let power = 25.0 + 275.0 * rng.real().abs();
    let free = |j: &usize| case.system.prescribed().binary_search_by_key(j, |p| p.0).is_err();
    let some = 1 + rng.below(1 + m * n / 8);
    let places: Vec<(usize, usize)> = (0..some).map(|_| (rng.below(m), rng.below(n))).collect();
    let mut builder = SystemBuilder::new(n);
    for i in 0..m {
        let row: Vec<_> = case.system.matrix().row(i).collect();
        let mut own: Vec<usize> = places.iter().filter(|place| place.0 == i).map(|place| place.1).collect();
        // An equation of nothing else is another equation.
        own.retain(|_| row.iter().any(|term| free(&term.0)));
        own.sort_unstable();
        own.dedup();
        own.retain(|j| !row.iter().any(|term| term.0 == *j));
        let tiny: Vec<_> = own.into_iter().map(|j| (j, rng.coefficient(9) * 10f64.powf(-power))).collect();
        builder.equation(row.into_iter().chain(tiny), case.system.rhs()[i]);
    }
    case.system.prescribed().iter().for_each(|&(j, value)| builder.prescribe(j, value));
    builder.build().expect("valid")
}

fn fault(seed: u64) -> Option<String> {
    let case = random::case(seed);
    let options = Options::default();
    let truth = Truth::new(&case.base, tolerance(&options));
    let mut rng = Rng::new(seed ^ 0x7157);
    let system = with_tiny(&case, &mut rng);
    if case.near || !truth.is_clear() || case.system.equations() == 0 {
        return None;
    }
    let alone = analyse(&case.system, &options).ok()?;
    let found = match analyse(&system, &options) {
        Ok(analysis) => analysis,
        Err(error) => return Some(format!("{}: {error}", case.name)),
    };
    let (rank, doubt) = (found.rank(), found.confidence().ambiguous);
    (rank < truth.rank && !doubt)
        .then(|| format!("{}: rank {rank} of {} ({} alone), doubt {doubt}", case.name, truth.rank, alone.rank()))
}

#[test]
fn entries_of_no_size_take_no_rank_away() {
    let faults: Vec<String> = (0..COUNT).into_par_iter().filter_map(fault).collect();
    assert!(faults.is_empty(), "{} faults:\n{}", faults.len(), faults.join("\n"));
}

/// `C_p u_p` is known, whatever its unit: `(C_p s) (u_p / s)` for s of `2^-300` to `2^300` is the same system.
fn changed_by_units_of_prescribed(seed: u64) -> Option<String> {
    let case = random::case(seed);
    let mut rng = Rng::new(seed ^ 0x0b5);
    let prescribed = case.system.prescribed();
    let mut units = vec![1.0; case.system.dofs()];
    prescribed.iter().for_each(|&(j, _)| units[j] = 2f64.powi(rng.below(601) as i32 - 300));
    let mut builder = SystemBuilder::new(units.len());
    for i in 0..case.system.equations() {
        builder.equation(case.system.matrix().row(i).map(|(j, v)| (j, v * units[j])), case.system.rhs()[i]);
    }
    prescribed.iter().for_each(|&(j, value)| builder.prescribe(j, value / units[j]));
    let system = builder.build().expect("valid");
    let of = |system| analyse(system, &Options::default()).expect("valid");
    let (before, after) = (of(&case.system), of(&system));
    let said =
        |analysis: &qless::Analysis| (analysis.rank(), analysis.kinds().to_vec(), analysis.confidence().ambiguous);
    (said(&before) != said(&after)).then(|| format!("{}: {:?} and {:?}", case.name, said(&before), said(&after)))
}

#[test]
fn units_of_prescribed_dofs_change_nothing_that_is_said() {
    let faults: Vec<String> = (0..COUNT).into_par_iter().filter_map(changed_by_units_of_prescribed).collect();
    assert!(faults.is_empty(), "{} faults:\n{}", faults.len(), faults.join("\n"));
}

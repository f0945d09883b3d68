//! Newton's method on independent parts: `solve(A + B)` is `solve(A)` and `solve(B)`, to the last bit.

pub mod mechanism;
pub mod random;

use qless_constraints::ConstraintSet;
use qless_solve::newton::{NewtonError, NewtonIterate, NewtonOptions, NewtonSolution, solve};

use crate::linkages::Outcome;
use mechanism::{Map, Mechanism};
use random::{KINDS, mechanism};

pub const UNITS: [f64; 3] = [1e-6, 1.0, 1e6];

type Found = Result<NewtonSolution, NewtonError>;

/// Mechanisms in one set, with their DOFs and rows.
pub struct Together {
    pub set: ConstraintSet,
    pub start: Vec<f64>,
    pub held: Vec<(usize, f64)>,
    pub maps: Vec<Map>,
    pub rows: Vec<Vec<usize>>,
}

impl Together {
    /// The DOFs of the mechanisms are mixed; with `shared`, they share their last DOF.
    pub fn new(all: &[Mechanism], shared: bool, seed: usize) -> Outcome<Self> {
        let mut maps: Vec<Map> = all.iter().map(|_| Vec::new()).collect();
        let (mut dofs, mut turn) = (0, seed);
        let own = |m: usize| all[m].start.len() - usize::from(shared);
        while let Some(next) = (0..all.len()).map(|k| (turn + k) % all.len()).find(|&m| maps[m].len() < own(m)) {
            maps[next].push(dofs);
            dofs += 1;
            turn += 1 + usize::from(dofs % 4 == seed % 4);
        }
        if shared {
            maps.iter_mut().for_each(|map| map.push(dofs));
            dofs += 1;
        }
        let pairs: Vec<_> = all.iter().zip(&maps).collect();
        let names: Vec<usize> = (0..all.len()).collect();
        let set = mechanism::set(dofs, &pairs, &names, seed)?;
        let (mut start, mut held) = (vec![0.0; dofs], Vec::new());
        for (mechanism, map) in all.iter().zip(&maps) {
            mechanism.start.iter().zip(map).for_each(|(u, &j)| start[j] = *u);
            held.extend(mechanism.held.iter().map(|&(j, v)| (map[j], v)));
        }
        held.sort_by_key(|&(j, _)| j);
        held.dedup_by_key(|&mut (j, _)| j);
        let mut rows = vec![Vec::new(); all.len()];
        for row in 0..set.equations() {
            let label = set.label(row)?;
            let name: usize = label.split(':').next().unwrap_or_default().parse()?;
            rows[name].push(row);
        }
        Ok(Self { set, start, held, maps, rows })
    }

    fn solve(&self, options: &NewtonOptions) -> Found {
        solve(&self.set, &self.start, &self.held, options)
    }
}

/// A mechanism alone, with its labels in the joint set.
fn alone(mechanism: &Mechanism, name: usize, options: &NewtonOptions) -> Outcome<Found> {
    let map: Map = (0..mechanism.start.len()).collect();
    let set = mechanism::set(map.len(), &[(mechanism, &map)], &[name], 0)?;
    Ok(solve(&set, &mechanism.start, &mechanism.held, options))
}

pub fn bits(u: impl IntoIterator<Item = f64>) -> Vec<u64> {
    u.into_iter().map(f64::to_bits).collect()
}

/// Iterates side by side: a mechanism that is done keeps its last iterate.
fn side_by_side(all: &[&NewtonSolution], rows: &[Vec<usize>]) -> Vec<NewtonIterate> {
    let most = all.iter().map(|solution| solution.iterates.len()).max().unwrap_or(0);
    let look = |k: usize| {
        let now = || all.iter().filter_map(move |s| s.iterates.get(k).or(s.iterates.last()));
        let going = all.iter().filter_map(|s| s.iterates.get(k));
        let ignored = now().zip(rows).flat_map(|(look, rows)| look.ignored.iter().map(|&r| rows[r]));
        let mut ignored: Vec<usize> = ignored.collect();
        ignored.sort_unstable();
        NewtonIterate {
            residual: now().map(|look| look.residual).fold(0.0, f64::max),
            rank: now().map(|look| look.rank).sum(),
            ignored,
            length: going.map(|look| look.length).fold(1.0, f64::min),
        }
    };
    (0..most).map(look).collect()
}

/// The error of the mechanism with its rows in the joint set.
pub fn among_others(error: &NewtonError, place: &[usize]) -> NewtonError {
    let mut error = error.clone();
    if let NewtonError::Conflict { rows, .. } = &mut error {
        rows.iter_mut().for_each(|row| *row = place[*row]);
    }
    error
}

/// Checks that the joint result equals that of each mechanism.
fn assert_law(case: &str, together: &Together, found: &Found, single: &[Found]) {
    let failed: Vec<(usize, &NewtonError)> =
        single.iter().enumerate().filter_map(|(m, found)| Some((m, found.as_ref().err()?))).collect();
    let solution = match (found, failed.is_empty()) {
        (Ok(solution), true) => solution,
        (Err(error), false) => {
            let said = |(m, own): &(usize, &NewtonError)| among_others(own, &together.rows[*m]) == *error;
            assert!(failed.iter().any(said), "{case}: {error:?}, alone {failed:?}");
            return;
        }
        _ => panic!("{case}: {found:?}, alone {single:?}"),
    };
    let single: Vec<&NewtonSolution> = single.iter().flatten().collect();
    for (own, map) in single.iter().zip(&together.maps) {
        let there = map.iter().map(|&j| solution.u[j]);
        assert_eq!(bits(there), bits(own.u.iter().copied()), "{case}");
    }
    assert_eq!(solution.iterates, side_by_side(&single, &together.rows), "{case}");
    assert_eq!(Some(&solution.redundant), solution.iterates.last().map(|look| &look.ignored), "{case}");
}

/// How many have a solution side by side, and how many have none alone.
fn check(case: &str, all: &[Mechanism], shared: bool, seed: usize) -> Outcome<[usize; 2]> {
    let options = NewtonOptions::default();
    let together = Together::new(all, shared, seed)?;
    let single: Vec<Found> = (0..all.len()).map(|m| alone(&all[m], m, &options)).collect::<Outcome<_>>()?;
    let failed = single.iter().filter(|found| found.is_err()).count();
    for threads in [1, 2] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
        assert_law(
            &format!("{case}, {threads} threads"),
            &together,
            &pool.install(|| together.solve(&options)),
            &single,
        );
    }
    Ok([usize::from(failed == 0), failed])
}

/// All pairs of kinds, in different units.
#[test]
fn a_mechanism_goes_as_it_goes_alone() -> Outcome {
    let mut count = [0, 0];
    for seed in 0..4 {
        for (a, b) in (0..KINDS).flat_map(|a| (0..KINDS).map(move |b| (a, b))) {
            let units = [UNITS[(seed + a) % 3], UNITS[(seed * 2 + b + a / 3) % 3]];
            let all = [mechanism(a, seed, units[0]), mechanism(b, seed + 50, units[1])];
            let counts = check(&format!("kinds {a} and {b}, seed {seed}, {units:?}"), &all, false, seed + a)?;
            (0..2).for_each(|k| count[k] += counts[k]);
        }
    }
    println!("{count:?}");
    // There are enough of both.
    assert!(count[0] > 200 && count[1] > 100, "{count:?}");
    Ok(())
}

/// The last DOF of both mechanisms is the same prescribed one, in linear and nonlinear rows, with coefficients of all sizes. It does not
/// connect them.
#[test]
fn prescribed_dofs_join_nothing() -> Outcome {
    for seed in 0..3 {
        for (a, b) in (0..KINDS).flat_map(|a| (0..KINDS).map(move |b| (a, b))) {
            let units = [UNITS[(seed + a) % 3], UNITS[(seed + b) % 3]];
            let value = 0.3 * units[0];
            let driven = |kind, seed, unit| mechanism(kind, seed, unit).driven(value, kind == 1);
            let all = [driven(a, seed + 7, units[0]), driven(b, seed + 60, units[1])];
            check(&format!("kinds {a} and {b}, seed {seed}, {units:?}"), &all, true, seed + b)?;
        }
    }
    Ok(())
}

/// Many mechanisms of all kinds that have a solution.
#[test]
fn any_number_of_mechanisms() -> Outcome {
    for seed in 0..30 {
        let drawn = (0..3 + seed % 9).map(|k| mechanism((seed + 5 * k) % KINDS, 100 * seed + k, UNITS[(seed + k) % 3]));
        let all: Vec<Mechanism> = drawn.collect();
        let single: Vec<Found> = all.iter().map(|m| alone(m, 0, &NewtonOptions::default())).collect::<Outcome<_>>()?;
        let found = all.iter().zip(&single).filter(|(_, found)| found.is_ok());
        let fit: Vec<Mechanism> = found.map(|(mechanism, _)| mechanism.clone()).collect();
        for (name, all) in [("all", all), ("those that fit", fit)] {
            check(&format!("{name}, seed {seed}"), &all, false, seed)?;
        }
    }
    Ok(())
}

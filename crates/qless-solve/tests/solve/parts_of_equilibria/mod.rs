//! Equilibria of independent parts: the result for `A + B` is that for A and that for B, to the last bit, if the load steps are the same.

mod many;
mod pieces;

use qless_constraints::ConstraintSet;
use qless_solve::equilibrium::{
    Equilibrium, EquilibriumError, EquilibriumIterate, EquilibriumOptions, Stability, Start, Target, drive, solve,
};

use qless_solve::newton::NewtonError;

use crate::linkages::Outcome;
use crate::parts_of_newton::mechanism::{Item, Mechanism};
use crate::parts_of_newton::{Together, UNITS, among_others, bits};
use pieces::{ALL_KINDS, Piece, Pieces, piece};

type Found = Result<Equilibrium, EquilibriumError>;

fn asked() -> EquilibriumOptions {
    EquilibriumOptions { stability: true, ..EquilibriumOptions::default() }
}

/// All pieces in one model, by [`solve`], or by `drive` from time 0 to 1.
fn found(pieces: &[Piece], together: &mut Together, in_time: bool) -> Found {
    let mut model = Pieces::new(pieces.iter().zip(&together.maps), together.set.dofs());
    let (loads, set, options) = (model.loads(), &mut together.set, asked());
    let start = Start { u: together.start.clone(), ..Start::at_rest(set) };
    let target = Target { loads: &loads, prescribed: &together.held };
    if in_time {
        drive(&mut model, set, &start, &target, 1.0, &options)
    } else {
        solve(&mut model, set, &start, &target, &options)
    }
}

/// The load factors that were tried.
fn tried(found: &Equilibrium) -> Vec<u64> {
    let mut list = bits(found.steps.iter().map(|step| step.factor));
    list.dedup();
    list
}

/// The error of a piece with its DOFs, rows and labels in the joint model, without the load factor, since other pieces may need other steps.
fn said(error: &EquilibriumError, map: &[usize], rows: &[usize], name: Option<usize>) -> String {
    let named = |text: &str| name.map_or(text.to_owned(), |name| text.replace("\"0: ", &format!("\"{name}: ")));
    match error {
        EquilibriumError::Unsupported { dofs, .. } => {
            format!("unsupported {:?}", dofs.iter().map(|&j| map[j]).collect::<Vec<usize>>())
        }
        EquilibriumError::Constraints { source, .. } => match among_others(source, rows) {
            NewtonError::Conflict { rows, labels, others, .. } => named(&format!("{rows:?} {labels:?} {others:?}")),
            other => named(&format!("{other:?}")),
        },
        EquilibriumError::Conflict { labels, .. } => named(&format!("conflict {labels:?}")),
        EquilibriumError::NoConvergence { .. } => "no convergence".into(),
        EquilibriumError::Branch { .. } => "branch".into(),
        other => format!("{other:?}"),
    }
}

fn side_by_side(all: &[&[EquilibriumIterate]]) -> Vec<EquilibriumIterate> {
    let most = all.iter().map(|iterates| iterates.len()).max().unwrap_or(0);
    let look = |k: usize| {
        let now = || all.iter().filter_map(move |own| own.get(k).or(own.last()));
        let going = || all.iter().filter_map(move |own| own.get(k));
        EquilibriumIterate {
            force: now().map(|i| i.force).fold(0.0, f64::max),
            constraint: now().map(|i| i.constraint).fold(0.0, f64::max),
            length: going().map(|i| i.length).fold(1.0, f64::min),
            regularised: going().any(|i| i.regularised),
        }
    };
    (0..most).map(look).collect()
}

/// Checks that the joint result equals that of each piece; returns how many pieces were compared.
fn assert_law(
    case: &str,
    pieces: &[Piece],
    together: &Together,
    found: &Found,
    single: &[Found],
    sets: &[ConstraintSet],
) -> [usize; 2] {
    let failed: Vec<usize> = (0..single.len()).filter(|&m| single[m].is_err()).collect();
    if !failed.is_empty() {
        let error = match found {
            Err(error) => error,
            // The piece alone has other load steps.
            Ok(found) if tried(found).len() > 1 => return [0, 0],
            Ok(_) => panic!("{case}: it fails alone"),
        };
        let whole: Vec<usize> = (0..together.set.dofs().max(together.set.equations())).collect();
        let text = said(error, &whole, &whole, None);
        let own = |m: usize| Some(said(single[m].as_ref().err()?, &together.maps[m], &together.rows[m], Some(m)));
        let names: Vec<String> = failed.iter().filter_map(|&m| own(m)).collect();
        // If all other pieces converge, the load steps are those of the piece that fails.
        assert!(names.contains(&text), "{case}: {text}, alone {names:?}");
        return [0, 1];
    }
    let alone: Vec<&Equilibrium> = single.iter().flatten().collect();
    if alone.iter().any(|own| tried(own) != tried(alone[0])) {
        return [0, 0];
    }
    let found = found.as_ref().unwrap_or_else(|error| panic!("{case}: {error}"));
    assert_eq!(tried(found), tried(alone[0]), "{case}");
    for (m, own) in alone.iter().enumerate() {
        let (map, rows) = (&together.maps[m], &together.rows[m]);
        assert_eq!(bits(map.iter().map(|&j| found.u[j])), bits(own.u.iter().copied()), "{case}: u of {m}");
        let lambda = found.multipliers.in_rows(&together.set).expect("of this set");
        let multipliers = rows.iter().map(|&r| lambda[r]);
        let alone = own.multipliers.in_rows(&sets[m]).expect("of this set");
        assert_eq!(bits(multipliers), bits(alone.into_iter()), "{case}: multipliers of {m}");
        let redundant: Vec<usize> = (0..rows.len()).filter(|&r| found.redundant.contains(&rows[r])).collect();
        assert_eq!(redundant, own.redundant, "{case}: {m}");
        let shared = |j: &usize| together.maps.iter().filter(|map| map.contains(j)).count() > 1;
        for &(j, _) in pieces[m].mechanism.held.iter().filter(|(j, _)| !shared(&map[*j])) {
            let reactions = [found.reactions[map[j]], own.reactions[j]].map(f64::to_bits);
            assert_eq!(reactions[0], reactions[1], "{case}: reaction of {m}");
        }
        let forces = map.iter().zip(&own.constraint_forces).filter(|(j, _)| !shared(j));
        let (there, own): (Vec<f64>, Vec<f64>) = forces.map(|(&j, f)| (found.constraint_forces[j], *f)).unzip();
        assert_eq!(bits(there), bits(own), "{case}: constraint forces of {m}");
    }
    if alone.iter().all(|own| own.steps.len() == tried(own).len()) {
        for (k, step) in found.steps.iter().enumerate() {
            let iterates: Vec<&[EquilibriumIterate]> = alone.iter().map(|own| &own.steps[k].iterates[..]).collect();
            assert_eq!(step.iterates, side_by_side(&iterates), "{case}: step {k}");
            assert_eq!(step.branches_meet, alone.iter().any(|own| own.steps[k].branches_meet), "{case}");
        }
    }
    assert_eq!(found.stability, Some(of_all(alone.iter().filter_map(|own| own.stability))), "{case}");
    [1, 0]
}

fn of_all(parts: impl Iterator<Item = Stability>) -> Stability {
    let parts: Vec<Stability> = parts.collect();
    let directions = |part: &Stability| if let Stability::Unstable { directions } = part { *directions } else { 0 };
    match parts.iter().map(directions).sum() {
        _ if parts.contains(&Stability::NotSymmetric) => Stability::NotSymmetric,
        _ if parts.contains(&Stability::Undecided) => Stability::Undecided,
        0 => Stability::Stable,
        directions => Stability::Unstable { directions },
    }
}

/// How many were compared, and how many of these had errors.
fn check(case: &str, pieces: &[Piece], shared: bool, in_time: bool, seed: usize) -> Outcome<[usize; 2]> {
    let mechanisms: Vec<Mechanism> = pieces.iter().map(|piece| piece.mechanism.clone()).collect();
    let single = |piece: &Piece| -> Outcome<(Found, ConstraintSet)> {
        let mut alone = Together::new(std::slice::from_ref(&piece.mechanism), false, 0)?;
        let found = found(std::slice::from_ref(piece), &mut alone, in_time);
        Ok((found, alone.set))
    };
    let (single, sets): (Vec<Found>, Vec<_>) =
        pieces.iter().map(single).collect::<Outcome<Vec<_>>>()?.into_iter().unzip();
    let mut together = Together::new(&mechanisms, shared, seed)?;
    let all = found(pieces, &mut together, in_time);
    Ok(assert_law(case, pieces, &together, &all, &single, &sets))
}

fn units(seed: usize) -> [f64; 2] {
    [UNITS[seed % 3], UNITS[seed / 3 % 3]]
}

/// One of all pairs of kinds.
fn pairs(of: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..ALL_KINDS).flat_map(|a| (0..ALL_KINDS).map(move |b| (a, b))).filter(move |(a, b)| (a + b).is_multiple_of(of))
}

/// Pairs of all kinds, in different units of length and force.
#[test]
fn a_piece_goes_as_it_goes_alone() -> Outcome {
    let mut count = [0, 0];
    for (a, b) in pairs(2) {
        let pieces = [piece(a, a % 4, units(a)), piece(b, 50 + b % 3, units(5 * a + b))];
        let counts = check(&format!("kinds {a} and {b}"), &pieces, false, false, a)?;
        (0..2).for_each(|k| count[k] += counts[k]);
    }
    println!("{count:?}");
    // There are enough of both.
    assert!(count[0] > 60 && count[1] > 60, "{count:?}");
    Ok(())
}

/// The last DOF of both pieces is the same prescribed one, which does not connect them.
#[test]
fn prescribed_dofs_join_nothing() -> Outcome {
    let mut count = [0, 0];
    for (a, b) in pairs(5) {
        let value = 0.3 * UNITS[a % 3];
        let driven = |kind: usize, seed: usize| {
            let mut own = piece(kind, seed, [UNITS[a % 3], UNITS[(kind + seed) % 3]]);
            if own.mechanism.held[0].1 == 0.0 {
                own.mechanism.held[0].1 = 0.1 * value;
            }
            own.mechanism = own.mechanism.driven(value, kind == 1);
            let last = own.mechanism.start.len() - 1;
            own.mechanism.start[last] = 0.0;
            own.loads.push(0.0);
            own
        };
        let counts = check(&format!("kinds {a} and {b}"), &[driven(a, 7), driven(b, 60)], true, false, a + 2 * b)?;
        (0..2).for_each(|k| count[k] += counts[k]);
    }
    println!("{count:?}");
    assert!(count[0] > 20 && count[1] > 20, "{count:?}");
    Ok(())
}

/// DOFs that functions of time drive.
#[test]
fn time_is_that_of_all() -> Outcome {
    let mut count = [0, 0];
    for (a, b) in pairs(3) {
        let driven = |kind: usize, seed: usize| {
            let mut own = piece(kind, seed, units(a + b));
            let (dof, value) = own.mechanism.held.remove(0);
            own.mechanism.start[dof] = 0.0;
            own.mechanism.items.push(Item::Drive(dof, value));
            own
        };
        let counts = check(&format!("kinds {a} and {b}"), &[driven(a, 11), driven(b, 70)], false, true, a + b)?;
        (0..2).for_each(|k| count[k] += counts[k]);
    }
    println!("{count:?}");
    assert!(count[0] > 30 && count[1] > 15, "{count:?}");
    Ok(())
}

//! Many parts in one model: their cost, and errors of single parts.

use qless_solve::equilibrium::{Equilibrium, EquilibriumError, EquilibriumOptions, Start, Target, solve};

use super::pieces::{Piece, Pieces, piece};
use super::{UNITS, asked, check, tried};
use crate::linkages::{Outcome, random};
use crate::parts_of_newton::mechanism::{Item, Mechanism};
use crate::parts_of_newton::{Together, bits};

/// Also counts the evaluations of the model.
fn counted(pieces: &[Piece], seed: usize, options: &EquilibriumOptions) -> Outcome<(Equilibrium, usize, Together)> {
    let mechanisms: Vec<Mechanism> = pieces.iter().map(|piece| piece.mechanism.clone()).collect();
    let together = Together::new(&mechanisms, false, seed)?;
    let mut model = Pieces::new(pieces.iter().zip(&together.maps), together.set.dofs());
    let loads = model.loads();
    let start = Start { u: together.start.clone(), ..Start::at_rest(&together.set) };
    let target = Target { loads: &loads, prescribed: &together.held };
    let found = solve(&mut model, &together.set, &start, &target, options)?;
    Ok((found, model.evaluations, together))
}

/// A pendulum on a spring.
fn pendulum(seed: usize) -> Piece {
    let items = vec![Item::Arm((1, [1.0, 0.2 * random(seed)]), [0.0; 2], None)];
    let mechanism = Mechanism { items, start: vec![0.0; 3], held: vec![(0, 0.0)] };
    let springs = vec![([2, 2], [1.0, 0.0]), ([1, 2], [1.0, 3.0])];
    Piece { mechanism, springs, loads: vec![0.0, 0.1, random(seed + 9)], limit: None }
}

/// Ten thousand pieces take as many evaluations as the slowest of them alone.
#[test]
fn ten_thousand_parts() -> Outcome {
    let kinds: Vec<Piece> = (0..20).map(pendulum).collect();
    let alone: Vec<_> =
        kinds.iter().map(|own| counted(std::slice::from_ref(own), 0, &asked())).collect::<Outcome<_>>()?;
    let most = alone.iter().map(|(_, evaluations, _)| *evaluations).max().unwrap_or(0);
    let all: Vec<Piece> = (0..10_000).map(|k| kinds[k % 20].clone()).collect();
    let (found, evaluations, together) = counted(&all, 0, &asked())?;
    // Step lengths are tried for all parts together, so that a part with more trials in one step may have fewer in another.
    assert!(evaluations >= most && evaluations <= 2 * most, "{evaluations} {most}");
    for (m, map) in together.maps.iter().enumerate() {
        assert_eq!(bits(map.iter().map(|&j| found.u[j])), bits(alone[m % 20].0.u.iter().copied()), "{m}");
    }
    Ok(())
}

/// The model rejects one of many parts: it is found by bisection, and takes a shorter step alone.
#[test]
fn the_part_that_the_model_refuses_is_found() -> Outcome {
    for count in [1, 2, 7, 64, 500] {
        let refused = piece(17, 3, [1.0, 1.0]);
        let (alone, own, _) = counted(std::slice::from_ref(&refused), 0, &asked())?;
        assert!(alone.steps[0].iterates.iter().any(|i| i.length < 1.0), "{:?}", alone.steps);
        let mut all: Vec<Piece> = (0..count).map(pendulum).collect();
        let (others, without, _) = counted(&all, 0, &asked())?;
        all.insert(count / 2, refused);
        let (found, evaluations, together) = counted(&all, count, &asked())?;
        if tried(&alone) == tried(&others) {
            let map = &together.maps[count / 2];
            assert_eq!(bits(map.iter().map(|&j| found.u[j])), bits(alone.u.iter().copied()), "{count}");
        }
        // Each rejection of the part alone costs at most two evaluations per bisection.
        let halvings = 2 * (usize::BITS - count.leading_zeros()) as usize + 2;
        assert!(evaluations <= own + without + own * halvings, "{count}: {evaluations}, {own} and {without}");
    }
    Ok(())
}

/// Unsupported parts are named by their own DOFs, the one with the lowest first, whatever the other parts are.
#[test]
fn motions_are_named_part_by_part() -> Outcome {
    for seed in 0..12 {
        let loose = |k: usize| {
            let [unit, force] = [UNITS[(seed + k) % 3], UNITS[(seed + 2 * k) % 3]];
            Piece { loads: vec![0.0, force, 0.0, 0.0], ..piece(16, k, [unit, force]) }
        };
        let mut pieces = [loose(0), piece(13, seed, [UNITS[seed % 3], 1.0]), loose(1), pendulum(seed)];
        pieces.rotate_left(seed % 4);
        let mechanisms: Vec<Mechanism> = pieces.iter().map(|piece| piece.mechanism.clone()).collect();
        let together = Together::new(&mechanisms, false, seed)?;
        let mut model = Pieces::new(pieces.iter().zip(&together.maps), together.set.dofs());
        let (loads, start) = (model.loads(), Start::at_rest(&together.set));
        let target = Target { loads: &loads, prescribed: &together.held };
        let error = solve(&mut model, &together.set, &start, &target, &asked());
        let Err(EquilibriumError::Unsupported { mut dofs, .. }) = error else { panic!("{seed}: {error:?}") };
        dofs.sort_unstable();
        let of_loose = pieces
            .iter()
            .zip(&together.maps)
            .filter(|(piece, _)| piece.springs.len() == 2 && piece.mechanism.items.is_empty());
        let first = of_loose.map(|(_, map)| map[1..].to_vec()).min();
        assert_eq!(Some(dofs), first, "{seed}");
    }
    Ok(())
}

/// Any number of pieces in any order.
#[test]
fn any_number_of_pieces() -> Outcome {
    let mut count = [0, 0];
    for seed in 0..20 {
        let kind = |k: usize| [13, 14, 15, 18, 2, 4, 3][(seed + 3 * k) % 7];
        let unit = |k: usize| [UNITS[(seed + k) % 3], UNITS[(2 * seed + k) % 3]];
        let mut pieces: Vec<Piece> = (0..3 + seed % 9).map(|k| piece(kind(k), 40 * seed + k, unit(k))).collect();
        for order in ["as drawn", "backwards"] {
            let counts = check(&format!("{order}, seed {seed}"), &pieces, false, false, seed)?;
            (0..2).for_each(|k| count[k] += counts[k]);
            pieces.reverse();
        }
    }
    println!("{count:?}");
    assert!(count[0] > 5, "{count:?}");
    Ok(())
}

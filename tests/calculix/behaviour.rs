//! Small decks with one fault or none: the faults are found, and `ccx` solves the cleaned decks.

use qless::{Kind, Options, analyse};
use qless_io::deck::clean::{CleanError, FaultKind, faults};
use qless_io::deck::{self, Deck};

use super::solver::{cleaned, decks, difference, inputs, is_there, solve, stem};

/// The expected findings of a deck.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Finding {
    redundant: usize,
    conflicting: usize,
    ambiguous: bool,
    /// Slaves that are prescribed.
    prescribed: usize,
    /// Equations with the slave of another.
    twice: usize,
    /// Slaves with a zero coefficient.
    zero: usize,
    /// Free DOFs that the equations fix.
    generated: usize,
}

const NOTHING: Finding =
    Finding { redundant: 0, conflicting: 0, ambiguous: false, prescribed: 0, twice: 0, zero: 0, generated: 0 };

/// The expected findings of each deck; decks not listed are sound.
fn known(name: &str) -> Finding {
    match name {
        "b2_redundant_cycle" | "b3_redundant_numeric" | "b4_redundant_roundoff" | "e4_scaled_duplicate_other_slave" => {
            Finding { redundant: 1, ..NOTHING }
        }
        "b_redundant_repeat" | "e3_duplicate_equation" => Finding { redundant: 1, twice: 1, ..NOTHING },
        "c_slave_in_boundary" | "c3_slave_boundary_in_step" => Finding { prescribed: 1, generated: 1, ..NOTHING },
        "c2_other_slave" => Finding { generated: 1, ..NOTHING },
        "c4_all_terms_prescribed" => Finding { redundant: 1, prescribed: 1, ..NOTHING },
        "d_conflict_same_slave" => Finding { conflicting: 1, twice: 1, ..NOTHING },
        "d2_conflict_other_slave" | "d4_two_spc_values" => Finding { conflicting: 1, ..NOTHING },
        "d3_conflict_dummy_slave" => Finding { conflicting: 1, prescribed: 1, ..NOTHING },
        // Silent in ccx: 1e-8 from a conflict, which gives displacements of 1e5; 1e-10 from redundant, which fixes both DOFs.
        "d5_near_conflict" | "d6_tiny_pivot" => Finding { ambiguous: true, generated: 2, ..NOTHING },
        "e2_zero_slave_coef" => Finding { zero: 1, generated: 1, ..NOTHING },
        _ => NOTHING,
    }
}

fn found(deck: &Deck) -> Finding {
    let system = deck.model().system(&deck.model().cases()[0]).expect("a system");
    let analysis = analyse(&system, &Options::default()).expect("analysed");
    let of = |kind| analysis.dependent().iter().filter(|dependent| dependent.kind == kind).count();
    let faults = faults(deck.model());
    let count = |is: fn(FaultKind) -> bool| faults.iter().filter(|fault| is(fault.kind)).count();
    Finding {
        redundant: of(Kind::Redundant),
        conflicting: of(Kind::Conflicting),
        ambiguous: analysis.confidence().ambiguous,
        prescribed: count(|kind| matches!(kind, FaultKind::SlavePrescribed { .. })),
        twice: count(|kind| matches!(kind, FaultKind::SlaveTwice { .. })),
        zero: count(|kind| kind == FaultKind::SlaveVanishes),
        generated: analysis.generated().len(),
    }
}

#[test]
fn every_deck_gets_its_diagnosis_and_is_solved_after_cleaning() {
    let Some(folder) = decks("calculix-behaviour").filter(|_| is_there()) else { return };
    let (mut count, mut changed) = (0, 0);
    for path in inputs(&folder) {
        let name = stem(&path);
        if name == "f_nonexisting_node" {
            let error = deck::read(&path).expect_err("a node is missing").to_string();
            assert!(
                error.ends_with(":24: *EQUATION: node 999 is not defined; define it or correct the name"),
                "{error}"
            );
            continue;
        }
        let deck = deck::read(&path).expect("a deck");
        let finding = found(&deck);
        let is_chain = name.starts_with("chain") || name.starts_with("dense_row");
        assert!(
            finding == known(name) || is_chain && finding == Finding { generated: finding.generated, ..NOTHING },
            "{name}: {finding:?}"
        );
        count += 1;
        if finding.conflicting > 0 {
            assert!(matches!(cleaned(&deck), Err(CleanError::Conflicting { .. })), "{name}");
            continue;
        }
        let text = cleaned(&deck).unwrap_or_else(|error| panic!("{name}: {error}"));
        if text == *deck.texts()[0] && is_chain {
            continue; // Byte for byte what ccx is known to solve.
        }
        changed += usize::from(text != *deck.texts()[0]);
        let after = solve(&text).unwrap_or_else(|| panic!("{name}: ccx refuses the cleaned deck"));
        if let Some(before) = solve(&deck.texts()[0]) {
            assert!(difference(&before, &after) <= 1e-6, "{name}");
        }
    }
    println!("{count} decks diagnosed, {changed} changed by cleaning and solved");
    assert!(count >= 28 && changed >= 11);
}

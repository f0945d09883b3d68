//! Rotations of references that nothing holds: ccx ends with a singular matrix exactly where that is said.

use super::loss::bars;
use super::solver::{SINGULAR, is_there, parse, run};

/// Deck with a reference 300 for nodes 105 to 108, which are the corners of a square, and 301 for its rotation.
fn deck(reference: [f64; 3], card: &str, held: &str) -> String {
    let [x, y, z] = reference;
    bars(&format!("*NODE, NSET=NALL\n300,{x},{y},{z}\n301,{x},{y},{z}\n{card}{held}"), "")
}

/// Whether a refusal is expected for this deck, and whether ccx ends so.
fn outcomes(text: &str) -> (bool, bool) {
    let deck = parse(text.as_bytes());
    let found = run(text.as_bytes());
    assert!(found.is_ok() || found == Err(SINGULAR), "{text}");
    (deck.model().refusals().iter().any(|refusal| refusal.text.contains("nothing holds rotation")), found.is_err())
}

#[test]
fn ccx_stops_where_a_rotation_is_free() {
    if !is_there() {
        return;
    }
    let (mut refused, mut all) = (0, 0);
    for nodes in ["105\n106\n", "105\n106\n107\n108\n", "105\n107\n", "105\n"] {
        for reference in [[3.0, 0.0, 0.5], [3.0, 0.5, 0.0], [3.5, 0.2, 0.3]] {
            let mut decks = vec![];
            for held in ["", "*BOUNDARY\n301,3\n", "*BOUNDARY\n301,1,3\n"] {
                let body = format!("*NSET, NSET=N\n{nodes}*RIGID BODY, NSET=N, REF NODE=300, ROT NODE=301\n");
                decks.push(deck(reference, &body, held));
            }
            for range in ["1,3", "1,1", "2,3"] {
                for held in ["", "*BOUNDARY\n300,6\n", "*BOUNDARY\n300,4,6\n"] {
                    let surface = format!("*SURFACE, NAME=N, TYPE=NODE\n{nodes}");
                    let axes = "*ORIENTATION, NAME=OR\n1,0,0,0,1,0\n";
                    for (axes, name) in [("", ""), (axes, ", ORIENTATION=OR")] {
                        let card = format!("*COUPLING, REF NODE=300, SURFACE=N, CONSTRAINT NAME=C{name}\n*KINEMATIC");
                        decks.push(deck(reference, &format!("{surface}{axes}{card}\n{range}\n"), held));
                    }
                }
            }
            for text in decks {
                let (is_said, is_found) = outcomes(&text);
                // Rounding may hold a rotation about a slanted line.
                let is_slanted =
                    || parse(text.as_bytes()).model().warnings().iter().any(|w| w.text.starts_with("ccx may stop"));
                assert!(is_said == is_found || is_slanted(), "said {is_said}: {text}");
                (refused, all) = (refused + usize::from(is_found), all + 1);
            }
        }
    }
    println!("{all} decks, {refused} singular");
    assert!(refused > 20 && refused < all - 20);
}

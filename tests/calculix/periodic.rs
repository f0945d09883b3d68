//! Cubes with naive periodic ties: over-constrained as written, solved after cleaning as after an exact clean-up.

use qless::{Kind, Options, analyse};
use qless_io::deck;

use super::solver::{cleaned, decks, difference, is_there, solve};

#[test]
fn naive_ties_are_cleaned_to_the_exact_answer() {
    let Some(folder) = decks("periodic-cube").filter(|_| is_there()) else { return };
    for (name, equations, rank) in [("rve1", 36, 21), ("rve3", 144, 111)] {
        let deck = deck::read(&folder.join(format!("{name}_naive.inp"))).expect("a deck");
        let system = deck.model().system(&deck.model().cases()[0]).expect("a system");
        let analysis = analyse(&system, &Options::default()).expect("analysed");
        assert_eq!((system.equations(), analysis.rank()), (equations, rank), "{name}");
        assert!(analysis.dependent().iter().all(|dependent| dependent.kind == Kind::Redundant), "{name}");
        assert!(solve(&deck.texts()[0]).is_none(), "{name}: ccx refuses the naive deck");
        let solved = solve(&cleaned(&deck).expect("consistent")).expect("ccx solves the cleaned deck");
        let truth = std::fs::read_to_string(folder.join(format!("{name}_clean0.dat"))).expect("the exact answer");
        let truth: Vec<String> = truth.split_whitespace().map(str::to_owned).collect();
        let difference = difference(&truth, &solved);
        println!("{name}: {equations} equations, rank {rank}, difference {difference:.1e}");
        assert!(difference <= 1e-7, "{name}: {difference:e}");
    }
}

//! Systems near dependence: the rank may be ambiguous, and must be if the distance is small.

use proptest::prelude::*;
use qless::{BackendChoice, SystemBuilder};
use qless_scenes::families::{self, Near};
use qless_scenes::{Scene, oracle};

use super::change::{Change, Units, changes, variants};
use super::families::planted;
use crate::support::{diagnose, settings};
use crate::{hold, scene};

on_each_backend!(triples_near_dependence, combinations_near_dependence);

/// Only the original units, because other units change the distance to dependence.
fn check_doubt(backend: BackendChoice, scene: &Scene, change: &Change, ranks: [usize; 2]) {
    for variant in variants(scene, change) {
        for options in settings(backend) {
            let analysis = diagnose(&variant.system, &options);
            let what = format!("{}, presolve {}, {:?}", variant.name, options.presolve, analysis.confidence());
            let rank = analysis.rank();
            assert!((ranks[0]..=ranks[1]).contains(&rank), "rank {rank} for {ranks:?}, {what}");
            assert!(analysis.confidence().ambiguous, "{what}");
        }
    }
}

fn triples_near_dependence(backend: BackendChoice) {
    let column = prop_oneof![Just(Near::Own), Just(Near::Shared)];
    hold(160, &(1_usize..5, 8..=14_i32, column, changes(Units::Kept)), |(triples, digits, column, change)| {
        let scene = families::near(triples, 10_f64.powi(-digits), column).expect("in range");
        check_doubt(backend, &scene, &change, [2 * triples, 3 * triples]);
    });
}

/// A planted combination with one coefficient off by a part in 10^8 to 10^10, which makes it independent: its distance
/// from the others is at most twice that part.
fn combinations_near_dependence(backend: BackendChoice) {
    hold(
        160,
        &(planted(), 8..=10_i32, any::<prop::sample::Index>(), changes(Units::Kept)),
        |((planted, seed), digits, index, change)| {
            let exact = planted.scene(seed).expect("in range").system;
            let combination = (0..exact.equations()).find(|&i| exact.equation_label(i).starts_with("combination"));
            let Some(row) = combination.filter(|&i| exact.matrix().row(i).len() > 0) else { return };
            let off = index.index(exact.matrix().row(row).len());
            let mut builder = SystemBuilder::new(exact.dofs());
            for i in 0..exact.equations() {
                let factor = |k: usize| if (i, k) == (row, off) { 1.0 + 10_f64.powi(-digits) } else { 1.0 };
                builder.equation(exact.matrix().row(i).enumerate().map(|(k, (j, v))| (j, v * factor(k))), 0.0);
            }
            let near = scene(builder.build().expect("valid"));
            let rank = oracle::rank_free(&near.system).expect("within reach");
            // If the others fix the DOF of the coefficient, the row is still dependent.
            if rank > planted.rows {
                check_doubt(backend, &near, &change, [planted.rows, rank]);
            }
        },
    );
}

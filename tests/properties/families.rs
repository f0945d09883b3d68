//! Models of known rank: planted combinations, graphs, rigid spiders, periodic cells.

use proptest::collection::vec;
use proptest::prelude::*;
use qless::BackendChoice;
use qless_scenes::Rng;
use qless_scenes::families::{self, Planted};

use super::change::{Units, changes};
use super::identities::check;
use crate::hold;

on_each_backend!(
    combinations_planted_in_sparse_rows,
    combinations_planted_in_sparse_rows_in_units,
    graphs_with_closed_cycles,
    graphs_with_closed_cycles_in_units,
    rigid_spiders,
    rigid_spiders_in_units,
    periodic_cells,
    periodic_cells_in_units,
);

pub fn planted() -> impl Strategy<Value = (Planted, u64)> {
    let sizes = (1_usize..25, 0_usize..25, 0_usize..12, 2_usize..7);
    (sizes, any::<bool>(), 0_u64..1000).prop_map(|((rows, more, combos, terms), conflict, seed)| {
        (Planted { rows, dofs: rows + more, combos, terms, conflict: conflict && combos > 0 }, seed)
    })
}

fn combinations_planted_in_sparse_rows(backend: BackendChoice) {
    check_planted(backend, Units::Kept);
}

fn combinations_planted_in_sparse_rows_in_units(backend: BackendChoice) {
    check_planted(backend, Units::Mixed);
}

fn check_planted(backend: BackendChoice, units: Units) {
    hold(160, &(planted(), changes(units)), |((planted, seed), change)| {
        check(backend, &planted.scene(seed).expect("in range"), &change, None);
    });
}

/// Nodes and edges `(a, b, gap)`; the steps around a cycle add up to the sum of its gaps.
fn graphs() -> impl Strategy<Value = (usize, Vec<(usize, usize, f64)>)> {
    let gap = prop_oneof![9 => Just(0.0), 1 => (-3..=3).prop_map(f64::from)];
    (2_usize..25).prop_flat_map(move |nodes| {
        let edge = (0..nodes, 1..nodes, gap.clone()).prop_map(move |(a, step, gap)| (a, (a + step) % nodes, gap));
        (Just(nodes), vec(edge, 1..40))
    })
}

/// A random whole number for each DOF: a solution from which right-hand sides are computed.
pub fn solution(dofs: usize, seed: u64) -> Vec<f64> {
    let mut rng = Rng::new(seed);
    (0..dofs).map(|_| rng.below(19) as f64 - 9.0).collect()
}

fn graphs_with_closed_cycles(backend: BackendChoice) {
    check_graphs(backend, Units::Kept);
}

fn graphs_with_closed_cycles_in_units(backend: BackendChoice) {
    check_graphs(backend, Units::Mixed);
}

fn check_graphs(backend: BackendChoice, units: Units) {
    hold(240, &(graphs(), changes(units)), |((nodes, edges), change)| {
        let potential = solution(nodes, change.order);
        let steps: Vec<_> = edges.iter().map(|&(a, b, gap)| (a, b, potential[a] - potential[b] + gap)).collect();
        check(backend, &families::incidence(nodes, &steps).expect("in range"), &change, None);
    });
}

fn rigid_spiders(backend: BackendChoice) {
    check_spiders(backend, Units::Kept);
}

fn rigid_spiders_in_units(backend: BackendChoice) {
    check_spiders(backend, Units::Mixed);
}

fn check_spiders(backend: BackendChoice, units: Units) {
    hold(40, &(3_usize..9, 1_usize..=2, 0_u64..1000, changes(units)), |(legs, masters, seed, change)| {
        check(backend, &families::rbe2(legs, masters, seed).expect("in range"), &change, None);
    });
}

fn periodic_cells(backend: BackendChoice) {
    check_cells(backend, Units::Kept);
}

fn periodic_cells_in_units(backend: BackendChoice) {
    check_cells(backend, Units::Mixed);
}

fn check_cells(backend: BackendChoice, units: Units) {
    hold(6, &(1_usize..=2, changes(units)), |(n, change)| {
        check(backend, &families::rve(n).expect("in range"), &change, None);
    });
}

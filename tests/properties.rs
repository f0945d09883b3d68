//! Random systems whose truth is known exactly, in random order and in random units, on every backend.
//!
//! All coefficients are whole numbers, so the oracle's rank, consistency and fixed DOFs are those of the system. No change
//! of order, of row scale or of units (from 1e-6 to 1e6) may change them. Seeds are fixed; systems found wrong once
//! are kept as a test.

#[macro_use]
mod support;

use proptest::collection::vec;
use proptest::prelude::*;
use proptest::test_runner::{Config, FileFailurePersistence, RngSeed, TestRunner};
use qless::{Analysis, BackendChoice, ConstraintSystem, Csr, Dependent, Kind, Options, SystemBuilder};
use qless_scenes::families::{self, Near, Planted};
use qless_scenes::{Rng, Scene, Truth, oracle};
use support::{certificate_error, check_certificates, check_reduction, diagnose, settings};

on_each_backend!(
    combinations_planted_in_sparse_rows,
    combinations_planted_in_sparse_rows_in_units,
    graphs_with_closed_cycles,
    graphs_with_closed_cycles_in_units,
    rigid_spiders,
    rigid_spiders_in_units,
    periodic_cells,
    periodic_cells_in_units,
    small_dense_systems,
    small_dense_systems_in_units,
    prescribed_dofs,
    prescribed_dofs_in_units,
    small_systems_found_wrong_once,
    triples_near_dependence,
    combinations_near_dependence,
);

/// Runs a check on as many random values; the same ones each time.
fn hold<S: Strategy>(cases: u32, strategy: &S, check: impl Fn(S::Value)) {
    let config = Config {
        cases,
        rng_seed: RngSeed::Fixed(20_251_120),
        source_file: Some(file!()),
        failure_persistence: Some(Box::new(FileFailurePersistence::WithSource("proptest-regressions"))),
        ..Config::default()
    };
    let run = |value| {
        check(value);
        Ok(())
    };
    if let Err(failure) = TestRunner::new(config).run(strategy, run) {
        panic!("{failure}");
    }
}

/// Seeds by which a system is put in another way.
#[derive(Clone, Debug)]
struct Change {
    order: u64,
    rows: u64,
    units: u64,
    /// DOFs are measured in these powers of ten; none for no change of units.
    decades: Vec<i32>,
}

/// Whether DOFs are measured in other units, from 1e-6 to 1e6: that rounds coefficients.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Units {
    Kept,
    Mixed,
}

fn changes(units: Units) -> impl Strategy<Value = Change> {
    let decades = if units == Units::Kept { vec(0..=0, 0).boxed() } else { vec(-6..=6_i32, 1..=4).boxed() };
    (0_u64..1000, 0_u64..1000, 0_u64..1000, decades).prop_map(|(order, rows, units, decades)| Change {
        order,
        rows,
        units,
        decades,
    })
}

impl Change {
    fn units(&self, dofs: usize) -> Vec<f64> {
        let mut rng = Rng::new(self.units);
        let mut unit = || 10_f64.powi(*self.decades.get(rng.below(self.decades.len())).unwrap_or(&0));
        (0..dofs).map(|_| unit()).collect()
    }
}

/// One way to put a system.
struct Variant {
    name: &'static str,
    system: ConstraintSystem,
    /// What DOF j was.
    dofs: Vec<usize>,
    /// Unit of DOF j.
    units: Vec<f64>,
    /// Whether coefficients are still exact.
    exact: bool,
}

/// As it is, in another order, with rows scaled and in both; in other units twice and else not at all.
fn variants(scene: &Scene, change: &Change) -> Vec<Variant> {
    let units = change.units(scene.system.dofs());
    let measured = if change.decades.is_empty() { scene.clone() } else { scene.scale_dofs(&units).expect("in range") };
    let scaled = |scene: &Scene| scene.scale_rows(40, change.rows).expect("in range").0;
    let shuffled = |scene: &Scene| scene.shuffle(change.order).expect("as valid as before");
    let variant = |name, scene: Scene, dofs: Vec<usize>| Variant {
        name,
        system: scene.system,
        units: dofs.iter().map(|&j| units[j]).collect(),
        dofs,
        exact: change.decades.is_empty(),
    };
    let natural = || (0..scene.system.dofs()).collect::<Vec<_>>();
    let (in_order, order) = shuffled(&measured);
    let (both, order_of_both) = shuffled(&scaled(&measured));
    vec![
        variant("as it is", measured.clone(), natural()),
        variant("shuffled", in_order, order.dofs),
        variant("rows scaled", scaled(&measured), natural()),
        variant("shuffled and rows scaled", both, order_of_both.dofs),
    ]
}

/// What is true of the free part of a system.
#[derive(Debug, PartialEq)]
struct Exact {
    rank: usize,
    dependent: usize,
    conflicting: bool,
    generated: Vec<usize>,
}

impl Exact {
    fn of(system: &ConstraintSystem) -> Self {
        let rank = oracle::rank_free(system);
        Self {
            rank,
            dependent: system.equations() - rank,
            conflicting: !oracle::consistent(system),
            generated: oracle::generated(system),
        }
    }

    fn found(analysis: &Analysis, dofs: &[usize]) -> Self {
        let mut generated: Vec<usize> = analysis.generated.iter().map(|&(j, _)| dofs[j]).collect();
        generated.sort_unstable();
        Self {
            rank: analysis.rank(),
            dependent: analysis.dependent.len(),
            conflicting: analysis.kinds.contains(&Kind::Conflicting),
            generated,
        }
    }
}

/// Every property of every variant; `solution` solves the system as it is, where one is known.
fn check(backend: BackendChoice, scene: &Scene, change: &Change, solution: Option<&[f64]>) {
    let exact = Exact::of(&scene.system);
    assert!(scene.truth.rank_free.is_none_or(|rank| rank == exact.rank), "the scene's own rank");
    for variant in variants(scene, change) {
        for options in settings(backend) {
            let analysis = diagnose(&variant.system, &options);
            let found = Exact::found(&analysis, &variant.dofs);
            let what = format!("{}, presolve {}, {:?}", variant.name, options.presolve, analysis.confidence);
            assert_eq!(found, exact, "found and exact, {what}");
            check_identities(&variant, &analysis, &options, &what);
            if let Some(u) = solution {
                check_values(&variant, &analysis, u, &what);
            }
        }
    }
}

fn check_identities(variant: &Variant, analysis: &Analysis, options: &Options, what: &str) {
    let system = &variant.system;
    check_certificates(system, analysis);
    let reduction = analysis.reduction(system);
    let residual = analysis.residual(system, &reduction);
    assert!(residual <= 1e-12, "residual {residual:e}, {what}");
    // Without presolve QR is right relative to the largest right-hand side of the block only, whatever its unit.
    if variant.exact || options.presolve {
        check_reduction(system, analysis, &reduction, 1e-12);
    }
    if !variant.exact {
        return;
    }
    assert!(reduction.growth <= options.growth, "growth {}, {what}", reduction.growth);
    analysis.dependent.iter().for_each(|dependent| check_dependent(system, analysis, dependent, what));
    for &(dof, _) in &analysis.generated {
        let because = analysis.because_fixed(system, dof).expect("factored before");
        let error = certificate_error(system, &[(dof, 1.0)], &because);
        assert!(error <= 1e-9, "DOF {dof} is fixed by {because:?} but for {error:e}, {what}");
    }
}

/// Exactly: the equations of a certificate are independent, imply the row, all are needed for that, and the row
/// conflicts iff it contradicts them.
fn check_dependent(system: &ConstraintSystem, analysis: &Analysis, dependent: &Dependent, what: &str) {
    let support: Vec<usize> = analysis.because(dependent).iter().map(|term| term.row).collect();
    let size = support.len();
    let what = format!("row {} because of {support:?}, {what}", dependent.row);
    let with_row = [&support[..], &[dependent.row]].concat();
    assert_eq!(free_rank(system, &support), size, "independent: {what}");
    assert_eq!(free_rank(system, &with_row), size, "sufficient: {what}");
    for gone in 0..size {
        let mut others = with_row.clone();
        others.remove(gone);
        assert_eq!(free_rank(system, &others), size, "row {} is needed: {what}", support[gone]);
    }
    let kind = if oracle::consistent(&part(system, &with_row)) { Kind::Redundant } else { Kind::Conflicting };
    assert_eq!(dependent.kind, kind, "mismatch {:e}: {what}", dependent.mismatch);
}

/// Generated boundary conditions have the values that they have in the solution.
fn check_values(variant: &Variant, analysis: &Analysis, solution: &[f64], what: &str) {
    let largest = solution.iter().fold(1.0, |a: f64, v| a.max(v.abs()));
    for &(dof, value) in &analysis.generated {
        let (value, known) = (value * variant.units[dof], solution[variant.dofs[dof]]);
        assert!((value - known).abs() <= 1e-9 * largest, "DOF {dof} is {value}, not {known}, {what}");
    }
}

fn is_free(system: &ConstraintSystem, dof: usize) -> bool {
    system.prescribed().binary_search_by_key(&dof, |&(j, _)| j).is_err()
}

/// Exact rank of some equations on the free DOFs.
fn free_rank(system: &ConstraintSystem, rows: &[usize]) -> usize {
    let mut free = Csr::empty(system.dofs());
    for &i in rows {
        free.push_row(system.matrix().row(i).filter(|&(j, _)| is_free(system, j)));
    }
    oracle::exact_rank(&free)
}

/// Some of the equations, with all boundary conditions.
fn part(system: &ConstraintSystem, rows: &[usize]) -> ConstraintSystem {
    let mut builder = SystemBuilder::new(system.dofs());
    for &i in rows {
        builder.equation(system.matrix().row(i), system.rhs()[i]);
    }
    system.prescribed().iter().for_each(|&(j, value)| builder.prescribe(j, value));
    builder.build().expect("as valid as the whole")
}

/// A scene of which nothing is said.
fn scene(system: ConstraintSystem) -> Scene {
    Scene { system, truth: Truth::default(), nodes: Vec::new(), dofs: Vec::new() }
}

fn planted() -> impl Strategy<Value = (Planted, u64)> {
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

/// Nodes and edges `(a, b, gap)`; a gap that is not 0 is missing from the sum of steps around the edge's cycles.
fn graphs() -> impl Strategy<Value = (usize, Vec<(usize, usize, f64)>)> {
    let gap = prop_oneof![9 => Just(0.0), 1 => (-3..=3).prop_map(f64::from)];
    (2_usize..25).prop_flat_map(move |nodes| {
        let edge = (0..nodes, 1..nodes, gap.clone()).prop_map(move |(a, step, gap)| (a, (a + step) % nodes, gap));
        (Just(nodes), vec(edge, 1..40))
    })
}

/// Whole numbers, one per DOF: a solution made up before the right-hand sides.
fn solution(dofs: usize, seed: u64) -> Vec<f64> {
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

/// Rows, DOFs, and a matrix by rows: sparse or full, of any rank (a product of two) or of full rank most often.
fn matrices() -> impl Strategy<Value = Vec<Vec<i32>>> {
    let entry = || prop_oneof![1 => Just(0), 2 => -9..=9_i32];
    let plain = (1_usize..10, 1_usize..10).prop_flat_map(move |(m, n)| vec(vec(entry(), n), m));
    let factors = (1_usize..10, 1_usize..10, 1_usize..5)
        .prop_flat_map(move |(m, n, r)| (vec(vec(-3..=3_i32, r), m), vec(vec(entry(), n), r)));
    let product = factors.prop_map(|(left, right)| left.iter().map(|row| times(row, &right)).collect());
    prop_oneof![plain, product]
}

/// `x^T A`.
fn times(x: &[i32], rows: &[Vec<i32>]) -> Vec<i32> {
    (0..rows[0].len()).map(|j| x.iter().zip(rows).map(|(x, row)| x * row[j]).sum()).collect()
}

/// `C u = C solution + off`.
fn system(rows: &[Vec<i32>], solution: &[f64], off: &[i32], prescribed: &[(usize, f64)]) -> ConstraintSystem {
    let mut builder = SystemBuilder::new(solution.len());
    for (row, &off) in rows.iter().zip(off) {
        let value: f64 = row.iter().zip(solution).map(|(&a, u)| f64::from(a) * u).sum();
        let terms = row.iter().enumerate().filter(|&(_, &a)| a != 0).map(|(j, &a)| (j, f64::from(a)));
        builder.equation(terms, value + f64::from(off));
    }
    for &(j, value) in prescribed {
        builder.prescribe(j, value);
    }
    builder.build().expect("valid")
}

fn small_dense_systems(backend: BackendChoice) {
    check_dense(backend, Units::Kept);
}

fn small_dense_systems_in_units(backend: BackendChoice) {
    check_dense(backend, Units::Mixed);
}

fn check_dense(backend: BackendChoice, units: Units) {
    let off = prop_oneof![2 => Just(vec![0; 10]), 1 => vec(-2..=2_i32, 10)];
    hold(400, &(matrices(), off, changes(units)), |(rows, off, change)| {
        let solution = solution(rows[0].len(), change.order);
        let consistent = off.iter().all(|&off| off == 0);
        let scene = scene(system(&rows, &solution, &off, &[]));
        check(backend, &scene, &change, consistent.then_some(&solution));
    });
}

/// Rare in the random tests above, so they stand here.
fn small_systems_found_wrong_once(backend: BackendChoice) {
    let found: [(&[[i32; 4]], u64); 4] = [
        // gauss: the equations that fix DOF 3 were not found, for pivots that were rounding.
        (&[[0, 26, -3, 15], [0, -26, 2, -15], [0, 0, 0, 0]], 203),
        (&[[-2, -10, 0, -1], [-1, -1, 0, 3], [3, 11, 8, -2]], 203),
        // spqr: a fixed DOF was not found, for rounding in its row of T.
        (&[[-3, 6, -3, -12], [-9, 1, -11, 4], [17, -2, 21, -12]], 263),
        (&[[11, 14, -9, -18], [2, 13, -8, -6], [-13, 6, -3, 18]], 271),
    ];
    for (rows, order) in found {
        let rows: Vec<Vec<i32>> = rows.iter().map(|row| row.to_vec()).collect();
        let change = Change { order, rows: 840, units: 0, decades: Vec::new() };
        let solution = solution(4, order);
        check(backend, &scene(system(&rows, &solution, &[0; 4], &[])), &change, Some(&solution));
    }
    // spqr: an equation that is not needed in a certificate, for rounding in its coefficient.
    let change = Change { order: 430, rows: 0, units: 0, decades: Vec::new() };
    check(backend, &families::rbe2(6, 2, 462).expect("in range"), &change, None);
}

fn prescribed_dofs(backend: BackendChoice) {
    check_prescribed(backend, Units::Kept);
}

fn prescribed_dofs_in_units(backend: BackendChoice) {
    check_prescribed(backend, Units::Mixed);
}

fn check_prescribed(backend: BackendChoice, units: Units) {
    let values = vec((any::<bool>(), prop_oneof![4 => Just(0), 1 => -2..=2_i32]), 10);
    let values = (values, any::<bool>());
    let sparse = (planted(), 0_u64..1000).prop_map(|((planted, seed), _)| whole(&planted.scene(seed).expect("valid")));
    let rows = prop_oneof![matrices(), sparse];
    hold(320, &(rows, values, changes(units)), |(rows, (values, consistent), change)| {
        let solution = solution(rows[0].len(), change.order);
        let all = values.iter().cycle().zip(&solution).enumerate().filter(|(_, ((prescribed, _), _))| *prescribed);
        let shift = |off: i32| if consistent { 0.0 } else { f64::from(off) };
        let prescribed: Vec<_> = all.map(|(j, ((_, off), u))| (j, u + shift(*off))).collect();
        let solves = prescribed.iter().all(|&(j, value)| value == solution[j]);
        let scene = scene(system(&rows, &solution, &vec![0; rows.len()], &prescribed));
        check(backend, &scene, &change, solves.then_some(&solution));
    });
}

/// The coefficients of a scene that has whole ones.
fn whole(scene: &Scene) -> Vec<Vec<i32>> {
    let mut rows = vec![vec![0; scene.system.dofs()]; scene.system.equations()];
    for (i, row) in rows.iter_mut().enumerate() {
        scene.system.matrix().row(i).for_each(|(j, v)| row[j] = v as i32);
    }
    rows
}

/// In one's own units only: others would change what is near.
fn check_doubt(backend: BackendChoice, scene: &Scene, change: &Change, ranks: [usize; 2], ambiguous: bool) {
    for variant in variants(scene, change) {
        for options in settings(backend) {
            let analysis = diagnose(&variant.system, &options);
            let what = format!("{}, presolve {}, {:?}", variant.name, options.presolve, analysis.confidence);
            let rank = analysis.rank();
            assert!((ranks[0]..=ranks[1]).contains(&rank), "rank {rank} for {ranks:?}, {what}");
            assert_eq!(analysis.confidence.ambiguous, ambiguous, "{what}");
        }
    }
}

fn triples_near_dependence(backend: BackendChoice) {
    let column = prop_oneof![Just(Near::Own), Just(Near::Shared)];
    // At 1e-5 either verdict on the doubt is fair.
    let digits = prop_oneof![Just(4), 6..=14_i32];
    hold(160, &(1_usize..5, digits, column, changes(Units::Kept)), |(triples, digits, column, change)| {
        let scene = families::near(triples, 10_f64.powi(-digits), column).expect("in range");
        let least = if digits == 4 { 3 * triples } else { 2 * triples };
        check_doubt(backend, &scene, &change, [least, 3 * triples], digits > 4);
    });
}

/// A planted combination with one coefficient off by a part in 10^6 to 10^10, which makes it independent: its distance
/// from the others is at most twice that part.
fn combinations_near_dependence(backend: BackendChoice) {
    hold(
        160,
        &(planted(), 6..=10_i32, any::<prop::sample::Index>(), changes(Units::Kept)),
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
            let rank = oracle::rank_free(&near.system);
            // Where the coefficient's DOF is fixed by the others anyway, the row is as dependent as before.
            if rank > planted.rows {
                check_doubt(backend, &near, &change, [planted.rows, rank], true);
            }
        },
    );
}

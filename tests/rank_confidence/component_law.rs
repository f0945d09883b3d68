//! `f(A + B)` is `f(A)` and `f(B)` to the last bit: kinds, ranks, doubt, slaves, T, G and g.
//!
//! If rows and DOFs are shuffled, A alone has its rows and DOFs in the shuffled order.

use std::collections::{BTreeSet, HashSet};

use qless::{
    Analysis, BackendChoice, ConstraintSystem, Kind, Options, Reduction, ReductionError, SystemBuilder, Tolerance,
    analyse,
};
use qless_scenes::families::{self, Near};
use qless_scenes::{Rng, Scene, SceneError, fssi, paper};
use rayon::prelude::*;

use super::checks::text;
use super::random;
use super::scenes::triangle;
use super::svd_reference::Case;

/// A component: its rows and DOFs by their numbers in the whole, ascending, and its own system.
struct Part {
    rows: Vec<usize>,
    dofs: Vec<usize>,
    system: ConstraintSystem,
}

impl Part {
    /// The system of some rows and DOFs of `whole`, which are not connected with others.
    fn of(whole: &ConstraintSystem, rows: Vec<usize>, dofs: Vec<usize>) -> Self {
        let own = |j: usize| dofs.binary_search(&j).expect("a DOF of the part");
        let mut builder = SystemBuilder::new(dofs.len());
        for &i in &rows {
            builder.equation(whole.matrix().row(i).map(|(j, v)| (own(j), v)), whole.rhs()[i]);
        }
        let prescribed = whole.prescribed().iter().filter(|(j, _)| dofs.binary_search(j).is_ok());
        prescribed.for_each(|&(j, value)| builder.prescribe(own(j), value));
        Self { system: builder.build().expect("valid"), rows, dofs }
    }
}

type Named = (String, Scene);

fn scene(name: &str, scene: Result<Scene, SceneError>) -> Named {
    (name.into(), scene.unwrap_or_else(|e| panic!("{name}: {e}")))
}

/// Systems with rows of equal size, in which no column is scaled.
fn even() -> Vec<Named> {
    let mesh = fssi::Mesh { columns: 7, layers: 2, far_columns: 5, far_layers: 2, rings: 2, sectors: 4, wall: 3 };
    let mut all = vec![
        scene("near(2, 1e-8, Own)", families::near(2, 1e-8, Near::Own)),
        scene("near(1, 1e-12, Shared)", families::near(1, 1e-12, Near::Shared)),
        scene("rotations(30)", families::rotations(30)),
        scene("planted(20, 30, 10, 1, true)", families::planted(20, 30, 10, 1, true)),
        scene("planted(40, 40, 10, 2, false)", families::planted(40, 40, 10, 2, false)),
        scene("recurrence(12)", families::recurrence(12)),
        scene("geometric_chain(25, 2)", families::geometric_chain(25, 2.0)),
        scene("ladder(30)", families::ladder(30)),
        scene("mortar_short(20)", families::mortar_short(20)),
        scene("rbe2(10, 2, 1)", families::rbe2(10, 2, 1)),
        scene("rve(1)", families::rve(1)),
        scene("typed_twice(8, 6, 1)", families::typed_twice(8, 6, 1)),
        scene("typed_cosines(2, 5, 1)", families::typed_cosines(2, 5, 1)),
        scene("fssi tie", fssi::tie(&mesh, 1)),
        scene("paper, figure 6", paper::figure_6(0.5)),
        scene("triangle(30, 1, wide)", Ok(triangle(30, 1.0, true))),
        scene("triangle(40, 0.5, square)", Ok(triangle(40, 0.5, false))),
    ];
    let classes = [0, 1, 3, 4, 5, 6, 7, 8].map(|class| 11 * 40 + class);
    all.extend(classes.map(|seed| bare(random::case(seed))));
    all
}

/// Systems in other units, or with tiny coefficients; their columns may be scaled.
fn uneven() -> Vec<Named> {
    [2, 10]
        .into_iter()
        .flat_map(|class| [11 * 50, 11 * 51, 11 * 52].map(|seed| bare(random::case(seed + class))))
        .collect()
}

fn bare(case: Case) -> Named {
    let truth = qless_scenes::Truth::default();
    (case.name, Scene { system: case.system, truth, nodes: Vec::new(), dofs: Vec::new() })
}

fn options(backend: BackendChoice) -> Vec<Options> {
    let default = Options { backend, ..Options::default() };
    let with = |presolve, growth, tolerance| {
        let tolerance = Tolerance::Relative(tolerance);
        Options { presolve, growth, tolerance, ..default.clone() }
    };
    let each = [true, false].into_iter().flat_map(|presolve| [1.5, 4.0, 1e6].map(|growth| (presolve, growth, 1e-10)));
    each.chain([(true, 4.0, 1e-7), (false, 4.0, 1e-13)]).map(|(p, g, t)| with(p, g, t)).collect()
}

/// An analysis and its reduction.
type Found = (Analysis, Result<Reduction, ReductionError>);

fn found(system: &ConstraintSystem, options: &Options) -> Found {
    let analysis = analyse(system, options).expect("valid");
    let reduction = analysis.reduction();
    (analysis, reduction)
}

/// Every system by itself with every set of options.
fn each_alone(list: &[Named], options: &[Options]) -> Vec<Vec<Found>> {
    let of = |(_, scene): &Named| options.iter().map(|options| found(&scene.system, options)).collect();
    list.par_iter().map(of).collect()
}

/// All pairs of two lists of systems, on one backend: with every second set of options, the others in turn, unless all are asked for.
fn pairs(firsts: &[Named], seconds: &[Named], backend: BackendChoice, step: usize) {
    let options = options(backend);
    let alone = [firsts, seconds].map(|list| each_alone(list, &options));
    let is_thorough = std::env::var_os("QLESS_THOROUGH").is_some();
    let chosen = |i: usize, j: usize| (0..options.len()).filter(move |o| is_thorough || (o + i + j).is_multiple_of(2));
    // In random order, A beside B is B beside A.
    let mut seen = HashSet::new();
    let each = (0..firsts.len()).flat_map(|i| (0..seconds.len()).map(move |j| (i, j)));
    let each: Vec<_> = each.step_by(step).zip(0..).collect();
    let is_new: Vec<bool> = each
        .iter()
        .map(|&((i, j), _)| seen.insert([&firsts[i].0, &seconds[j].0].into_iter().collect::<BTreeSet<_>>()))
        .collect();
    let of = |(&((i, j), seed), &is_new): (&((usize, usize), u64), &bool)| {
        let (a, b) = (&firsts[i], &seconds[j]);
        let scene = a.1.beside(&b.1).expect("small");
        let mut faults = beside(a, b, &scene, &options, chosen(i, j).map(|o| (o, [&alone[0][i][o], &alone[1][j][o]])));
        if is_new {
            faults.extend(shuffled(a, b, &scene, seed, chosen(i, j).map(|o| &options[o])));
        }
        faults
    };
    let faults: Vec<String> = each.par_iter().zip(&is_new).flat_map_iter(of).collect();
    assert!(faults.is_empty(), "{} faults:\n{}", faults.len(), faults.join("\n"));
}

/// In order, each component is the system that was analysed alone.
fn beside<'a>(
    a: &Named,
    b: &Named,
    scene: &Scene,
    options: &[Options],
    alone: impl Iterator<Item = (usize, [&'a Found; 2])>,
) -> Vec<String> {
    let (rows, dofs) = (a.1.system.equations(), a.1.system.dofs());
    let (all_rows, all_dofs) = (scene.system.equations(), scene.system.dofs());
    let parts = [
        Part { rows: (0..rows).collect(), dofs: (0..dofs).collect(), system: a.1.system.clone() },
        Part { rows: (rows..all_rows).collect(), dofs: (dofs..all_dofs).collect(), system: b.1.system.clone() },
    ];
    let of = |(o, alone): (usize, [&Found; 2])| {
        let fault = compare(&scene.system, &parts, alone, &options[o])?;
        Some(format!("{} beside {}, in order [{}]: {fault}", a.0, b.0, text(&options[o])))
    };
    alone.filter_map(of).collect()
}

/// Rows and DOFs of both in random order.
fn shuffled<'a>(
    a: &Named,
    b: &Named,
    scene: &Scene,
    seed: u64,
    options: impl Iterator<Item = &'a Options>,
) -> Vec<String> {
    let (rows, dofs) = (a.1.system.equations(), a.1.system.dofs());
    let (mixed, order) = scene.shuffle(seed).expect("valid");
    let half = |first: bool| {
        let of = |old: &[usize], limit| (0..old.len()).filter(|&i| (old[i] < limit) == first).collect::<Vec<_>>();
        Part::of(&mixed.system, of(&order.rows, rows), of(&order.dofs, dofs))
    };
    let parts = [half(true), half(false)];
    let of = |options: &Options| {
        let alone = parts.each_ref().map(|part| found(&part.system, options));
        let fault = compare(&mixed.system, &parts, alone.each_ref(), options)?;
        Some(format!("{} beside {}, shuffled ({seed}) [{}]: {fault}", a.0, b.0, text(options)))
    };
    options.filter_map(of).collect()
}

/// The first difference between the whole and its components.
fn compare(whole: &ConstraintSystem, parts: &[Part; 2], alone: [&Found; 2], options: &Options) -> Option<String> {
    let (all, reduced) = found(whole, options);
    let ambiguous = alone.iter().any(|(analysis, _)| analysis.confidence().ambiguous);
    for (name, part, (analysis, _)) in [("A", &parts[0], alone[0]), ("B", &parts[1], alone[1])] {
        let kinds: Vec<Kind> = part.rows.iter().map(|&i| all.kinds()[i]).collect();
        let count = |kinds: &[Kind]| kinds.iter().filter(|&&kind| kind == Kind::Independent).count();
        if count(&kinds) != analysis.rank() {
            return Some(format!("rank of {name} is {}, alone {}", count(&kinds), analysis.rank()));
        }
        if let Some(i) = (0..kinds.len()).find(|&i| kinds[i] != analysis.kinds()[i]) {
            return Some(format!("row {i} of {name} is {:?}, alone {:?}", kinds[i], analysis.kinds()[i]));
        }
    }
    if all.confidence().ambiguous != ambiguous {
        return Some(format!(
            "ambiguous {}, alone {:?}",
            all.confidence().ambiguous,
            alone.map(|(a, _)| a.confidence().ambiguous)
        ));
    }
    if let Some(fault) = compare_generated(&all, parts, alone).or_else(|| compare_dependent(&all, parts, alone)) {
        return Some(fault);
    }
    match (&reduced, &alone[0].1, &alone[1].1) {
        (Ok(reduced), Ok(a), Ok(b)) => {
            compare_reductions("A", reduced, &parts[0], a).or_else(|| compare_reductions("B", reduced, &parts[1], b))
        }
        (Err(_), a, b) if a.is_err() || b.is_err() => None,
        (whole, a, b) => Some(format!(
            "reduction {:?}, alone {:?} and {:?}",
            whole.as_ref().err(),
            a.as_ref().err(),
            b.as_ref().err()
        )),
    }
}

/// Compares dependent equations and the extremes of the estimates to the last bit.
fn compare_dependent(all: &Analysis, parts: &[Part; 2], alone: [&Found; 2]) -> Option<String> {
    let [a, b] = [&alone[0].0.confidence(), &alone[1].0.confidence()];
    let estimates = (a.distance.min(b.distance), a.error.max(b.error));
    if (all.confidence().distance, all.confidence().error) != estimates {
        return Some(format!("{:?}, alone {estimates:?}", all.confidence()));
    }
    let said = |analysis: &Analysis, place: &dyn Fn(usize) -> Option<usize>| -> Vec<_> {
        let said = |d: &qless::Dependent| {
            let because = analysis
                .because(d.row)
                .expect("one of its rows")
                .into_iter()
                .map(|term| (place(term.row), term.coefficient.to_bits()));
            let numbers = [d.mismatch, d.relative_mismatch, d.dropped].map(f64::to_bits);
            Some((place(d.row)?, numbers, because.collect::<Vec<_>>()))
        };
        analysis.dependent().iter().filter_map(said).collect()
    };
    ["A", "B"].into_iter().zip(parts.iter().zip(alone)).find_map(|(name, (part, (analysis, _)))| {
        let here = said(all, &|row| part.rows.binary_search(&row).ok());
        (here != said(analysis, &Some)).then(|| format!("what is said of dependent equations of {name} differs"))
    })
}

fn compare_generated(all: &Analysis, parts: &[Part; 2], alone: [&Found; 2]) -> Option<String> {
    let place = |part: &Part, j: usize| part.dofs.binary_search(&j).ok();
    let bits = |(j, value): (usize, f64)| (j, value.to_bits());
    ["A", "B"].into_iter().zip(parts.iter().zip(alone)).find_map(|(name, (part, (analysis, _)))| {
        let here = all.generated().iter().filter_map(|&(j, value)| Some(bits((place(part, j)?, value))));
        let there = analysis.generated().iter().copied().map(bits);
        (!here.eq(there)).then(|| format!("generated boundary conditions of {name} differ"))
    })
}

/// Compares slaves, T, G and g to the last bit.
fn compare_reductions(name: &str, all: &Reduction, part: &Part, alone: &Reduction) -> Option<String> {
    let place = |j: &usize| part.dofs.binary_search(j).ok();
    let slaves: Vec<usize> = all.slaves().iter().filter_map(place).collect();
    if slaves != alone.slaves() {
        let other = slaves.iter().filter(|j| !alone.slaves().contains(j)).count();
        return Some(format!("{other} of {} slaves of {name} are others", slaves.len()));
    }
    let rows = (0..all.slaves().len()).filter(|&i| place(&all.slaves()[i]).is_some());
    for (i, own) in rows.zip(0..) {
        let slave = alone.slaves()[own];
        let here: Vec<_> = all.t().row(i).map(|(k, v)| (place(&all.masters()[k]), v.to_bits())).collect();
        let there: Vec<_> = alone.t().row(own).map(|(k, v)| (Some(alone.masters()[k]), v.to_bits())).collect();
        if here != there {
            return Some(format!("T differs in slave {slave} of {name}, {}", largest(&here, &there)));
        }
        let here: Vec<_> = all.g_matrix().row(i).map(|(k, v)| (place(&all.prescribed()[k]), v.to_bits())).collect();
        let there: Vec<_> =
            alone.g_matrix().row(own).map(|(k, v)| (Some(alone.prescribed()[k]), v.to_bits())).collect();
        if here != there {
            return Some(format!("G differs in slave {slave} of {name}, {}", largest(&here, &there)));
        }
        if all.g()[i].to_bits() != alone.g()[own].to_bits() {
            return Some(format!("g of slave {slave} of {name} is {:e}, alone {:e}", all.g()[i], alone.g()[own]));
        }
    }
    None
}

/// A DOF of the component, and the bits of its coefficient.
type Entry = (Option<usize>, u64);

/// Text of a difference.
fn largest(here: &[Entry], there: &[Entry]) -> String {
    if here.iter().map(|e| e.0).ne(there.iter().map(|e| e.0)) {
        return format!("{} and {} coefficients", here.len(), there.len());
    }
    let off = |(a, b): (&Entry, &Entry)| (f64::from_bits(a.1) - f64::from_bits(b.1)).abs();
    format!("by {:.1e}", here.iter().zip(there).map(off).fold(0.0, f64::max))
}

#[test]
fn a_component_beside_changes_nothing() {
    pairs(&even(), &even(), BackendChoice::Faer, 1);
}

/// Scaling is chosen separately for each component.
#[test]
fn a_component_in_other_units_beside_changes_nothing() {
    pairs(&uneven(), &[even(), uneven()].concat(), BackendChoice::Faer, 1);
}

/// The same matrix with the DOFs in another order and other right-hand sides.
fn twin((name, scene): &Named, seed: u64) -> Named {
    let (system, mut rng) = (&scene.system, Rng::new(seed));
    let order = rng.permutation(system.dofs()).expect("small");
    let mut builder = SystemBuilder::new(order.len());
    for (i, &b) in system.rhs().iter().enumerate() {
        let other = if rng.below(4) == 0 { b + 1.0 } else { b };
        builder.equation(system.matrix().row(i).map(|(j, v)| (order[j], v)), other);
    }
    system.prescribed().iter().for_each(|&(j, value)| builder.prescribe(order[j], value));
    let system = builder.build().expect("valid");
    (format!("twin of {name}"), Scene { system, ..scene.clone() })
}

/// Blocks with the same matrix are factored once.
#[test]
fn a_twin_beside_changes_nothing() {
    let planted = |seed| scene("planted(60, 70, 12, false)", families::planted(60, 70, 12, seed, false));
    for (named, seed) in [even(), uneven(), (1..20).map(planted).collect()].concat().iter().zip(0..) {
        let twins = [twin(named, seed), twin(named, seed + 1_000)];
        pairs(std::slice::from_ref(named), &twins, BackendChoice::Faer, 1);
        pairs(&twins[..1], &twins[1..], BackendChoice::Faer, 1);
    }
}

/// With more than 800 rows presolve allows some fill, separately for each component.
#[test]
fn large_components_beside_change_nothing() {
    let planted = |rows, dofs, seed| {
        scene(&format!("planted({rows}, {dofs}, 40, {seed})"), families::planted(rows, dofs, 40, seed, false))
    };
    let large = [planted(1100, 1400, 1), planted(900, 1000, 2), planted(60, 90, 3)];
    pairs(&large, &large[1..], BackendChoice::Faer, 1);
}

/// A tenth of all pairs.
fn a_component_beside_changes_nothing_here(backend: BackendChoice) {
    pairs(&even(), &even(), backend, 11);
}

on_each_backend!(a_component_beside_changes_nothing_here);

/// Two thousand random systems in pairs, with and without presolve: T may be recomputed for each component alone.
#[test]
fn random_systems_beside_change_nothing() {
    let mut faults = Vec::new();
    for seed in 0..random::COUNT / 2 {
        let [(name, a), (_, b)] = [2 * seed, 2 * seed + 1].map(|seed| bare(random::case(seed)));
        let scene = a.beside(&b).expect("small");
        let (rows, dofs) = (a.system.equations(), a.system.dofs());
        let (all_rows, all_dofs) = (scene.system.equations(), scene.system.dofs());
        let parts = [
            Part::of(&scene.system, (0..rows).collect(), (0..dofs).collect()),
            Part::of(&scene.system, (rows..all_rows).collect(), (dofs..all_dofs).collect()),
        ];
        for presolve in [true, false] {
            let options = Options { presolve, growth: 1e6, ..Options::default() };
            let alone = parts.each_ref().map(|part| found(&part.system, &options));
            let fault = compare(&scene.system, &parts, alone.each_ref(), &options);
            faults.extend(fault.map(|fault| format!("{name} and the next, presolve {presolve}: {fault}")));
        }
    }
    assert!(faults.is_empty(), "{} faults:\n{}", faults.len(), faults.join("\n"));
}

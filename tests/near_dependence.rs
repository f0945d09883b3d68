//! Equations that nearly repeat others: the rank as typed and the rank as meant, against both truths.

use std::collections::BTreeMap;

use qless::{Analysis, ConstraintSystem, NearDependence, Options, SystemBuilder, Tolerance, analyse};
use qless_scenes::families::{self, Near, near, typed_cosines, typed_twice};
use qless_scenes::fssi::{self, Mesh};
use qless_scenes::{Rng, Scene, SceneError};

fn read(system: &ConstraintSystem) -> (Analysis, Option<NearDependence>) {
    let analysis = analyse(system, &Options::default()).expect("an analysis");
    let meant = analysis.near_dependence().expect("a small system");
    (analysis, meant)
}

/// The scene in its own order and in another one.
fn orders(scene: Scene, seed: u64) -> [Scene; 2] {
    let mut other = scene.clone();
    other = other.shuffle(seed).expect("as large as before").0;
    [scene, other]
}

/// `|sum_i c_i row_i - row_k|` is small, and no equation of the combination is itself a near-dependence.
fn assert_combinations(
    system: &ConstraintSystem,
    analysis: &Analysis,
    meant: &NearDependence,
    digits: usize,
    name: &str,
) {
    assert_eq!(meant.rank + meant.equations.len(), analysis.rank(), "{name}");
    assert!(meant.equations.is_sorted_by(|a, b| a.row < b.row), "{name}");
    for equation in &meant.equations {
        let mut rest = BTreeMap::new();
        let mut add = |row: usize, c: f64| {
            system.matrix().row(row).for_each(|(j, v)| *rest.entry(j).or_insert(0.0) += c * v);
        };
        add(equation.row, -1.0);
        for term in &equation.because {
            assert!(meant.equations.iter().all(|other| other.row != term.row), "{name}: {equation:?}");
            add(term.row, term.coefficient);
        }
        let largest = rest.values().fold(0.0, |a: f64, v: &f64| a.max(v.abs()));
        assert!(largest < 50.0 * 10_f64.powi(-(digits as i32)), "{name}: {largest:e} of {equation:?}");
        assert!((digits as u32 - 1..=digits as u32 + 2).contains(&equation.digits), "{name}: {equation:?}");
    }
}

/// Of two equations typed twice the later one is named, as a multiple of the earlier one.
fn check_twice(scene: &Scene, n: usize, digits: usize, name: &str) {
    let (analysis, meant) = read(&scene.system);
    assert_eq!(Some(analysis.rank()), scene.truth.rank_free, "{name}: as typed");
    let meant = meant.unwrap_or_else(|| panic!("{name}: nothing"));
    assert_eq!(meant.rank, n, "{name}: as meant");
    assert_combinations(&scene.system, &analysis, &meant, digits, name);
    let mut pairs: BTreeMap<String, Vec<usize>> = BTreeMap::new();
    for row in 0..scene.system.equations() {
        let label = scene.system.equation_label(row);
        let label = label.split(',').next().unwrap_or_default().to_owned();
        pairs.entry(label).or_default().push(row);
    }
    let twice: BTreeMap<usize, usize> = pairs.values().filter(|p| p.len() == 2).map(|p| (p[1], p[0])).collect();
    for equation in &meant.equations {
        let largest = equation.because.iter().max_by(|a, b| a.coefficient.abs().total_cmp(&b.coefficient.abs()));
        let by = largest.map(|term| term.row);
        assert_eq!(twice.get(&equation.row).copied(), by, "{name}: {equation:?}");
    }
}

#[test]
fn equations_typed_twice_are_meant_as_one() -> Result<(), SceneError> {
    for (seed, digits) in (0..6).flat_map(|seed| (3..=8).map(move |digits| (seed, digits))) {
        for n in [3, 20, 150] {
            for (k, scene) in orders(typed_twice(n, digits, seed)?, seed + 1).iter().enumerate() {
                check_twice(scene, n, digits, &format!("n {n}, {digits} digits, seed {seed}, order {k}"));
            }
        }
    }
    check_twice(&typed_twice(1500, 6, 1)?, 1500, 6, "large");
    Ok(())
}

/// One rod of each pentagon is named, as a combination of rods of the same pentagon.
#[test]
fn pentagons_with_typed_cosines_are_meant_to_turn() -> Result<(), SceneError> {
    for (seed, digits) in (0..6).flat_map(|seed| (3..=8).map(move |digits| (seed, digits))) {
        for n in [1, 9, 40] {
            for (k, scene) in orders(typed_cosines(n, digits, seed)?, seed + 1).iter().enumerate() {
                let name = format!("n {n}, {digits} digits, seed {seed}, order {k}");
                let (analysis, meant) = read(&scene.system);
                assert_eq!(analysis.rank(), 8 * n, "{name}: as typed");
                let meant = meant.unwrap_or_else(|| panic!("{name}: nothing"));
                assert_eq!(meant.rank, 7 * n, "{name}: as meant");
                assert_combinations(&scene.system, &analysis, &meant, digits, &name);
                let pentagon = |row| scene.system.equation_label(row).split(',').next().map(str::to_owned);
                let mut named: Vec<_> = meant.equations.iter().map(|e| pentagon(e.row)).collect();
                named.sort_unstable();
                named.dedup();
                assert_eq!(named.len(), n, "{name}");
            }
        }
    }
    Ok(())
}

/// Five pairs of equations in a chain, which differ by e and by 3e-3 to 2e-2: no gap between these four, but a wide one below them.
#[test]
fn the_widest_gap_tells_near_dependence() {
    for digits in 6..10 {
        let e = 10_f64.powi(-digits);
        let mut builder = SystemBuilder::new(11);
        for (pair, e) in [e, 3e-3, 5e-3, 1e-2, 2e-2].into_iter().enumerate() {
            let first = 2 * pair;
            builder.equation((first..first + 3).map(|j| (j, 1.0)), 0.0);
            builder.equation((first..first + 3).map(|j| (j, if j == first + 1 { 1.0 + e } else { 1.0 })), 0.0);
        }
        let (analysis, meant) = read(&builder.build().expect("valid"));
        let near = meant.unwrap_or_else(|| panic!("{e:e}: nothing")).equations;
        assert_eq!((analysis.rank(), near.len(), near[0].row), (10, 1, 1), "{e:e}: {near:?}");
        assert!((0.5..2.0).contains(&(near[0].distance / e)), "{e:e}: {near:?}");
    }
}

/// A multiple of an equation whose coefficients span six decades, typed with six digits: the combination has the same factor, whether
/// equations are scaled or not.
#[test]
fn combinations_are_in_the_units_of_their_equations() {
    for seed in 0..200 {
        let mut rng = Rng::new(seed);
        let mut number = || (1.0 + rng.real()) * 10_f64.powi(2 + rng.below(7) as i32);
        let (row, factor): (Vec<f64>, f64) = ((0..4).map(|_| number()).collect(), number());
        let mut builder = SystemBuilder::new(4);
        builder.equation(row.iter().copied().enumerate(), 0.0);
        builder.equation(row.iter().enumerate().map(|(j, v)| (j, factor * v * (1.0 + [1e-6, -1e-6][j % 2]))), 0.0);
        let system = builder.build().expect("valid");
        for tolerance in [Options::default().tolerance, Tolerance::Paper] {
            let analysis = analyse(&system, &Options { tolerance, ..Options::default() }).expect("small");
            let near =
                analysis.near_dependence().expect("small").unwrap_or_else(|| panic!("{seed}: nothing")).equations;
            assert_eq!((near.len(), near[0].row, near[0].because.len()), (1, 1, 1), "{seed}: {near:?}");
            let found = near[0].because[0].coefficient / factor;
            assert!((found - 1.0).abs() <= 2e-6, "{seed}, {tolerance:?}: {found}");
        }
    }
}

/// Multiples of one equation, typed with six digits: the first is kept, and each other one is a multiple of it.
#[test]
fn the_first_of_several_near_equations_is_kept() {
    for seed in 0..200 {
        let mut rng = Rng::new(seed);
        let row: Vec<f64> = (0..4).map(|_| 1.5 + 0.5 * rng.real()).collect();
        let factors: Vec<f64> = (0..2 + rng.below(3)).map(|_| 1.5 + 0.5 * rng.real()).collect();
        let mut builder = SystemBuilder::new(4);
        for factor in &factors {
            builder.equation(row.iter().map(|v| (factor * v * 1e6).round() / 1e6).enumerate(), 0.0);
        }
        let (analysis, meant) = read(&builder.build().expect("valid"));
        let meant = meant.unwrap_or_else(|| panic!("{seed}: nothing"));
        assert_eq!((meant.rank, meant.equations.len() + 1), (1, analysis.rank()), "{seed}");
        for near in &meant.equations {
            assert_eq!((near.because.len(), near.because[0].row), (1, 0), "{seed}: {near:?}");
            let found = near.because[0].coefficient * factors[0] / factors[near.row];
            assert!((found - 1.0).abs() <= 1e-5, "{seed}: {near:?}");
        }
    }
}

fn harmless() -> Result<Vec<(&'static str, Scene)>, SceneError> {
    let mesh = Mesh::with_equations(400);
    Ok(vec![
        ("path", families::path(20_000)?),
        ("cycle", families::cycle(5000, 0.0)?),
        ("grid", families::grid_2d(40, 40)?),
        ("graph", families::random_graph(800, 1500, 1)?),
        ("rotations", families::rotations(3000)?),
        ("planted", families::planted(120, 200, 60, 1, false)?),
        ("spotted band", families::spotted_band(800, 1)?),
        ("ladder", families::ladder(500)?),
        ("spider", families::spider(200)?),
        ("rigid", families::rbe2(80, 2, 1)?),
        ("cell", families::rve(4)?),
        ("tie", fssi::tie(&mesh, 1)?),
        ("mortar", fssi::mortar(&mesh, 1)?),
        ("mortar, nested", fssi::mortar(&mesh.nested(), 1)?),
    ])
}

#[test]
fn harmless_systems_have_one_reading() -> Result<(), SceneError> {
    for (name, scene) in harmless()? {
        assert_eq!(read(&scene.system).1, None, "{name}");
    }
    Ok(())
}

/// Other components do not change a bit of the results of a component.
#[test]
fn what_stands_beside_changes_nothing() -> Result<(), SceneError> {
    let mut rng = Rng::new(3);
    let near = [typed_twice(12, 6, 2)?, typed_cosines(4, 5, 3)?, near(3, 1e-7, Near::Own)?];
    for (name, other) in harmless()? {
        let scene = &near[rng.below(near.len())];
        let alone = read(&scene.system).1.expect("a second reading");
        let first = read(&scene.beside(&other)?.system);
        let together = first.1.unwrap_or_else(|| panic!("{name}: nothing"));
        assert_eq!(together.equations, alone.equations, "{name}");
        assert_eq!(together.rank + alone.equations.len(), first.0.rank(), "{name}");
        let second = read(&other.beside(scene)?.system).1.unwrap_or_else(|| panic!("{name}: nothing"));
        let mut moved = alone.equations;
        for equation in &mut moved {
            equation.row += other.system.equations();
            equation.because.iter_mut().for_each(|term| term.row += other.system.equations());
        }
        assert_eq!(second.equations, moved, "{name}");
    }
    Ok(())
}

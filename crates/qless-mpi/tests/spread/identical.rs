//! Verdicts, certificates, T, G and g are those of the serial library to the last bit, whoever holds the equations.

use crate::common::{Partition, difference, serial, spread};
use qless::{ConstraintSystem, Options};
use qless_scenes::{Rng, Scene, SceneError, families, fssi};

const SIZES: [usize; 6] = [1, 2, 3, 4, 7, 8];

fn compare(name: &str, system: &ConstraintSystem, sizes: &[usize], partitions: &[Partition]) -> Vec<String> {
    let options = Options::default();
    let expected = serial(system, &options);
    let mut faults = Vec::new();
    for &size in sizes {
        for &partition in partitions {
            let found = spread(system, &options, size, partition);
            let difference = difference(&found, &expected);
            if !difference.is_empty() {
                faults.push(format!("{name}, {size} ranks, {partition:?}: {difference}"));
            }
        }
    }
    faults
}

/// A small system of one of the families.
fn random(seed: u64) -> Result<Scene, SceneError> {
    let mut rng = Rng::new(seed);
    let s = rng.bits();
    let mesh = fssi::Mesh::with_equations(400 + rng.below(2000));
    let scene = match seed % 14 {
        0 => families::planted(20 + rng.below(60), 90 + rng.below(80), rng.below(12), s, false),
        1 => families::planted(20 + rng.below(60), 90 + rng.below(80), 1 + rng.below(12), s, true),
        2 => families::random_graph(10 + rng.below(60), 20 + rng.below(80), s),
        3 => families::rve(1 + rng.below(3)),
        4 => families::rbe2(3 + rng.below(20), 1 + rng.below(2), s),
        5 | 6 => fssi::tie(&mesh, s),
        7 => fssi::mortar(&mesh, s),
        8 => families::gradient([2 + rng.below(2), 2, 3], 3, s),
        9 => families::spotted_band(20 + rng.below(200), s),
        10 => families::typed_twice(5 + rng.below(20), 5, s),
        11 => families::geometric_chain(5 + rng.below(60), 0.5 + rng.real()),
        12 => families::grid_2d(2 + rng.below(9), 2 + rng.below(9)),
        _ => families::mortar_short(4 + rng.below(20)),
    }?;
    let scene = if rng.below(3) == 0 {
        let n = scene.system.dofs();
        let values: Vec<(usize, f64)> = rng.distinct((n / 10).min(5), n)?.into_iter().map(|j| (j, 0.125)).collect();
        let free: Vec<_> =
            values.into_iter().filter(|v| scene.system.prescribed().iter().all(|p| p.0 != v.0)).collect();
        scene.with_prescribed(&free)?
    } else {
        scene
    };
    let scene = if rng.below(3) == 0 { scene.with_singletons(30, 3, s)? } else { scene };
    Ok(if rng.below(2) == 0 { scene.shuffle(s)?.0 } else { scene })
}

#[test]
fn five_hundred_random_partitions_of_random_systems() {
    let mut faults = Vec::new();
    for seed in 0..500 {
        let scene = random(seed).expect("a scene");
        let size = SIZES[(seed / 14 % 6) as usize];
        let partition = if seed % 5 == 0 { Partition::Blocks } else { Partition::Scattered(seed) };
        faults.extend(compare(&format!("seed {seed}"), &scene.system, &[size], &[partition]));
    }
    let count = faults.len();
    assert!(faults.is_empty(), "{count}: {:#.2000}", faults.join("\n"));
}

#[test]
fn the_corpus_on_every_number_of_ranks() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/corpus/cases");
    let mut faults = Vec::new();
    let mut count = 0;
    for case in std::fs::read_dir(folder).expect("the corpus").map(|case| case.expect("a case").path()) {
        let system = qless_io::read_case(&case, None, None).expect("a case");
        faults.extend(compare(
            &case.display().to_string(),
            &system,
            &SIZES,
            &[Partition::Blocks, Partition::Scattered(7)],
        ));
        count += 1;
    }
    assert!(count > 20, "{count} cases");
    assert!(faults.is_empty(), "{} of {count}: {:.3000}", faults.len(), faults.join("\n"));
}

//! `K_q` and `f_q` against dense products, for every storage, index base, and treatment of prescribed DOFs.

use qless::elimination::{CondensedPattern, EliminationError, PrescribedDofs, Storage, View};
use qless::{ArgumentError, Elimination, Form, Options, SystemBuilder, SystemError};
use qless_scenes::Rng;

use super::dense::{Dense, close, condensed, map_of, parts, random_system};
use super::matrix::{Held, held, random};

const STORAGES: [Storage; 3] = [Storage::Full, Storage::Lower, Storage::Upper];

fn view(held: &Held, by_columns: bool, storage: Storage, base: usize) -> View<'_, i64, i32> {
    let view =
        if by_columns { View::columns(&held.starts, &held.index) } else { View::rows(&held.starts, &held.index) };
    let view = view.storing(storage);
    if base == 1 { view.one_based() } else { view }
}

/// K_q as numbers in place.
fn spread(condensed: &CondensedPattern, values: &[f64], by_columns: bool) -> Dense {
    let q = condensed.unknowns();
    let mut dense = vec![vec![0.0; q]; q];
    for line in 0..q {
        let range = condensed.starts()[line] as usize..condensed.starts()[line + 1] as usize;
        assert!(condensed.index()[range.clone()].is_sorted_by(|a, b| a < b), "indices ascend");
        for k in range {
            let other = condensed.index()[k] as usize;
            let (i, j) = if by_columns { (other, line) } else { (line, other) };
            dense[i][j] = values[k];
        }
    }
    for ((i, j), value) in condensed.entries().zip(values) {
        assert!(dense[i][j].to_bits() == value.to_bits(), "({i}, {j}) as a triplet");
    }
    assert_eq!(condensed.entries().len(), condensed.nnz());
    dense
}

fn check(found: &Dense, expected: &Dense, storage: Storage) {
    for (i, row) in expected.iter().enumerate() {
        for (j, &value) in row.iter().enumerate() {
            let stored = match storage {
                Storage::Full => true,
                Storage::Lower => j <= i,
                Storage::Upper => j >= i,
            };
            assert!(close(found[i][j], if stored { value } else { 0.0 }), "({i}, {j}): {} for {value}", found[i][j]);
        }
    }
}

#[test]
fn condensing_is_the_dense_product() {
    let mut seen = 0;
    for seed in 0..1500 {
        let mut rng = Rng::new(seed);
        let system = random_system(&mut rng);
        let Some(map) = map_of(&system, Form::Explicit) else { continue };
        seen += usize::from(!map.slaves().is_empty());
        let (storage, by_columns, base) = (STORAGES[rng.below(3)], rng.below(2) == 1, rng.below(2));
        let given = [PrescribedDofs::Eliminated, PrescribedDofs::Kept][rng.below(2)];
        let k = random(system.dofs(), storage != Storage::Full, &mut rng);
        let arrays = held(&k, by_columns, storage, base, &mut rng);
        let f: Vec<f64> = (0..system.dofs()).map(|_| rng.real()).collect();
        let pattern = map.condensed(view(&arrays, by_columns, storage, base), given).expect("a pattern");
        let (mut k_q, mut f_q) = (vec![f64::NAN; pattern.nnz()], vec![f64::NAN; pattern.unknowns()]);
        pattern.condense_into(&map, &arrays.values, &f, &mut k_q, &mut f_q).expect("finite");
        let (matrix, load) = condensed(&k, &f, &parts(&map, given));
        check(&spread(&pattern, &k_q, by_columns), &matrix, storage);
        f_q.iter().zip(&load).for_each(|(a, b)| assert!(close(*a, *b), "seed {seed}: {a} for {b}"));
    }
    assert!(seen > 1000, "{seen} systems had slaves");
}

/// Elements with random DOFs: assembling K and condensing it equals condensing element by element.
#[test]
fn elements_condensed_one_by_one_make_the_same_matrix() {
    for seed in 0..600 {
        let mut rng = Rng::new(seed);
        let system = random_system(&mut rng);
        let Some(map) = map_of(&system, Form::Explicit) else { continue };
        let (n, storage) = (system.dofs(), STORAGES[rng.below(3)]);
        let given = [PrescribedDofs::Eliminated, PrescribedDofs::Kept][rng.below(2)];
        let elements: Vec<Vec<usize>> =
            (0..=rng.below(8)).map(|_| (0..n).filter(|_| rng.below(3) == 0).collect()).collect();
        let mut k = vec![vec![0.0; n]; n];
        let mut f = vec![0.0; n];
        let mut matrices = Vec::new();
        for dofs in &elements {
            let own = random(dofs.len(), storage != Storage::Full, &mut rng);
            let forces: Vec<f64> = dofs.iter().map(|_| rng.real()).collect();
            for (a, &i) in dofs.iter().enumerate() {
                f[i] += forces[a];
                dofs.iter().enumerate().for_each(|(b, &j)| k[i][j] += own[a][b]);
            }
            matrices.push((own.concat(), forces));
        }
        let dofs = |e: usize| elements[e].as_slice();
        let pattern = map.condensed_for_elements(elements.len(), dofs, storage, given).expect("a pattern");
        let (mut k_q, mut f_q) = (vec![7.0; pattern.nnz()], vec![7.0; pattern.unknowns()]);
        let write = |e: usize, matrix: &mut [f64], forces: &mut [f64]| {
            matrix.copy_from_slice(&matrices[e].0);
            forces.copy_from_slice(&matrices[e].1);
        };
        pattern.assemble(&map, elements.len(), dofs, &mut k_q, &mut f_q, write).expect("finite");
        let (matrix, load) = condensed(&k, &f, &parts(&map, given));
        check(&spread(&pattern, &k_q, false), &matrix, storage);
        f_q.iter().zip(&load).for_each(|(a, b)| assert!(close(*a, *b), "seed {seed}: {a} for {b}"));
        let (mut again, mut load) = (vec![0.0; pattern.nnz()], vec![0.0; pattern.unknowns()]);
        for (e, (matrix, forces)) in matrices.iter().enumerate() {
            pattern.add_element(&map, dofs(e), (matrix, forces), &mut again, &mut load).expect("in the pattern");
        }
        assert!((again, load) == (k_q, f_q), "the same sums in the same order");
    }
}

/// A plate of squares, large enough for threads, with a tie across its middle and a fixed edge.
fn plate(side: usize) -> (Elimination, Vec<[usize; 4]>) {
    let node = |x: usize, y: usize| y * (side + 1) + x;
    let mut builder = SystemBuilder::new((side + 1) * (side + 1));
    for y in 0..=side {
        builder.prescribe(node(0, y), 0.1);
        if y > 0 && y < side {
            let terms = [(node(side, y), 1.0), (node(1, y), -0.5), (node(1, y + 1), -0.25), (node(1, y - 1), -0.25)];
            builder.equation(terms, 0.01);
            builder.equation(terms.map(|(j, v)| (j, 3.0 * v)), 0.03);
        }
    }
    let squares = (0..side * side).map(|e| (e % side, e / side));
    let elements = squares.map(|(x, y)| [node(x, y), node(x + 1, y), node(x + 1, y + 1), node(x, y + 1)]).collect();
    (Elimination::new(&builder.build().expect("a plate"), &Options::default()).expect("no conflict"), elements)
}

#[test]
fn bits_do_not_depend_on_threads() {
    let (map, elements) = plate(150);
    let write = |e: usize, matrix: &mut [f64], forces: &mut [f64]| {
        matrix.iter_mut().enumerate().for_each(|(k, v)| *v = 1.0 / (1 + e % 7 + k) as f64);
        forces.iter_mut().enumerate().for_each(|(k, v)| *v = 0.1 * (e % 3 + k) as f64);
    };
    let dofs = |e: usize| elements[e];
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| {
            let pattern = map
                .condensed_for_elements(elements.len(), dofs, Storage::Full, PrescribedDofs::Eliminated)
                .expect("ok");
            let (mut k_q, mut f_q) = (vec![0.0; pattern.nnz()], vec![0.0; pattern.unknowns()]);
            pattern.assemble(&map, elements.len(), dofs, &mut k_q, &mut f_q, write).expect("finite");
            let q: Vec<f64> = (0..map.masters().len()).map(|k| (k as f64).sin()).collect();
            let (mut u, mut back) = (vec![0.0; map.dofs()], vec![0.0; q.len()]);
            map.expand_into(&q, &mut u).expect("finite");
            map.restrict_into(&u, &mut back).expect("finite");
            let starts: Vec<usize> = (0..=map.dofs()).map(|i| 3 * i).collect();
            let index: Vec<usize> =
                (0..map.dofs()).flat_map(|i| [i, (i + 1) % map.dofs(), (i * 7) % map.dofs()]).collect();
            let values: Vec<f64> = (0..index.len()).map(|k| 1.0 / (k + 1) as f64).collect();
            let other = map.condensed(View::rows(&starts, &index), PrescribedDofs::Kept).expect("a pattern");
            let mut k_other = vec![0.0; other.nnz()];
            other.condense_matrix_into(&map, &values, &mut k_other).expect("finite");
            (k_q, f_q, u, back, k_other)
        })
    };
    let one = run(1);
    [2, 3, 8].into_iter().for_each(|threads| assert!(run(threads) == one, "{threads} threads"));
}

/// DOFs without entries in K: omitted at its end, or as empty lines.
#[test]
fn lines_behind_the_arrays_are_empty() {
    for seed in 0..300 {
        let mut rng = Rng::new(seed);
        let system = random_system(&mut rng);
        let Some(map) = map_of(&system, Form::Explicit) else { continue };
        let (n, by_columns, base) = (system.dofs(), rng.below(2) == 1, rng.below(2));
        let (storage, known) = (STORAGES[rng.below(3)], rng.below(n + 1));
        let mut k = random(n, storage != Storage::Full, &mut rng);
        (0..n).for_each(|i| (0..n).filter(|&j| i.max(j) >= known).for_each(|j| k[i][j] = 0.0));
        let arrays = held(&k, by_columns, storage, base, &mut rng);
        let whole = map.condensed(view(&arrays, by_columns, storage, base), PrescribedDofs::Kept).expect("a pattern");
        let short = Held { starts: arrays.starts[..=known].to_vec(), ..arrays };
        let view = view(&short, by_columns, storage, base);
        let part = map.condensed(view.then_empty(n - known), PrescribedDofs::Kept).expect("a pattern");
        let values = |condensed: &CondensedPattern| {
            let mut k_q = vec![f64::NAN; condensed.nnz()];
            condensed.condense_matrix_into(&map, &short.values, &mut k_q).expect("finite");
            (condensed.starts().to_vec(), condensed.index().to_vec(), k_q)
        };
        assert!(values(&whole) == values(&part), "seed {seed}");
        assert!(matches!(
            map.condensed(view.then_empty(n + 1), PrescribedDofs::Kept),
            Err(EliminationError::Matrix(_))
        ));
    }
}

#[test]
fn arrays_that_are_no_pattern_are_refused() {
    let (map, _) = plate(2);
    let n = map.dofs();
    let starts: Vec<u32> = (0..=n as u32).collect();
    let index: Vec<u32> = (0..n as u32).collect();
    let refused = |view: View<u32, u32>| match map.condensed(view, PrescribedDofs::Eliminated) {
        Err(EliminationError::Matrix(error)) => error,
        other => panic!("{other:?}"),
    };
    assert!(matches!(refused(View::rows(&starts[1..], &index)), SystemError::WrongLength { .. }));
    assert!(matches!(refused(View::rows(&[], &index)), SystemError::WrongLength { .. }));
    assert!(matches!(refused(View::rows(&starts, &index[1..])), SystemError::BadStarts { .. }));
    assert!(matches!(refused(View::rows(&starts, &index).one_based()), SystemError::BadStarts { .. }));
    let mut far = index.clone();
    far[0] = n as u32;
    assert_eq!(refused(View::rows(&starts, &far)), SystemError::BadIndex { place: 0, dofs: n });
    far[0] = 1;
    let half = refused(View::rows(&starts, &far).storing(Storage::Lower));
    assert_eq!(half, SystemError::WrongHalf { place: 0, row: 0, column: 1 });
    let negative: Vec<i32> = index.iter().map(|&j| j as i32 - 1).collect();
    let bad = map.condensed(View::rows(&starts, &negative), PrescribedDofs::Kept).expect_err("an index below 0");
    assert_eq!(bad, EliminationError::Matrix(SystemError::BadIndex { place: 0, dofs: n }));
}

#[test]
fn numbers_that_do_not_fit_are_refused() {
    let (map, elements) = plate(3);
    let (other, _) = plate(3);
    let n = map.dofs();
    let (starts, index): (Vec<usize>, Vec<u32>) = ((0..=n).collect(), (0..n as u32).collect());
    let pattern = map.condensed(View::rows(&starts, &index), PrescribedDofs::Eliminated).expect("a diagonal");
    let (mut k_q, mut f_q) = (vec![0.0; pattern.nnz()], vec![0.0; pattern.unknowns()]);
    let (ones, mut bad) = (vec![1.0; n], vec![1.0; n]);
    let foreign = pattern.condense_into(&other, &ones, &ones, &mut k_q, &mut f_q);
    assert_eq!(foreign, Err(ArgumentError::Foreign { what: "the pattern" }));
    for place in 0..n {
        bad[place] = f64::NAN;
        let found = pattern.condense_into(&map, &ones, &bad, &mut k_q, &mut f_q).expect_err("a NaN");
        assert!(matches!(found, ArgumentError::NotFinite { .. }), "{found}");
        // Entries between two prescribed DOFs are not compared.
        let is_unused = map.prescribed().contains(&place);
        let found = pattern.condense_into(&map, &bad, &ones, &mut k_q, &mut f_q);
        assert!(is_unused || matches!(found, Err(ArgumentError::NotFinite { .. })), "{found:?}");
        bad[place] = 1.0;
    }
    let huge = vec![f64::MAX; n];
    let found = pattern.condense_into(&map, &huge, &ones, &mut k_q, &mut f_q);
    assert!(matches!(found, Err(ArgumentError::Overflow { .. })), "{found:?}");
    for (k, f, out, load) in [(n - 1, n, 0, 0), (n, n + 1, 0, 0), (n, n, 1, 0), (n, n, 0, 1)] {
        let (mut k_q, mut f_q) = (vec![0.0; pattern.nnz() + out], vec![0.0; pattern.unknowns() + load]);
        let found = pattern.condense_into(&map, &vec![1.0; k], &vec![1.0; f], &mut k_q, &mut f_q);
        assert!(matches!(found, Err(ArgumentError::WrongLength { .. })), "{found:?}");
    }
    let equation = |terms: [(usize, f64); 1], b: f64| pattern.equation(&map, terms, b).expect_err("refused");
    assert!(matches!(equation([(n, 1.0)], 0.0), ArgumentError::OutOfRange { .. }));
    assert!(matches!(equation([(0, f64::NAN)], 0.0), ArgumentError::NotFinite { .. }));
    assert!(matches!(equation([(0, 1.0)], f64::INFINITY), ArgumentError::NotFinite { .. }));
    assert!(matches!(pattern.equation(&other, [(0, 1.0)], 0.0), Err(ArgumentError::Foreign { .. })));
    k_q.fill(0.0);
    let mut add = |dofs: &[usize], matrix: &[f64], forces: &[f64]| {
        pattern.add_element(&map, dofs, (matrix, forces), &mut k_q, &mut f_q)
    };
    assert!(matches!(add(&[n], &[1.0], &[1.0]), Err(ArgumentError::OutOfRange { .. })));
    assert!(matches!(add(&[5], &[1.0, 2.0], &[1.0]), Err(ArgumentError::WrongLength { .. })));
    assert!(matches!(add(&[5], &[f64::INFINITY], &[1.0]), Err(ArgumentError::NotFinite { .. })));
    let absent = add(&elements[4], &[1.0; 16], &[0.0; 4]);
    assert!(matches!(absent, Err(ArgumentError::NotInPattern { dof }) if elements[4].contains(&dof)), "{absent:?}");
}

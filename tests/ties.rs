//! Mortar ties `D u - M v = 0` of well-shaped meshes have full rank without doubt, and `|C_i u| <= 1e-10` of the terms.
//!
//! D is symmetric, positive definite and well-conditioned at every size, so the DOFs of the slave side are slaves with a small T. An
//! algorithm that chooses slaves row by row loses all digits here, the more the finer the mesh.

#[macro_use]
mod support;

use qless::{Analysis, BackendChoice, ConstraintSystem, Options, Reduction};
use qless_scenes::families::{Degree, Mortar, Side, mortar_short};
use qless_scenes::{Rng, Scene, SceneError};
use support::{check_reduction, diagnose, settings};

/// Of the sum of a row's parts.
const PRECISION: f64 = 1e-10;
const DEGREES: [Degree; 2] = [Degree::Linear, Degree::Quadratic];
/// Slave and master elements along a line, ratios 0.1, 0.3, 1, 3 and 10.
const LINE: [[usize; 2]; 5] = [[100, 10], [100, 30], [60, 60], [40, 120], [20, 200]];
/// The same along each side of a rectangle.
const FACE: [[usize; 2]; 5] = [[10, 1], [10, 3], [6, 6], [5, 15], [3, 30]];

on_each_backend!(
    short_elements,
    short_elements_in_random_order,
    lines,
    lines_in_skew_axes,
    faces,
    faces_in_skew_axes,
    a_larger_face
);

/// Sizes at which an elimination along the line has lost no digit (10), 8 (100), and all (400 and more).
fn short_elements(backend: BackendChoice) {
    let cases = [10, 100, 400, 800, 2000].map(|n| (format!("{n} elements"), mortar_short(n)));
    check(backend, cases);
}

/// The order of equations and DOFs is no excuse.
fn short_elements_in_random_order(backend: BackendChoice) {
    let shuffled = |n: usize, seed: u64| mortar_short(n).and_then(|scene| Ok(scene.shuffle(seed)?.0));
    let cases = [100, 400].into_iter().flat_map(|n| (1..=3).map(move |seed| (n, seed)));
    check(backend, cases.map(|(n, seed)| (format!("{n} elements, seed {seed}"), shuffled(n, seed))));
}

#[test]
fn long_lines_with_a_short_element_faer() {
    long_lines(BackendChoice::Faer);
}

#[test]
fn long_lines_with_a_short_element_sparse() {
    long_lines(BackendChoice::Sparse);
}

#[cfg(feature = "spqr")]
#[test]
fn long_lines_with_a_short_element_spqr() {
    long_lines(BackendChoice::Spqr);
}

#[test]
fn long_lines_with_a_short_element_gauss() {
    long_lines(BackendChoice::Gauss);
}

fn long_lines(backend: BackendChoice) {
    let options = Options { backend, ..Options::default() };
    let fault = |n: usize| fault(&format!("{n} elements"), &mortar_short(n).expect("in range"), &options);
    // What one length shows of a backend, the other does too: both with the default, or if all are asked for.
    let is_all = backend == BackendChoice::Faer || std::env::var_os("QLESS_THOROUGH").is_some();
    let lengths: &[usize] = if is_all { &[20_000, 100_000] } else { &[20_000] };
    let faults: Vec<String> = lengths.iter().copied().filter_map(fault).collect();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

fn lines(backend: BackendChoice) {
    let cases = [false, true].map(|jitter| each(LINE, |degrees, elements| line(degrees, elements, jitter)?.scene(1)));
    check(backend, cases.into_iter().flatten());
}

fn lines_in_skew_axes(backend: BackendChoice) {
    let skew = |degrees, elements| Mortar { components: 2, skew: true, ..line(degrees, elements, true)? }.scene(1);
    check(backend, each(LINE, skew));
}

fn faces(backend: BackendChoice) {
    let cases = [false, true].map(|jitter| each(FACE, |degrees, elements| face(degrees, elements, jitter)?.scene(1)));
    check(backend, cases.into_iter().flatten());
}

fn faces_in_skew_axes(backend: BackendChoice) {
    let ratios = [[10, 1], [10, 3], [5, 5], [4, 12]];
    let skew = |degrees, elements| Mortar { components: 3, skew: true, ..face(degrees, elements, true)? }.scene(1);
    check(backend, each(ratios, skew));
}

/// 625 equations, of nodes that are not those of the other side.
fn a_larger_face(backend: BackendChoice) {
    check(backend, [("25 to 17".to_owned(), face([Degree::Linear; 2], [24, 17], true).and_then(|face| face.scene(1)))]);
}

/// A scene and its name.
type Named = (String, Result<Scene, SceneError>);

/// For every pair of degrees and numbers of elements.
fn each<const N: usize>(
    elements: [[usize; 2]; N],
    scene: impl Fn([Degree; 2], [usize; 2]) -> Result<Scene, SceneError>,
) -> Vec<Named> {
    let degrees = DEGREES.into_iter().flat_map(|slave| DEGREES.map(|master| [slave, master]));
    let cases = degrees.flat_map(|degrees| elements.map(|elements| (degrees, elements)));
    cases.map(|(degrees, elements)| (format!("{degrees:?} {elements:?}"), scene(degrees, elements))).collect()
}

/// Slave and master side; seeds differ, so that jittered sides do not share their nodes.
fn sides(degrees: [Degree; 2], elements: [usize; 2], seed: Option<u64>) -> Result<[Side; 2], SceneError> {
    let side = |k: usize| match seed {
        Some(seed) => Side::jittered(elements[k], degrees[k], 2 * seed + k as u64),
        None => Side::uniform(elements[k], degrees[k]),
    };
    Ok([side(0)?, side(1)?])
}

fn line(degrees: [Degree; 2], elements: [usize; 2], jitter: bool) -> Result<Mortar, SceneError> {
    let [slave, master] = sides(degrees, elements, jitter.then_some(1))?;
    Ok(Mortar::line(slave, master))
}

/// As many elements along y as along x, but placed otherwise where they are jittered.
fn face(degrees: [Degree; 2], elements: [usize; 2], jitter: bool) -> Result<Mortar, SceneError> {
    Ok(Mortar { across: Some(sides(degrees, elements, jitter.then_some(2))?), ..line(degrees, elements, jitter)? })
}

/// No fault with presolve nor without.
fn check(backend: BackendChoice, cases: impl IntoIterator<Item = Named>) {
    let mut faults = Vec::new();
    for (name, scene) in cases {
        let scene = scene.unwrap_or_else(|e| panic!("{name}: {e}"));
        faults.extend(settings(backend).iter().filter_map(|options| fault(&name, &scene, options)));
    }
    assert!(faults.is_empty(), "{} faults:\n{}", faults.len(), faults.join("\n"));
}

/// The first error as text.
fn fault(name: &str, scene: &Scene, options: &Options) -> Option<String> {
    let (system, start) = (&scene.system, std::time::Instant::now());
    let analysis = diagnose(system, options);
    let reduction = analysis.reduction().expect("within the gate");
    let rank = analysis.rank();
    let reported = analysis.residual(&reduction).expect("its own DOFs");
    let found = residual(system, &reduction);
    let growth = growth(&reduction).max(reduction.growth());
    let text = format!(
        "{:?}, presolve {}, {name}: rank {rank} of {}, {}, residual {found:.1e} (reported {reported:.1e}), growth {growth:.3}",
        options.backend,
        options.presolve,
        system.equations(),
        confidence(&analysis),
    );
    println!("{text}, {} exchanges, {:.2} s", reduction.exchanges(), start.elapsed().as_secs_f64());
    let sound = Some(rank) == scene.truth.rank_free && !analysis.confidence().ambiguous;
    // A number that is none is no sound one: the comparisons are false for it.
    let met = found <= PRECISION && reported <= PRECISION && growth <= options.growth * (1.0 + 1e-9);
    if sound && met {
        check_reduction(system, &analysis, &reduction, PRECISION);
        return None;
    }
    Some(text)
}

fn confidence(analysis: &Analysis) -> String {
    let doubt = if analysis.confidence().ambiguous { "ambiguous" } else { "sure" };
    format!("{doubt} at distance {:.1e}", analysis.confidence().distance)
}

/// `max_i |C_i u - b_i| / (sum_j |C_ij u_j| + |b_i|)` for random masters: every row in its own measure, from the user's
/// numbers and u alone.
fn residual(system: &ConstraintSystem, reduction: &Reduction) -> f64 {
    let mut rng = Rng::new(11);
    let masters: Vec<f64> = reduction.masters().iter().map(|_| rng.real()).collect();
    let u = reduction.expand(&masters, &[]).expect("of its lengths");
    let of = |i: usize| {
        let (row, b) = (system.matrix().row(i), system.rhs()[i]);
        let size = row.clone().map(|(j, v)| (v * u[j]).abs()).sum::<f64>() + b.abs();
        let sum: f64 = row.map(|(j, v)| v * u[j]).sum();
        if sum == b { 0.0 } else { (sum - b).abs() / size }
    };
    (0..system.equations()).map(of).fold(0.0, |worst: f64, r| if worst.is_nan() || r <= worst { worst } else { r })
}

/// `max |T_ij|` of columns of T, as the movement of all slaves with one master: all of a few, some of many.
fn growth(reduction: &Reduction) -> f64 {
    let masters = reduction.masters().len();
    let mut unit = vec![0.0; masters];
    let mut largest = 0.0_f64;
    for k in (0..masters).step_by(masters.div_ceil(40).max(1)) {
        unit[k] = 1.0;
        let u = reduction.expand(&unit, &[]).expect("of its lengths");
        largest = reduction.slaves().iter().fold(largest, |a, &j| a.max(u[j].abs()));
        unit[k] = 0.0;
    }
    largest
}

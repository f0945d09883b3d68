//! The operations of a finite-element code in every step, on one thread unless stated otherwise: `cargo bench --bench elimination`.
//!
//! A cube of hexahedra (three DOFs a node) with a face tied to another twice, a mean and a face that is prescribed; T is sparse. And the
//! mortar twin, of which T is dense. Ratios of medians of both sides taken in turns in one process; `--test` takes a small cube.
//!
//! | line | against | at most |
//! | --- | --- | --- |
//! | expand, increment, project | reading T and one vector over all DOFs | 2 |
//! | elements | the same elements without constraints, into the same kind of storage | 1.15 |
//! | condense | reading K once and writing as much | |

mod timing;

use std::hint::black_box;

use qless::elimination::{CondensedPattern, PrescribedDofs, Storage, View};
use qless::{Elimination, Options, SystemBuilder};
use qless_scenes::fssi::{self, Level};

use timing::{median, seconds};

/// Nodes of a hexahedron.
const NODES: usize = 8;

struct Cube {
    side: usize,
    map: Elimination,
    free: Elimination,
}

impl Cube {
    fn node(side: usize, [x, y, z]: [usize; 3]) -> usize {
        (z * (side + 1) + y) * (side + 1) + x
    }

    fn new(side: usize) -> Self {
        let dofs = 3 * (side + 1).pow(3);
        let mut builder = SystemBuilder::new(dofs);
        for y in 0..side {
            for z in 0..side {
                // A node of one face lies between four of the other, as on non-matching meshes.
                for d in 0..3 {
                    let dof = |at| 3 * Self::node(side, at) + d;
                    let other = [[side, y, z], [side, y + 1, z], [side, y, z + 1], [side, y + 1, z + 1]];
                    let terms = other.map(|at| (dof(at), -0.25)).into_iter().chain([(dof([0, y, z]), 1.0)]);
                    builder.equation(terms.clone(), 0.0);
                    builder.equation(terms.map(|(j, v)| (j, 2.0 * v)), 0.0);
                }
            }
        }
        (0..=side).for_each(|x| builder.prescribe(3 * Self::node(side, [x, side, side]), 0.1));
        let map = Elimination::new(&builder.build().expect("a system"), &Options::default()).expect("no conflict");
        let free = SystemBuilder::new(dofs).build().expect("no equations");
        Self { side, map, free: Elimination::new(&free, &Options::default()).expect("nothing to do") }
    }

    fn elements(&self) -> usize {
        self.side.pow(3)
    }

    fn dofs(&self, e: usize) -> [usize; 3 * NODES] {
        let s = self.side;
        let at = [e % s, e / s % s, e / s / s];
        std::array::from_fn(|k| {
            let corner = k / 3;
            let node = Self::node(s, [at[0] + (corner & 1), at[1] + (corner >> 1 & 1), at[2] + (corner >> 2)]);
            3 * node + k % 3
        })
    }
}

/// The matrix of an element, as cheap as reading it.
fn element(matrix: &mut [f64], forces: &mut [f64]) {
    matrix.iter_mut().enumerate().for_each(|(k, v)| *v = if k % 25 == 0 { 8.0 } else { -0.3 });
    forces.fill(1.0);
}

fn on_threads<T: Send>(threads: usize, job: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads").install(job)
}

/// Medians of both, taken in turns.
fn both(mut first: impl FnMut(), mut second: impl FnMut()) -> (f64, f64) {
    let rounds = ((1.0 / (seconds(&mut first) + seconds(&mut second)).max(1e-6)) as usize).clamp(5, 101);
    let pairs: Vec<_> = (0..rounds).map(|_| (seconds(&mut first), seconds(&mut second))).collect();
    let (a, b): (Vec<_>, Vec<_>) = pairs.into_iter().unzip();
    (median(a), median(b))
}

fn line(name: &str, of: &str, (a, b): (f64, f64)) {
    println!("  {name:<12} {:>9.3} ms, {of} {:>9.3} ms: {:.2}", a * 1e3, b * 1e3, a / b);
}

/// Expand, increment and project against reading T and a vector.
fn vectors(map: &Elimination) {
    let (n, q) = (map.dofs(), map.masters().len());
    let (x, f) = (vec![1.0; q], vec![1.0; n]);
    let (mut u, mut back) = (vec![0.0; n], vec![0.0; q]);
    let t = map.reduction().t();
    let mut copy = vec![0.0; n];
    let mut read = || {
        let sum: f64 = t.values().iter().sum();
        let places = t.columns().iter().fold(0_u32, |sum, j| sum.wrapping_add(*j));
        copy.copy_from_slice(&f);
        black_box((sum, places, &copy));
    };
    println!("  T has {} entries, {n} DOFs", t.nnz());
    let of = "reading T";
    line("expand", of, both(|| map.expand_into(&x, black_box(&mut u)).expect("finite"), &mut read));
    line("increment", of, both(|| map.expand_increment_into(&x, black_box(&mut u)).expect("finite"), &mut read));
    line("project", of, both(|| map.restrict_into(&f, black_box(&mut back)).expect("finite"), &mut read));
}

/// Values of K and forces, assembled with no constraints.
fn assembled(cube: &Cube, storage: Storage) -> (CondensedPattern, Vec<f64>, Vec<f64>) {
    let dofs = |e: usize| cube.dofs(e);
    let pattern = cube
        .free
        .condensed_for_elements(cube.elements(), dofs, storage, PrescribedDofs::Eliminated)
        .expect("a pattern");
    let (mut k, mut f) = (vec![0.0; pattern.nnz()], vec![0.0; pattern.unknowns()]);
    let write = |_, matrix: &mut [f64], forces: &mut [f64]| element(matrix, forces);
    pattern.assemble(&cube.free, cube.elements(), dofs, &mut k, &mut f, write).expect("finite");
    (pattern, k, f)
}

fn matrices(cube: &Cube, storage: Storage) {
    let (k_pattern, mut k, mut f) = assembled(cube, storage);
    let dofs = |e: usize| cube.dofs(e);
    let view = View::rows(k_pattern.starts(), k_pattern.index()).storing(storage);
    let condensed = cube.map.condensed(view, PrescribedDofs::Eliminated).expect("a pattern");
    let (mut k_q, mut f_q) = (vec![0.0; condensed.nnz()], vec![0.0; condensed.unknowns()]);
    let mut copy = vec![0.0; k.len()];
    println!("  K has {} entries, {storage:?}", k.len());
    let mut condense = || condensed.condense_into(&cube.map, &k, &f, &mut k_q, &mut f_q).expect("finite");
    let one = both(&mut condense, || copy.copy_from_slice(black_box(&k)));
    line("condense", "copying K", one);
    let two = on_threads(2, || both(&mut condense, || ()).0);
    println!("  two threads: {:.2} times as fast", one.0 / two);
    let write = |_, matrix: &mut [f64], forces: &mut [f64]| element(matrix, forces);
    let with = || condensed.assemble(&cube.map, cube.elements(), dofs, &mut k_q, &mut f_q, write).expect("finite");
    let without = || k_pattern.assemble(&cube.free, cube.elements(), dofs, &mut k, &mut f, write).expect("finite");
    line("elements", "without constraints", both(with, without));
}

fn main() {
    let side = if std::env::args().any(|word| word == "--test") { 8 } else { 46 };
    on_threads(1, || {
        let cube = Cube::new(side);
        println!("cube of {} hexahedra, {} DOFs", cube.elements(), cube.map.dofs());
        vectors(&cube.map);
        [Storage::Full, Storage::Lower].into_iter().for_each(|storage| matrices(&cube, storage));
        let level = if side == 8 { Level::P50 } else { Level::P80 };
        println!("mortar {} %", level.percent());
        let system = fssi::mortar(&level.mesh(), 1).expect("a scene").system;
        vectors(&Elimination::new(&system, &Options::default()).expect("no conflict"));
    });
}

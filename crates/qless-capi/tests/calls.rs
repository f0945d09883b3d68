//! Thousands of seeded systems through the functions of C, in 32- and 64-bit indices from 0 and from 1: the bits are those of Rust.
//!
//! The functions are called as C calls them, with arrays of exactly the lengths that the header states, so that AddressSanitizer sees every
//! access outside them.
#![expect(unsafe_code, reason = "the functions take addresses")]

use std::ffi::{c_int, c_void};
use std::ptr::{null, null_mut};

use qless::common::SplitMix64;
use qless::elimination::{CondensedPattern, PrescribedDofs, Storage, View};
use qless::{ConstraintSystem, Elimination, Options, SystemBuilder, analyse};
use qless_capi::{qless_analysis, qless_elimination, qless_pattern};

/// Random equations with small integers, many of them dependent and consistent: their right-hand sides are those of a random u.
fn system(random: &mut SplitMix64) -> ConstraintSystem {
    let mut below = |count: u64| random.next() % count;
    let n = 3 + below(10) as usize;
    let u: Vec<f64> = (0..n).map(|_| below(9) as f64 - 4.0).collect();
    let mut builder = SystemBuilder::new(n);
    for _ in 0..below(n as u64) {
        let terms: Vec<(usize, f64)> =
            (0..2 + below(2)).map(|_| (below(n as u64) as usize, below(5) as f64 - 2.0)).collect();
        let b = terms.iter().map(|&(j, a)| a * u[j]).sum();
        builder.equation(terms, b);
    }
    (0..n).filter(|_| below(4) == 0).for_each(|j| builder.prescribe(j, u[j]));
    builder.build().expect("a system")
}

/// A random pattern of lines with its values; symmetric ones store the entries of their half.
struct Matrix {
    starts: Vec<usize>,
    index: Vec<u32>,
    values: Vec<f64>,
    by_columns: bool,
    storage: Storage,
}

impl Matrix {
    fn new(n: usize, random: &mut SplitMix64) -> Self {
        let by_columns = random.next().is_multiple_of(2);
        let storage = [Storage::Full, Storage::Lower, Storage::Upper][(random.next() % 3) as usize];
        let (mut starts, mut index, mut values) = (vec![0], Vec::new(), Vec::new());
        for line in 0..n {
            for other in 0..n {
                let (row, column) = if by_columns { (other, line) } else { (line, other) };
                let is_stored = match storage {
                    Storage::Full => true,
                    Storage::Lower => column <= row,
                    Storage::Upper => column >= row,
                };
                if is_stored && (row == column || random.next().is_multiple_of(3)) {
                    index.push(other as u32);
                    values.push((random.next() % 1000) as f64 / 7.0 - 70.0);
                }
            }
            starts.push(index.len());
        }
        Self { starts, index, values, by_columns, storage }
    }

    fn view(&self) -> View<'_> {
        let (starts, index) = (&self.starts, &self.index);
        let view = if self.by_columns { View::columns(starts, index) } else { View::rows(starts, index) };
        view.storing(self.storage)
    }
}

/// Which of `QLESS_FULL`, `QLESS_LOWER` and `QLESS_UPPER`.
fn number_of(storage: Storage) -> c_int {
    match storage {
        Storage::Full => 0,
        Storage::Lower => 1,
        Storage::Upper => 2,
    }
}

/// Dense elements of two or three DOFs, whose numbers depend on the element only.
fn elements(n: usize, random: &mut SplitMix64) -> Vec<Vec<usize>> {
    (0..=random.next() % 6)
        .map(|_| (0..2 + random.next() % 2).map(|_| (random.next() % n as u64) as usize).collect())
        .collect()
}

fn fill(element: usize, matrix: &mut [f64], forces: &mut [f64]) {
    matrix.iter_mut().enumerate().for_each(|(k, v)| *v += (element * 31 + k * 7 % 11) as f64 / 3.0);
    forces.iter_mut().enumerate().for_each(|(k, v)| *v += (element + k) as f64 / 7.0);
}

/// What the function of the caller needs: the lengths of the elements, and the base.
struct Context {
    lengths: Vec<usize>,
    base: usize,
}

unsafe extern "C" fn fill_in_c(context: *mut c_void, element: i64, matrix: *mut f64, forces: *mut f64) -> c_int {
    // SAFETY: the test passes this context, and the library arrays of the lengths of the element.
    unsafe {
        let context = &*context.cast::<Context>();
        let element = element as usize - context.base;
        let length = context.lengths[element];
        let matrix = std::slice::from_raw_parts_mut(matrix, length * length);
        fill(element, matrix, std::slice::from_raw_parts_mut(forces, length));
    }
    0
}

macro_rules! through_c {
    ($name:ident, $index:ty, $base:expr, $analyse:ident, $condensed:ident, $for_elements:ident, $add:ident, $arrays:ident) => {
        mod $name {
            use super::*;

            fn shifted(list: impl IntoIterator<Item = usize>) -> Vec<$index> {
                list.into_iter().map(|k| (k + $base) as $index).collect()
            }

            /// The elimination of a system.
            pub fn eliminate(system: &ConstraintSystem) -> *mut qless_elimination {
                let (matrix, given) = (system.matrix(), system.prescribed());
                let starts = shifted(matrix.starts().iter().copied());
                let columns = shifted(matrix.columns().iter().map(|&j| j as usize));
                let dofs = shifted(given.iter().map(|&(j, _)| j));
                let values: Vec<f64> = given.iter().map(|&(_, value)| value).collect();
                let (mut analysis, mut elimination): (*mut qless_analysis, _) = (null_mut(), null_mut());
                // SAFETY: the arrays have the lengths that the header states, here and below.
                unsafe {
                    let (m, n) = (system.equations() as i64, system.dofs() as i64);
                    let (v, b) = (matrix.values().as_ptr(), system.rhs().as_ptr());
                    let (p, base) = (given.len() as i64, $base as c_int);
                    let (starts, columns, dofs) = (starts.as_ptr(), columns.as_ptr(), dofs.as_ptr());
                    let place = &raw mut analysis;
                    let status = qless_capi::$analyse(
                        m,
                        n,
                        base,
                        starts,
                        columns,
                        v,
                        b,
                        p,
                        dofs,
                        values.as_ptr(),
                        null(),
                        place,
                    );
                    assert!(status >= 0);
                    assert_eq!(qless_capi::qless_eliminate(analysis, &raw mut elimination), 0);
                }
                assert_eq!(qless_capi::qless_analysis_free(analysis), 0);
                elimination
            }

            pub fn pattern(elimination: *const qless_elimination, k: &Matrix, kept: bool) -> *mut qless_pattern {
                let starts = shifted(k.starts.iter().copied());
                let index = shifted(k.index.iter().map(|&j| j as usize));
                let (n, lines, half) = (starts.len() as i64 - 1, c_int::from(k.by_columns), number_of(k.storage));
                let (kept, mut pattern) = (c_int::from(kept), null_mut());
                // SAFETY: as above.
                let status = unsafe {
                    let (starts, index) = (starts.as_ptr(), index.as_ptr());
                    qless_capi::$condensed(elimination, n, lines, half, kept, starts, index, &raw mut pattern)
                };
                assert_eq!(status, 0);
                pattern
            }

            pub fn of_elements(elimination: *const qless_elimination, list: &[Vec<usize>]) -> *mut qless_pattern {
                let ends = list.iter().scan(0, |end, dofs| {
                    *end += dofs.len();
                    Some(*end)
                });
                let starts = shifted([0].into_iter().chain(ends));
                let dofs = shifted(list.concat());
                let mut pattern = null_mut();
                // SAFETY: as above.
                let status = unsafe {
                    let (count, starts, dofs) = (list.len() as i64, starts.as_ptr(), dofs.as_ptr());
                    qless_capi::$for_elements(elimination, count, 1, 0, starts, dofs, &raw mut pattern)
                };
                assert_eq!(status, 0);
                pattern
            }

            /// Compares the lines of a pattern with those of Rust.
            pub fn assert_same(pattern: *const qless_pattern, expected: &CondensedPattern) {
                let (mut unknowns, mut entries) = (0, 0);
                // SAFETY: as above.
                unsafe { qless_capi::qless_pattern_sizes(pattern, &raw mut unknowns, &raw mut entries) };
                assert_eq!((unknowns as usize, entries as usize), (expected.unknowns(), expected.nnz()));
                let new = |length: i64| vec![0 as $index; length as usize];
                let (mut starts, mut index, mut dofs) = (new(unknowns + 1), new(entries), new(unknowns));
                // SAFETY: as above.
                let status =
                    unsafe { qless_capi::$arrays(pattern, starts.as_mut_ptr(), index.as_mut_ptr(), dofs.as_mut_ptr()) };
                assert_eq!(status, 0);
                assert_eq!(starts, shifted(expected.starts().iter().map(|&k| k as usize)));
                assert_eq!(index, shifted(expected.index().iter().map(|&k| k as usize)));
                assert_eq!(dofs, shifted(expected.dofs().iter().copied()));
            }

            /// K_q and f_q by a loop over elements.
            pub fn add(pattern: *const qless_pattern, list: &[Vec<usize>], k_q: &mut [f64], f_q: &mut [f64]) {
                for (e, dofs) in list.iter().enumerate() {
                    let (mut matrix, mut forces) = (vec![0.0; dofs.len() * dofs.len()], vec![0.0; dofs.len()]);
                    fill(e, &mut matrix, &mut forces);
                    let (count, dofs) = (dofs.len() as i64, shifted(dofs.iter().copied()));
                    let (matrix, forces, dofs) = (matrix.as_ptr(), forces.as_ptr(), dofs.as_ptr());
                    let (of_k, of_f) = (k_q.len() as i64, f_q.len() as i64);
                    let (to_k, to_f) = (k_q.as_mut_ptr(), f_q.as_mut_ptr());
                    // SAFETY: as above.
                    let status =
                        unsafe { qless_capi::$add(pattern, count, dofs, matrix, forces, to_k, of_k, to_f, of_f) };
                    assert_eq!(status, 0);
                }
            }

            pub const BASE: usize = $base;
        }
    };
}

through_c!(
    narrow,
    i32,
    0,
    qless_analyse,
    qless_condensed,
    qless_condensed_for_elements,
    qless_add_element,
    qless_pattern_arrays
);
through_c!(
    wide,
    i64,
    1,
    qless_analyse_64,
    qless_condensed_64,
    qless_condensed_for_elements_64,
    qless_add_element_64,
    qless_pattern_arrays_64
);

fn bits(list: &[f64]) -> Vec<u64> {
    list.iter().map(|v| v.to_bits()).collect()
}

/// K_q and f_q of Rust and of C; with `parts` C computes them by two calls.
fn assert_condensed(
    pattern: *const qless_pattern,
    (expected, elimination): (&CondensedPattern, &Elimination),
    k: &[f64],
    parts: bool,
) {
    let f: Vec<f64> = (0..elimination.dofs()).map(|j| j as f64 / 3.0).collect();
    let new = || (vec![0.0; expected.nnz()], vec![0.0; expected.unknowns()]);
    let ((mut k_q, mut f_q), (mut k_c, mut f_c)) = (new(), new());
    expected.condense_into(elimination, k, &f, &mut k_q, &mut f_q).expect("finite");
    let length = |list: &[f64]| list.len() as i64;
    let (of_k, of_f, of_k_q, of_f_q) = (length(k), length(&f), length(&k_c), length(&f_c));
    let (k, f) = (k.as_ptr(), f.as_ptr());
    let (to_k, to_f) = (k_c.as_mut_ptr(), f_c.as_mut_ptr());
    // SAFETY: the arrays have these lengths.
    unsafe {
        if parts {
            assert_eq!(qless_capi::qless_condense(pattern, k, of_k, null(), 0, to_k, of_k_q, null_mut(), 0), 0);
            assert_eq!(qless_capi::qless_condense(pattern, k, of_k, f, of_f, null_mut(), 0, to_f, of_f_q), 0);
        } else {
            assert_eq!(qless_capi::qless_condense(pattern, k, of_k, f, of_f, to_k, of_k_q, to_f, of_f_q), 0);
        }
    }
    assert_eq!((bits(&k_c), bits(&f_c)), (bits(&k_q), bits(&f_q)));
}

/// Adds all elements to K_q and f_q.
type AddElements = fn(*const qless_pattern, &[Vec<usize>], &mut [f64], &mut [f64]);

fn assert_assembled(
    pattern: *const qless_pattern,
    (expected, elimination): (&CondensedPattern, &Elimination),
    list: &[Vec<usize>],
    (base, add): (usize, AddElements),
) {
    let new = || (vec![0.0; expected.nnz()], vec![0.0; expected.unknowns()]);
    let ((mut k_q, mut f_q), (mut k_c, mut f_c)) = (new(), new());
    let dofs = |e: usize| list[e].as_slice();
    expected.assemble(elimination, list.len(), dofs, &mut k_q, &mut f_q, fill).expect("finite");
    let mut context = Context { lengths: list.iter().map(Vec::len).collect(), base };
    let context = (&raw mut context).cast();
    let (to_k, to_f, of_k, of_f) = (k_c.as_mut_ptr(), f_c.as_mut_ptr(), k_c.len() as i64, f_c.len() as i64);
    // SAFETY: the arrays have these lengths, and the context lives.
    let status = unsafe { qless_capi::qless_assemble(pattern, Some(fill_in_c), context, to_k, of_k, to_f, of_f) };
    assert_eq!(status, 0);
    assert_eq!((bits(&k_c), bits(&f_c)), (bits(&k_q), bits(&f_q)));
    (k_c, f_c) = new();
    add(pattern, list, &mut k_c, &mut f_c);
    assert_eq!((bits(&k_c), bits(&f_c)), (bits(&k_q), bits(&f_q)));
}

#[test]
fn condensed_matrices_have_the_bits_of_rust() {
    let mut dependent = 0;
    for seed in 0..2000 {
        let mut random = SplitMix64::new(seed);
        let system = system(&mut random);
        let analysis = analyse(&system, &Options::default()).expect("an analysis");
        dependent += analysis.dependent().len();
        let Ok(elimination) = Elimination::from_analysis(analysis, qless::Form::Explicit) else {
            panic!("seed {seed}: the equations are consistent");
        };
        let (k, list) = (Matrix::new(system.dofs(), &mut random), elements(system.dofs(), &mut random));
        let kept = seed % 3 == 0;
        let prescribed = if kept { PrescribedDofs::Kept } else { PrescribedDofs::Eliminated };
        let expected = elimination.condensed(k.view(), prescribed).expect("a pattern");
        let dofs = |e: usize| list[e].as_slice();
        let of_list = elimination
            .condensed_for_elements(list.len(), dofs, Storage::Lower, PrescribedDofs::Eliminated)
            .expect("a pattern");
        macro_rules! compare {
            ($width:ident) => {
                let made = $width::eliminate(&system);
                let (pattern, assembled) = ($width::pattern(made, &k, kept), $width::of_elements(made, &list));
                $width::assert_same(pattern, &expected);
                $width::assert_same(assembled, &of_list);
                // The patterns keep the elimination.
                assert_eq!(qless_capi::qless_elimination_free(made), 0);
                assert_condensed(pattern, (&expected, &elimination), &k.values, seed % 2 == 0);
                assert_assembled(assembled, (&of_list, &elimination), &list, ($width::BASE, $width::add));
                assert_eq!(qless_capi::qless_pattern_free(pattern), 0);
                assert_eq!(qless_capi::qless_pattern_free(assembled), 0);
            };
        }
        compare!(narrow);
        compare!(wide);
    }
    assert!(dependent > 500, "{dependent} dependent equations");
}

/// New values of K with the same pattern, and new right-hand sides.
#[test]
fn refreshed_values_have_the_bits_of_rust() {
    for seed in 0..200 {
        let mut random = SplitMix64::new(seed);
        let system = system(&mut random);
        let mut elimination = Elimination::new(&system, &Options::default()).expect("consistent equations");
        let mut k = Matrix::new(system.dofs(), &mut random);
        let expected = elimination.condensed(k.view(), PrescribedDofs::Eliminated).expect("a pattern");
        let made = wide::eliminate(&system);
        let pattern = wide::pattern(made, &k, false);
        for step in 1..4 {
            let scale = f64::from(step);
            let rhs: Vec<f64> = system.rhs().iter().map(|b| scale * b).collect();
            let given: Vec<f64> = system.prescribed().iter().map(|&(_, value)| scale * value).collect();
            k.values.iter_mut().for_each(|v| *v += 1.0);
            elimination.update(&rhs, &given).expect("consistent equations");
            let (m, p) = (rhs.len() as i64, given.len() as i64);
            // SAFETY: the arrays have these lengths.
            let status = unsafe { qless_capi::qless_refresh(made, rhs.as_ptr(), m, given.as_ptr(), p) };
            assert_eq!(status, 0);
            assert_condensed(pattern, (&expected, &elimination), &k.values, false);
        }
        assert_eq!(qless_capi::qless_pattern_free(pattern), 0);
        assert_eq!(qless_capi::qless_elimination_free(made), 0);
    }
}

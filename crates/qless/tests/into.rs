//! After the first call, no `_into` function of an elimination with explicit T allocates memory.

use qless::elimination::{CondensedPattern, PrescribedDofs, View};
use qless::{Elimination, Options, SystemBuilder};

#[global_allocator]
static ALLOCATOR: dhat::Alloc = dhat::Alloc;

/// n DOFs of which every seventh is the mean of two others, given twice; one DOF is prescribed.
fn map(n: usize) -> Elimination {
    let mut builder = SystemBuilder::new(n);
    for j in (5..n - 5).step_by(7) {
        builder.equation([(j, 1.0), (j - 3, -0.5), (j + 3, -0.5)], 0.1);
        builder.equation([(j, 2.0), (j - 3, -1.0), (j + 3, -1.0)], 0.2);
    }
    builder.prescribe(0, 1.0);
    Elimination::new(&builder.build().expect("valid"), &Options::default()).expect("consistent")
}

/// Compressed lines of a tridiagonal matrix.
fn matrix(n: usize) -> (Vec<usize>, Vec<u32>) {
    let line = |i: usize| i.saturating_sub(1)..(i + 2).min(n);
    let mut starts = vec![0];
    let mut index = Vec::new();
    for i in 0..n {
        index.extend(line(i).map(|j| j as u32));
        starts.push(index.len());
    }
    (starts, index)
}

/// Number of allocations by `work`.
fn allocated(work: &mut dyn FnMut()) -> u64 {
    work();
    let before = dhat::HeapStats::get().total_blocks;
    work();
    dhat::HeapStats::get().total_blocks - before
}

fn steps(map: &Elimination, condensed: &CondensedPattern) -> Vec<(&'static str, u64)> {
    let (n, q) = (map.dofs(), map.masters().len());
    let (masters, forces) = (vec![1.0; 2 * q], vec![1.0; 2 * n]);
    let (mut u, mut f) = (vec![0.0; 2 * n], vec![0.0; 2 * q]);
    let k = vec![2.0; 3 * n - 2];
    let (mut k_q, mut f_q) = (vec![0.0; condensed.nnz()], vec![0.0; condensed.unknowns()]);
    let mut operator = map.operator(|u: &[f64], f: &mut [f64]| f.copy_from_slice(u));
    vec![
        ("expand", allocated(&mut || map.expand_into(&masters[..q], &mut u[..n]).expect("lengths"))),
        ("increment", allocated(&mut || map.expand_increment_into(&masters[..q], &mut u[..n]).expect("lengths"))),
        ("increments", allocated(&mut || map.expand_increments_into(&masters, &mut u).expect("lengths"))),
        ("project", allocated(&mut || map.restrict_into(&forces[..n], &mut f[..q]).expect("lengths"))),
        ("project many", allocated(&mut || map.restrict_many_into(&forces, &mut f).expect("lengths"))),
        ("operator", allocated(&mut || operator.apply_into(&masters[..q], &mut f[..q]).expect("lengths"))),
        ("condense matrix", allocated(&mut || condensed.condense_matrix_into(map, &k, &mut k_q).expect("numbers"))),
        ("load", allocated(&mut || condensed.load_into(map, &k, &forces[..n], &mut f_q).expect("numbers"))),
        (
            "condense",
            allocated(&mut || condensed.condense_into(map, &k, &forces[..n], &mut k_q, &mut f_q).expect("numbers")),
        ),
    ]
}

#[test]
fn no_step_allocates() {
    let _profiler = dhat::Profiler::builder().testing().build();
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    for n in [100, 50_000] {
        let map = map(n);
        let (starts, index) = matrix(n);
        for view in [View::rows(&starts, &index), View::columns(&starts, &index)] {
            for given in [PrescribedDofs::Eliminated, PrescribedDofs::Kept] {
                let condensed = map.condensed(view, given).expect("a pattern");
                // The thread pool allocates task lists for parallel calls, so the test runs on one thread.
                let found = one.install(|| steps(&map, &condensed));
                assert!(found.iter().all(|(_, blocks)| *blocks == 0), "n = {n}: {found:?}");
            }
        }
    }
}

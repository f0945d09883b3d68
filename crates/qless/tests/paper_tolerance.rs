//! The paper's tolerance, on every backend, with and without presolve.

use qless::{BackendChoice, ConstraintSystem, Options, SystemBuilder, Tolerance, analyse};

/// Equations as lists of terms, with their right-hand sides.
type Equations<'a> = &'a [(&'a [(usize, f64)], f64)];

fn system(dofs: usize, equations: Equations, prescribed: &[(usize, f64)]) -> ConstraintSystem {
    let mut builder = SystemBuilder::new(dofs);
    equations.iter().for_each(|(terms, rhs)| _ = builder.equation(terms.iter().copied(), *rhs));
    prescribed.iter().for_each(|&(j, value)| builder.prescribe(j, value));
    builder.build().expect("valid")
}

fn backends() -> Vec<BackendChoice> {
    let all = [BackendChoice::Faer, BackendChoice::Sparse, BackendChoice::Gauss];
    all.into_iter().chain(cfg!(feature = "spqr").then_some(BackendChoice::Spqr)).collect()
}

/// Every backend, with and without presolve.
fn settings(options: &Options) -> Vec<Options> {
    let both = |backend| [true, false].map(|presolve| Options { backend, presolve, ..options.clone() });
    backends().into_iter().flat_map(both).collect()
}

/// Absolute 1e-5 without scaling, as the paper says.
#[test]
fn the_papers_tolerance_is_absolute() {
    let rows: Equations = &[(&[(0, 1.0), (1, 1.0)], 0.0), (&[(0, 1e-7), (1, 2e-7)], 0.0)];
    for (scale, rank) in [(1.0, 1), (1e4, 2)] {
        let rows: Vec<_> =
            rows.iter().map(|(terms, _)| terms.iter().map(|&(j, v)| (j, v * scale)).collect::<Vec<_>>()).collect();
        let rows: Vec<_> = rows.iter().map(|terms| (terms.as_slice(), 0.0)).collect();
        let system = system(2, &rows, &[]);
        for options in settings(&Options { tolerance: Tolerance::Paper, ..Options::default() }) {
            let found = analyse(&system, &options).expect("small").rank();
            assert_eq!(found, rank, "{:?}, presolve {}, {scale:e}", options.backend, options.presolve);
        }
        assert_eq!(analyse(&system, &Options::default()).expect("small").rank(), 2);
    }
}

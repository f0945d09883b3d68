//! The choices: one thing at a time is different from the default.

use qless::{BackendChoice, Options, Tolerance};

/// A choice and its name.
pub struct Method {
    pub name: &'static str,
    pub options: Options,
    /// Whether it is drawn in the plot of times against sizes.
    pub is_drawn: bool,
    /// Equations from which on it is known to take minutes.
    pub most: usize,
}

/// No bound of the growth, for all that matters.
const UNBOUNDED: f64 = 1e15;

/// Equations of a system on which a dense method takes half a minute.
const DENSE: usize = 7_000;

/// All that this program was built with.
pub fn all() -> Vec<Method> {
    let standard = Options::default();
    let method = |name, is_drawn, options| Method { name, options, is_drawn, most: usize::MAX };
    let backend = |backend| Options { backend, presolve: false, ..standard.clone() };
    let tolerance = |tolerance| Options { tolerance: Tolerance::Relative(tolerance), ..standard.clone() };
    let mut all = vec![
        method("default", true, standard.clone()),
        method("faer alone", true, backend(BackendChoice::Faer)),
        method("sparse alone", true, backend(BackendChoice::Sparse)),
    ];
    if cfg!(feature = "spqr") {
        all.push(method("spqr alone", true, backend(BackendChoice::Spqr)));
    }
    all.extend([
        Method { most: DENSE, ..method("gauss alone", true, backend(BackendChoice::Gauss)) },
        method("gauss", false, Options { backend: BackendChoice::Gauss, ..standard.clone() }),
        method("growth unbounded", false, Options { growth: UNBOUNDED, ..standard.clone() }),
        method("tolerance 1e-4", false, tolerance(1e-4)),
        method("tolerance 1e-6", false, tolerance(1e-6)),
        method("tolerance 1e-8", false, tolerance(1e-8)),
        method("tolerance 1e-12", false, tolerance(1e-12)),
        method("tolerance 1e-14", false, tolerance(1e-14)),
        method("paper's tolerance", false, Options { tolerance: Tolerance::Paper, ..standard }),
    ]);
    all
}

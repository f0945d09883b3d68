//! `qless._qless`: the interface between Python and the library.
//!
//! ```text
//! numpy arrays -> ConstraintSystem -> Analysis -> Elimination -> numpy arrays
//! ```
//!
//! The package `qless` in Python holds what users see: sparse matrices, labels, texts and constraint types. This module accepts and returns
//! arrays only. Long calls release the interpreter lock.

mod analysis;
mod elimination;
mod errors;
mod explanation;
mod files;
mod interrupt;
mod options;
mod system;

use pyo3::prelude::*;

#[pymodule]
mod _qless {
    #[pymodule_export]
    use super::analysis::{PyAnalysis, analyse};
    #[pymodule_export]
    use super::elimination::PyElimination;
    #[pymodule_export]
    use super::files::read;
    #[pymodule_export]
    use super::system::{PySystem, system_from_dense, system_from_rows};
    use super::{Bound, PyModule, PyModuleMethods, PyResult};

    /// Adds the version of this build.
    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}

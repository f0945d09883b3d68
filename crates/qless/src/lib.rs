//! Constraints `C u = b` that a finite-element solver can trust.

pub mod qr;
mod system;

pub use system::{ConstraintSystem, Csr, Place, SystemBuilder, SystemError};
mod analysis;
mod basis;
mod block;
mod certificate;
mod confidence;
mod generated;
mod reduction;
mod report;
pub use analysis::{Analysis, AnalysisError, Dependent, Kind, PresolveStatistics, Timings, analyse};
pub use certificate::Because;
pub use confidence::Confidence;
pub use reduction::Reduction;
pub use report::{
    BackendUsed, Certificate, Counts, DependentEquation, GeneratedCondition, InputSizes, Milliseconds, Omitted,
    ReductionSizes, Report, Term,
};
mod presolve;
mod scale;
mod sensitivity;
mod options;
pub use options::{BackendChoice, OptionError, Options, Tolerance};

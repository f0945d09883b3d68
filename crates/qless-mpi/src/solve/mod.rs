//! Each rank analyses its assigned equations with the serial library, and returns the results.

mod local_analysis;
mod residual_check;
mod return_results;
mod rows;
mod substitute;

pub(crate) use local_analysis::{LocalAnalysis, Soundness};
pub use return_results::{DistributedCertificateTerm, DistributedDependent};
pub(crate) use return_results::{ReturnedResults, request_rows, return_results};
pub(crate) use rows::{PRESCRIBED_BIT, ReductionRow, ReductionRows, SlaveRows};
pub(crate) use substitute::substitute;

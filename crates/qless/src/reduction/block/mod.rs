//! The independent rows of a block, solved for slaves: `u_s = relation (u_q, u_p) + constant`.
//!
//! Small blocks by QR of C with column pivoting, `u_s = -R1^-1 R2 u_q - R1^-1 Q^T C_p u_p + R1^-1 Q^T b`, larger ones by sparse LU of C^T.

mod large;
mod refine;
mod slaves;

pub(crate) use slaves::{may_be_slaves, solve};

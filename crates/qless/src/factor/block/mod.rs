//! The equations that presolve leaves, block by block: which rows depend on which, and how the DOFs can move (Eq. 21, 22).
//!
//! The diagnosis factors `C^T`: its dependent columns are the dependent equations, and `R1 y = R2_k` gives the certificate of row k.
//! Heath-style rank detection is far more often right on `C^T` (tall) than on C. Random vectors of the null space ([`triangle`]) tell
//! which DOFs can move. No slave is chosen here.

pub(crate) mod dependent;
mod gathered;
pub(crate) mod tableau;
pub(crate) mod triangle;

use crate::factor::backend::BackendError;
use crate::presolve::basis::Diagnosed;
use dependent::Rows;
use triangle::Triangle;

pub(crate) use gathered::{Block, FactorContext};

/// Which rows of a block depend on which, and how its DOFs can move; with the factor of the kept rows.
pub(crate) fn diagnose(block: &Block, means: FactorContext) -> Result<(Diagnosed, Triangle), BackendError> {
    let Rows { kept, order, dependent, nearness, triangle } = dependent::find(block, means)?;
    let rows = kept.iter().map(|&i| block.rows[i]).collect();
    let order = order.iter().map(|&k| k as u32).collect();
    let vectors = triangle.vectors(block);
    Ok((Diagnosed { kept: rows, order, dependent, nearness, vectors }, triangle))
}

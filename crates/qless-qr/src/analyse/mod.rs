//! Pattern of A -> order, fronts, forecast.

mod counts;
mod forecast;
mod fronts;
mod order;
mod patterns;
mod permuted;
mod rest;
mod singles;
mod tree;

pub(crate) use forecast::{
    Forecast, INDEX, Shape, front_bytes, kept_bytes, out_bytes, reflection_bytes, waiting_bytes,
};
pub(crate) use fronts::Fronts;

use crate::Error;
use crate::pattern::Lists;
use crate::symbolic::Symbolic;
use rest::Rest;

/// AMD comes first if `S^T S` has at most so many times the entries of S; it is the faster of the two then.
const PRODUCT: usize = 5;
/// The other order is tried too where the first promises so many operations for each entry of S.
const WORTH: f64 = 2e4;

/// The analysis; only entries of A that `may` accepts are peeled.
pub(crate) fn analyse(row_count: usize, columns: &Lists, may: &dyn Fn(usize) -> bool) -> Result<Symbolic, Error> {
    let rows = columns.transposed(row_count);
    let peeled = singles::peel(columns, &rows, may);
    let rest = Rest::new(columns, &rows, &peeled);
    let with = |order: Vec<u32>| rest.symbolic(columns, row_count, &peeled, &order);
    let by_rows = rest.columns.transposed(rest.rows);
    let Some(order) = order::amd(&rest.columns, &by_rows, PRODUCT * rest.columns.index.len())? else {
        return order::colamd(rest.rows, &rest.columns).map(with);
    };
    let first = with(order);
    if first.flops() <= WORTH * rest.columns.index.len() as f64 {
        return Ok(first);
    }
    let second = with(order::colamd(rest.rows, &rest.columns)?);
    Ok(if second.flops() < first.flops() { second } else { first })
}

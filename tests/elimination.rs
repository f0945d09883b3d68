//! The operations of every step (expand, restrict, condense) against dense products with the same L and u_0, for random systems.

#[path = "elimination/condensed.rs"]
mod condensed;
#[path = "elimination/dense.rs"]
mod dense;
#[path = "elimination/edges.rs"]
mod edges;
#[path = "elimination/matrix.rs"]
mod matrix;
#[path = "elimination/pivots.rs"]
mod pivots;
#[path = "elimination/small_entries.rs"]
mod small_entries;
#[path = "elimination/units.rs"]
mod units;
#[path = "elimination/vectors.rs"]
mod vectors;

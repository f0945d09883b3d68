//! What a code does with constraints in every step, against dense products with the same L and u_0, for random systems.

#[path = "map/condensed.rs"]
mod condensed;
#[path = "map/dense.rs"]
mod dense;
#[path = "map/edges.rs"]
mod edges;
#[path = "map/matrix.rs"]
mod matrix;
#[path = "map/units.rs"]
mod units;
#[path = "map/vectors.rs"]
mod vectors;

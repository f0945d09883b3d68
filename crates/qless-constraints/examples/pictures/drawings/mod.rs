//! The drawing of each constraint type.

mod bodies;
mod couplings;
mod fields;
mod joints;
mod points;
mod ties;

use super::canvas::Picture;

/// All pictures.
pub fn all() -> Vec<Picture> {
    [points::all(), fields::all(), ties::all(), bodies::all(), joints::all(), couplings::all()]
        .into_iter()
        .flatten()
        .collect()
}

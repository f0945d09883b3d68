//! Where grid points are, for pictures.

use std::collections::HashMap;

use super::build::points;
use crate::deck::nastran::syntax::reader::read;
use crate::deck::{Deck, Model};

/// Positions in the basic system; none where the deck cannot be read once more.
pub fn positions(deck: &Deck) -> HashMap<u32, [f64; 3]> {
    let Ok(mut content) = deck.again(read) else { return HashMap::new() };
    let points = points(&mut content.bulk, &mut Model::new(deck.model.files.clone()));
    points.map(|points| points.positions().collect()).unwrap_or_default()
}

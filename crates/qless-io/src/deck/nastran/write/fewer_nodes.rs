//! Writes an `RBE2` without some of its dependent grid points.

use super::select::small_field;
use crate::deck::nastran::cards::elements::NastranElement;
use crate::deck::nastran::cards::ties::{TieCard, Ties};
use crate::deck::nastran::syntax::lines::FileLine;

/// The file and line of each `RBE2` card, with a function that writes the card with other dependent points.
pub fn with_points(ties: &Ties) -> impl Iterator<Item = (FileLine, impl Fn(&[u32]) -> String)> {
    ties.iter().filter_map(|tie| match tie {
        TieCard::Element(NastranElement::Star(star), place) => {
            let write = |points: &[u32]| {
                let name = place.name.to_string();
                let id = name.split_once(' ').map_or("", |(_, id)| id).to_owned();
                let components = star.components.iter().map(|component| component.to_string()).collect();
                let head = [id, star.centre.to_string(), components];
                small_field("RBE2", head.into_iter().chain(points.iter().map(u32::to_string)))
            };
            Some(((place.file, place.line), write))
        }
        _ => None,
    })
}

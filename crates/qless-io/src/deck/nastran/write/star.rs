//! Writes an `RBE2` without some of its dependent grid points.

use std::collections::{BTreeMap, BTreeSet};

use super::select::small_field;
use crate::deck::Model;
use crate::deck::clean::Removed;
use crate::deck::nastran::cards::elements::{NastranElement, RigidStar};
use crate::deck::nastran::cards::ties::{TieCard, Ties};
use crate::deck::nastran::syntax::lines::FileLine;

/// The cards that lose only some of their dependent points, by file and line: those points, and the new card.
pub fn shortened(model: &Model, ties: &Ties, removed: &[Removed]) -> BTreeMap<FileLine, (BTreeSet<u32>, String)> {
    let gone: BTreeSet<usize> = removed.iter().map(|removed| removed.equation).collect();
    let place = |i: usize| {
        let origin = model.nth(i).origin;
        (model.cards.nth(origin.card).file, origin.line)
    };
    let mut points: BTreeMap<FileLine, [Vec<u32>; 2]> = gone.iter().map(|&i| (place(i), Default::default())).collect();
    for i in 0..model.equations() {
        let Some([left, lost]) = points.get_mut(&place(i)) else { continue };
        let side = if gone.contains(&i) { lost } else { left };
        side.extend(model.nth(i).columns.first().map(|&j| model.dofs[j as usize].node));
    }
    points.retain(|_, [left, _]| !left.is_empty());
    let shorter = |tie| match tie {
        TieCard::Element(NastranElement::Star(star), place) => {
            let [left, lost] = points.remove(&(place.file, place.line))?;
            let id = place.name.to_string().split_once(' ')?.1.to_owned();
            Some(((place.file, place.line), (lost.into_iter().collect(), card(id, star, left))))
        }
        _ => None,
    };
    ties.iter().filter_map(shorter).collect()
}

fn card(id: String, star: &RigidStar, mut points: Vec<u32>) -> String {
    points.dedup();
    let components: String = star.components.iter().map(|component| component.to_string()).collect();
    let points = points.iter().map(u32::to_string);
    small_field("RBE2", [id, star.centre.to_string(), components].into_iter().chain(points))
}

//! Reads the equations and prescribed values of each card that constrains. `reader` calls a [`ReadRadioss`] for each card.

pub mod body;
pub mod coupling;
pub mod prescribed;
mod segment;
pub mod tie;
pub mod unread;

use super::model::mesh::RadiossMesh;
use crate::deck::Dof;
use crate::deck::keyword::group::{Gap, GroupMeaning};
use crate::deck::keyword::line::{KeywordFault, KeywordLine};
use crate::deck::kinematics::body::CouplingEquation;
use crate::deck::kinematics::components::Components;
use crate::deck::kinematics::vector::Vector;

/// The type of functions that read the lines of a card, of which there is at least one.
pub type ReadRadioss = fn(&[KeywordLine], &mut RadiossMesh) -> Result<GroupMeaning, Gap>;

/// The components that a field `   111 111` marks: three translations, then three rotations.
pub fn marked(line: &KeywordLine, field: usize) -> Result<Components, KeywordFault> {
    const COLUMNS: [usize; 6] = [3, 4, 5, 7, 8, 9];
    let mark = |(set, component): (Components, u8)| {
        let column = 10 * field + COLUMNS[usize::from(component) - 1];
        match line.text.get(column).copied().unwrap_or(b' ') {
            b'1' => Ok(set.with(component)),
            b'0' | b' ' => Ok(set),
            _ => Err(line.expected(field, "three digits 0 or 1, a blank, and three more, in columns 4 to 10")),
        }
    };
    (1..=6).try_fold(Components::default(), |set, component| mark((set, component)))
}

/// The components of a node among these: a node of solids has no rotations.
pub fn own(mesh: &RadiossMesh, node: u32, set: Components) -> Components {
    if mesh.elements.rotates(node) { set } else { set.and(Components::TRANSLATIONS) }
}

/// The terms of a component of a node along its axis in a frame: `e . u` for components 1 to 3, and `e . w` for 4 to 6. Zeros are left out.
pub fn along(node: u32, component: u8, axes: &[Vector; 3]) -> Vec<(Dof, f64)> {
    let axis = axes[usize::from(component - 1) % 3];
    let first = if component > 3 { 4 } else { 1 };
    let term = |(k, x): (u8, f64)| (Dof { node, component: k }, x);
    (first..).zip(axis).map(term).filter(|(_, x)| *x != 0.0).collect()
}

/// The equation with these terms. The term with the largest coefficient comes first among those that begin no other row of the card.
pub fn led(rows: &[CouplingEquation], mut terms: Vec<(Dof, f64)>, own: usize) -> CouplingEquation {
    let is_free = |dof: &Dof| rows.iter().rev().take(5).all(|row| row.terms[0].0 != *dof);
    let best =
        (0..own).filter(|&k| is_free(&terms[k].0)).max_by(|&a, &b| terms[a].1.abs().total_cmp(&terms[b].1.abs()));
    terms.swap(0, best.unwrap_or(0));
    CouplingEquation { terms }
}

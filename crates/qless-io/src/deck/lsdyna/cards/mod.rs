//! Reads the equations and prescribed values of each card that constrains. `reader` calls a [`ReadGroup`] for each group of lines.

pub mod body;
pub mod coupling;
pub mod prescribed;
pub mod tie;
pub mod unread;

use super::model::bodies::DynaDefinitions;
use crate::deck::keyword::group::{Gap, GroupMeaning};
use crate::deck::keyword::line::{KeywordFault, KeywordLine};
use crate::deck::kinematics::components::Components;

/// The type of functions that read a group of lines. The group has at least one line.
pub type ReadGroup = fn(&[KeywordLine], &mut DynaDefinitions) -> Result<GroupMeaning, Gap>;

/// The components for a code from 0 to 7 in a field: none, x, y, z, xy, yz, zx, xyz. `first` is the component that stands for x: 1 for
/// translations, 4 for rotations.
pub fn coded(line: &KeywordLine, field: usize, first: u8) -> Result<Components, KeywordFault> {
    const AXES: [&[u8]; 8] = [&[], &[0], &[1], &[2], &[0, 1], &[1, 2], &[2, 0], &[0, 1, 2]];
    let axes = usize::try_from(line.whole(field)?).ok().and_then(|code| AXES.get(code));
    let axes = axes.ok_or_else(|| line.expected(field, "a code of directions from 0 to 7"))?;
    Ok(axes.iter().fold(Components::default(), |set, axis| set.with(first + axis)))
}

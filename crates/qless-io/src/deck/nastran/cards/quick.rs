//! Reads the most frequent cards by a fast path: `GRID` and `MPC` in small field, on one line, with plain numbers.
//!
//! The result equals that of the general path through `BulkCard`. All other lines are left to the general path, which also reports errors.

use super::points::{GridCard, GridDefaults};
use super::sets::MpcTerm;
use crate::deck::kinematics::components::Components;
use crate::deck::nastran::syntax::number::{BLANK, SmallField, small_real, small_whole};
use crate::number;

/// Number of columns of a field.
const FIELD: usize = 8;

/// A card read by the fast path.
pub enum QuickCard {
    Grid(GridCard),
    /// An `MPC` card: the number of its set, and one or two terms.
    Mpc(u32, MpcTerm, Option<MpcTerm>),
}

/// Reads a card of one line, which no other line may continue. Returns `None` if the general path must read it, for instance if a relevant
/// field holds a comment or a tab.
pub fn read(line: &[u8]) -> Option<QuickCard> {
    let is_grid = match line.first_chunk()? {
        b"GRID    " => true,
        b"MPC     " => false,
        _ => return None,
    };
    let (whole, rest) = line[FIELD..].as_chunks();
    let mut fields = [BLANK; 8];
    fields.get_mut(..whole.len())?.copy_from_slice(whole);
    if !rest.is_empty() {
        fields.get_mut(whole.len())?[..rest.len()].copy_from_slice(rest);
    }
    // A comma in the first data field means that the line is in free field.
    if fields[0].contains(&b',') {
        return None;
    }
    if is_grid { grid(&fields).map(QuickCard::Grid) } else { mpc(&fields) }
}

fn grid(fields: &[SmallField; 8]) -> Option<GridCard> {
    let [id, cp, x, y, z, cd, ps, _] = *fields;
    let prescribed = if ps == BLANK { None } else { Some(Components::parse(word(&ps))?) };
    let (position_frame, displacement_frame) = (optional(cp).ok()?, optional(cd).ok()?);
    let fields = GridDefaults { position_frame, displacement_frame, prescribed };
    Some(GridCard { id: id_of(id)?, at: [real(x)?, real(y)?, real(z)?], fields })
}

fn mpc(fields: &[SmallField; 8]) -> Option<QuickCard> {
    let [set, node, component, value, other @ .., _] = *fields;
    let first = term([node, component, value])?;
    let second = if other == [BLANK; 3] { None } else { Some(term(other)?) };
    Some(QuickCard::Mpc(id_of(set)?, first, second))
}

fn term([node, component, value]: [SmallField; 3]) -> Option<MpcTerm> {
    let component = Components::parse(word(&component)).filter(|set| set.len() <= 1)?;
    Some((id_of(node)?, component, real(value)?))
}

fn id_of(field: SmallField) -> Option<u32> {
    optional(field).ok()?.filter(|&id| id > 0)
}

/// Reads a whole number, of at most eight digits, which fits into 32 bits. Returns `None` for a blank field, and an error for any other
/// text.
fn optional(field: SmallField) -> Result<Option<u32>, ()> {
    if field == BLANK {
        return Ok(None);
    }
    small_whole(field).map(Some).ok_or(())
}

/// Reads a real number; a blank field is 0.
fn real(field: SmallField) -> Option<f64> {
    if field == BLANK { Some(0.0) } else { small_real(field).or_else(|| number::short(word(&field))) }
}

/// The text of the field without surrounding blanks.
fn word(field: &SmallField) -> &[u8] {
    let filled = u64::from_le_bytes(*field) ^ u64::from_le_bytes(BLANK);
    let (start, end) = (filled.trailing_zeros() / 8, FIELD as u32 - filled.leading_zeros() / 8);
    field.get(start as usize..end as usize).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::deck::nastran::cards::sets::terms;
    use crate::deck::nastran::syntax::card::BulkCard;

    /// Reads the card as the general path does.
    fn card(line: &str) -> BulkCard {
        let mut card = BulkCard::default();
        let name = if line.starts_with("GRID") { "GRID" } else { "MPC" };
        card.begin(name, line.as_bytes(), (0, 1)).expect("a card");
        card
    }

    #[test]
    fn the_fast_path_agrees_with_the_general_path() {
        for line in [
            "GRID    1               0.      -1.5    2.5E1",
            "GRID          12       71.2345671.2345671.234567      13       1     246",
            "GRID    99999999",
            "GRID    7       0                        3.             0       0",
        ] {
            let Some(QuickCard::Grid(grid)) = read(line.as_bytes()) else { panic!("{line}") };
            assert_eq!(grid, GridCard::read(&card(line)).expect("a grid point"));
        }
        for line in [
            "MPC     3       7       1       1.0     8               -.5",
            "MPC            3       7       6     1.0                        ignored",
            "MPC     1       2       0",
        ] {
            let Some(QuickCard::Mpc(set, first, second)) = read(line.as_bytes()) else { panic!("{line}") };
            let card = card(line);
            assert_eq!(card.id(0, "a set").expect("a set"), set);
            assert_eq!(terms(&card).expect("terms"), std::iter::once(first).chain(second).collect::<Vec<_>>());
        }
    }

    #[test]
    fn all_other_lines_are_left_to_the_general_path() {
        for line in [
            "GRID*                  1",
            "GRID,1,,0.",
            "GRID    1,2     3",
            "grid    1",
            "GRID    0",
            "GRID    x",
            "GRID    1               1.5-3",
            "GRID    1       -1",
            "GRID    1               1.      2.      3.      0       7",
            "MPC     1",
            "MPC     1               1       1.0     7       1       1.0",
            "MPC     1       2       12      1.0",
            "MPC     1       2       1       1.0                                    +A",
            "RBE2    1       2       123     3",
            "GRID",
        ] {
            assert!(read(line.as_bytes()).is_none(), "{line}");
        }
    }
}

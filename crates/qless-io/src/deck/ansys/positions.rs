//! Where nodes are, for pictures, and which sets they form.

use std::collections::HashMap;

use super::command::Command;
use super::field::real;
use super::reader::Reader;
use crate::deck::Deck;
use crate::number;

/// Positions along the model's axes; none where the deck cannot be read once more.
pub fn positions(deck: &Deck) -> HashMap<u32, [f64; 3]> {
    let reader = deck.again(|sources| Reader::with_positions(sources.path(0), &sources.text(0)));
    reader.ok().and_then(|reader| reader.nodes.positions.kept).unwrap_or_default()
}

/// The nodes of the components that `CMBLOCK` defines, by name.
pub fn node_sets(deck: &Deck) -> HashMap<String, Vec<u32>> {
    let reader = deck.again(|sources| Reader::with_positions(sources.path(0), &sources.text(0)));
    let groups = reader.map(|reader| reader.nodes.groups).unwrap_or_default();
    let nodes = |ranges: Vec<(u32, u32)>| ranges.into_iter().flat_map(|(first, last)| first..=last).collect();
    groups.into_iter().map(|(name, ranges)| (name, nodes(ranges))).collect()
}

/// Positions as they are read.
#[derive(Debug, Default)]
pub struct Positions {
    /// None where nobody asks for them.
    pub kept: Option<HashMap<u32, [f64; 3]>>,
    /// Whether commands give coordinates along axes of their own.
    are_local: bool,
}

impl Positions {
    /// Notes positions from now on.
    pub fn keep(&mut self) {
        self.kept = Some(HashMap::new());
    }

    /// `CSYS, KCN`, and commands that define a coordinate system, which is the active one from then on.
    pub fn axes(&mut self, command: &Command) {
        self.are_local = match &command.key {
            b"CSYS" => !command.field(1).iter().all(|&byte| byte == b'0'),
            b"LOCA" | b"CS  " | b"CLOC" | b"CSKP" => true,
            _ => self.are_local,
        };
    }

    /// A node of a block, the floats of which are its coordinates and then angles; those left out are 0.
    pub fn row<'a>(&mut self, node: u32, mut floats: impl Iterator<Item = &'a [u8]>) {
        if let Some(kept) = &mut self.kept {
            let mut next = || floats.next().and_then(|text| number::real(text).ok()).unwrap_or(0.0);
            kept.insert(node, [next(), next(), next()]);
        }
    }

    /// Coordinates in three fields from `first` on; those of archives are along the model's axes.
    pub fn command(&mut self, node: u32, command: &Command, first: usize, in_archive: bool) {
        let Some(kept) = self.kept.as_mut().filter(|_| in_archive || !self.are_local) else { return };
        let [x, y, z] = [0, 1, 2].map(|k| real(command, first + k).ok());
        if let (Some(x), Some(y), Some(z)) = (x, y, z) {
            kept.insert(node, [x, y, z]);
        }
    }
}

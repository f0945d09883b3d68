//! Node groups and surfaces as their cards give them: lists of numbers of nodes, parts and other groups.

use crate::deck::keyword::line::{KeywordFault, KeywordLine};

/// What a group consists of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum GroupKind {
    Nodes,
    /// Faces.
    Surface,
}

/// What the numbers of a group are.
#[derive(Clone, Debug)]
pub enum Listed {
    Nodes,
    /// First and last node, and the step between nodes if the field is true.
    Ranges(bool),
    /// Groups of the same kind.
    Groups,
    Surfaces,
    /// Parts, or what parts have: the place of the number on the line of the part, from 0.
    Parts(Option<usize>),
    /// Four nodes for each face.
    Segments,
    /// The group is not read. The text is its keyword.
    Unread(String),
}

/// Which faces of parts belong to a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FaceExtent {
    Shells,
    Outside,
    All,
}

/// A group as its card gives it. It consists of what its positive numbers name, without what its negative numbers name.
#[derive(Clone, Debug)]
pub struct GroupSource {
    pub listed: Listed,
    pub extent: FaceExtent,
    pub numbers: Vec<i64>,
}

impl GroupSource {
    /// The group that a card with this keyword defines, without its numbers. `None` for other cards.
    pub fn of(keyword: &str) -> Option<(GroupKind, Self)> {
        let words: Vec<&str> = keyword.split('/').collect();
        let (kind, word) = match words[..] {
            ["GRNOD", word, ..] => (GroupKind::Nodes, word),
            ["SURF", word, ..] => (GroupKind::Surface, word),
            _ => return None,
        };
        let extent = match words.get(2) {
            Some(&"EXT") => FaceExtent::Outside,
            Some(&"ALL") => FaceExtent::All,
            _ => FaceExtent::Shells,
        };
        let listed = match (kind, word) {
            (GroupKind::Nodes, "NODE" | "NODENS") => Listed::Nodes,
            (GroupKind::Nodes, "GENE") => Listed::Ranges(false),
            (GroupKind::Nodes, "GEN_INCR") => Listed::Ranges(true),
            (GroupKind::Nodes, "GRNOD" | "GRNODNS") | (GroupKind::Surface, "SURF") => Listed::Groups,
            (GroupKind::Nodes, "SURF") => Listed::Surfaces,
            (GroupKind::Surface, "SEG") => Listed::Segments,
            (_, "PART") => Listed::Parts(None),
            (_, "PROP") => Listed::Parts(Some(0)),
            (_, "MAT") => Listed::Parts(Some(1)),
            (_, "SUBSET") => Listed::Parts(Some(2)),
            _ => Listed::Unread(format!("/{keyword}")),
        };
        Some((kind, Self { listed, extent, numbers: Vec::new() }))
    }

    /// Adds the numbers on a line.
    pub fn extend(&mut self, line: &KeywordLine) -> Result<(), KeywordFault> {
        let fields = match self.listed {
            Listed::Unread(_) => 0..0,
            // The number of the face comes first. A triangle has no last node.
            Listed::Segments => 1..5,
            Listed::Ranges(true) => 0..3,
            _ => 0..line.count(10),
        };
        let is_fixed = matches!(self.listed, Listed::Segments | Listed::Ranges(_));
        let number = |field| if is_fixed { line.id(field).map(i64::from) } else { line.whole(field) };
        let numbers: Vec<i64> = fields.map(number).collect::<Result<_, _>>()?;
        self.numbers.extend(numbers.into_iter().filter(|number| is_fixed || *number != 0));
        Ok(())
    }
}

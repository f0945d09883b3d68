//! Shapes of elements: their number of nodes, and which of the nodes lie on a face.

use rustc_hash::FxHashMap;

use crate::deck::Problem;
use crate::deck::calculix::model::{ElementDefinition, ScopedName};
use crate::deck::calculix::syntax::{DataLines, Scope};

/// What the reader needs to know of an element type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ElementShape {
    /// Number of nodes. `None` for an unknown type: an element of it continues on the next line after a trailing comma.
    pub nodes: Option<usize>,
    family: ElementFamily,
    /// Whether the nodes have rotational DOFs.
    pub rotates: bool,
    /// Whether the nodes move in the plane of the first two axes only: components 1, 2 and, if they rotate, 6.
    pub is_flat: bool,
}

/// Beams, pipes and trusses in the plane of the first two axes, with the number of their nodes.
const FLAT_BARS: [(&str, usize); 8] =
    [("B21", 2), ("B22", 3), ("B23", 2), ("PIPE21", 2), ("PIPE22", 3), ("FRAME2D", 2), ("T2D2", 2), ("T2D3", 3)];

/// Those in space.
const SPACE_BARS: [(&str, usize); 11] = [
    ("B31", 2),
    ("B32", 3),
    ("B33", 2),
    ("PIPE31", 2),
    ("PIPE32", 3),
    ("ELBOW31", 2),
    ("ELBOW32", 3),
    ("FRAME3D", 2),
    ("T3D2", 2),
    ("T3D3", 3),
    ("FRAME", 2),
];

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ElementFamily {
    Hexahedron,
    Tetrahedron,
    Wedge,
    Shell,
    Plane,
    /// Beams and trusses.
    Bar,
    Other,
}

/// Faces of a solid element: the number of its corners, the corners of each face, and the corners of each edge, all from 0. The middle node
/// of edge k is node `corners + k`.
struct FaceTable {
    corners: usize,
    faces: &'static [&'static [usize]],
    edges: &'static [(usize, usize)],
}

const HEXAHEDRON: FaceTable = FaceTable {
    corners: 8,
    faces: &[&[0, 1, 2, 3], &[4, 7, 6, 5], &[0, 4, 5, 1], &[1, 5, 6, 2], &[2, 6, 7, 3], &[3, 7, 4, 0]],
    edges: &[(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)],
};
const TETRAHEDRON: FaceTable = FaceTable {
    corners: 4,
    faces: &[&[0, 1, 2], &[0, 3, 1], &[1, 3, 2], &[2, 3, 0]],
    edges: &[(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)],
};
const WEDGE: FaceTable = FaceTable {
    corners: 6,
    faces: &[&[0, 1, 2], &[3, 5, 4], &[0, 3, 4, 1], &[1, 4, 5, 2], &[2, 5, 3, 0]],
    edges: &[(0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5)],
};

impl ElementShape {
    /// The shape of an element type such as `C3D20R`.
    pub fn from_type(kind: &str) -> Self {
        let digits = |text: &str| text.chars().take_while(char::is_ascii_digit).collect::<String>().parse().ok();
        let starts = |prefix: &str| kind.strip_prefix(prefix).map(digits);
        let (family, nodes, rotates) =
            if let Some(nodes) = ["C3D", "F3D", "DC3D", "SC", "CSS"].into_iter().find_map(starts) {
                let family = match nodes {
                    Some(8 | 20) => ElementFamily::Hexahedron,
                    Some(4 | 10) => ElementFamily::Tetrahedron,
                    Some(6 | 15) => ElementFamily::Wedge,
                    _ => ElementFamily::Other,
                };
                (family, nodes, false)
            } else if let Some(nodes) = starts("CPS").or_else(|| starts("CPE")).or_else(|| starts("CAX")) {
                (ElementFamily::Plane, nodes, false)
            } else if let Some(nodes) = starts("M3D").or_else(|| starts("SFM3D")) {
                (ElementFamily::Shell, nodes, false)
            } else if let Some(nodes) = starts("S").filter(|_| !kind.starts_with("SPRING")) {
                (ElementFamily::Shell, nodes, true)
            } else {
                let is_beam = ["B", "PIPE", "ELBOW", "FRAME"].iter().any(|beam| kind.starts_with(beam));
                let is_bar = is_beam || ["T2D", "T3D"].iter().any(|truss| kind.starts_with(truss));
                let mut bars = FLAT_BARS.iter().chain(&SPACE_BARS);
                let nodes = bars.find(|(bar, _)| kind.starts_with(bar)).map(|(_, nodes)| *nodes);
                (if is_bar { ElementFamily::Bar } else { ElementFamily::Other }, nodes, is_beam)
            };
        let is_flat = family == ElementFamily::Plane
            || kind.starts_with("SAX")
            || FLAT_BARS.iter().any(|(bar, _)| kind.starts_with(bar));
        Self { nodes, family, rotates, is_flat }
    }

    /// Whether the element is plane, so that its faces are lines.
    pub fn is_plane(&self) -> bool {
        self.family == ElementFamily::Plane
    }

    /// Whether this face is a line: an edge of a plane element, or of a shell.
    pub fn is_line(&self, face: &str) -> bool {
        self.is_plane() || self.is_shell() && shell_edge(face).is_some()
    }

    /// Whether this reader does not know the nodes of this face: those of a free surface, or of an element that has no faces here.
    pub fn has_unknown_face(&self, face: &str) -> bool {
        matches!(face, "" | "EDGE") || matches!(self.family, ElementFamily::Bar | ElementFamily::Other)
    }

    /// Whether the element is a shell or a membrane.
    pub fn is_shell(&self) -> bool {
        self.family == ElementFamily::Shell
    }

    /// Whether ccx expands the element into solids.
    pub fn is_expanded(&self) -> bool {
        matches!(self.family, ElementFamily::Shell | ElementFamily::Plane | ElementFamily::Bar)
    }

    /// The nodes of a face, which is named as in `S3`: its corners in order, then the middle nodes of the edges between them.
    pub fn face(&self, face: &str, nodes: &[u32]) -> Option<Vec<u32>> {
        let number: Option<usize> = face.strip_prefix('S').and_then(|number| number.parse().ok());
        match self.family {
            ElementFamily::Hexahedron => HEXAHEDRON.face(number?, nodes),
            ElementFamily::Tetrahedron => TETRAHEDRON.face(number?, nodes),
            ElementFamily::Wedge => WEDGE.face(number?, nodes),
            ElementFamily::Shell => match (shell_edge(face), face) {
                (Some(number), _) => edge(number, nodes),
                (None, "" | "SPOS" | "SNEG" | "S1" | "S2") => Some(nodes.to_vec()),
                _ => None,
            },
            ElementFamily::Plane => edge(number?, nodes),
            ElementFamily::Bar | ElementFamily::Other => None,
        }
    }
}

impl ElementDefinition {
    /// Visits the elements of a card: `visit` gets the fields of each, first its number and then those of its nodes that are not empty. An
    /// element continues on the next line until it has all of its nodes. `fields` is memory that is used again.
    pub fn each_element<'a>(
        &'a self,
        fields: &mut Vec<&'a [u8]>,
        mut visit: impl FnMut(&[&'a [u8]]) -> Result<(), Problem>,
    ) -> Result<(), Problem> {
        let count = ElementShape::from_type(&self.kind).nodes;
        let mut lines = DataLines::new(&self.data);
        while let Some(mut line) = lines.next() {
            fields.clear();
            fields.extend(line.fields().take(1));
            let mut skipped = 1;
            loop {
                fields.extend(line.fields().skip(skipped).filter(|field| !field.is_empty()));
                skipped = 0;
                let goes_on = line.text.trim_ascii_end().ends_with(b",");
                if !count.map_or(goes_on, |count| fields.len() <= count) {
                    break;
                }
                match lines.next() {
                    Some(next) => line = next,
                    None => break,
                }
            }
            visit(fields)?;
        }
        Ok(())
    }
}

impl FaceTable {
    fn face(&self, number: usize, nodes: &[u32]) -> Option<Vec<u32>> {
        let corners = *self.faces.get(number.checked_sub(1)?)?;
        let mut face: Vec<u32> = corners.iter().map(|&k| nodes.get(k).copied()).collect::<Option<_>>()?;
        if nodes.len() > self.corners {
            let next = corners.iter().cycle().skip(1);
            for (&a, &b) in corners.iter().zip(next) {
                let edge = self.edges.iter().position(|&edge| edge == (a, b) || edge == (b, a))?;
                face.push(*nodes.get(self.corners + edge)?);
            }
        }
        Some(face)
    }
}

/// The number of an edge of a shell: `E1` is the first one in Abaqus, and `S3` in ccx. `None` if the face is no edge.
fn shell_edge(face: &str) -> Option<usize> {
    let edge = face.strip_prefix('E').and_then(|number| number.parse().ok());
    edge.or_else(|| face.strip_prefix('S')?.parse::<usize>().ok()?.checked_sub(2)).filter(|&number| number > 0)
}

/// The nodes of edge `number` of a plane element or of a shell: its two ends and, if it has one, its middle node.
fn edge(number: usize, nodes: &[u32]) -> Option<Vec<u32>> {
    let corners = if matches!(nodes.len(), 3 | 6) { 3 } else { 4 };
    let first = number.checked_sub(1).filter(|&k| k < corners)?;
    let mut edge = vec![*nodes.get(first)?, *nodes.get((first + 1) % corners)?];
    edge.extend(nodes.get(corners + first));
    Some(edge)
}

/// All elements with their shapes and nodes.
#[derive(Default)]
pub struct MeshElements {
    pub nodes: Vec<u32>,
    /// For each element, its shape and the range of its nodes in `nodes`.
    pub all: Vec<(ElementShape, usize, usize)>,
    pub by_number: FxHashMap<(Scope, u32), u32>,
    /// The elements of each set that an `*ELEMENT` card names.
    pub by_set: FxHashMap<ScopedName, Vec<u32>>,
}

impl MeshElements {
    /// The index of the element with number `own` in the scope.
    pub fn index(&self, scope: Scope, own: u32) -> Result<u32, Problem> {
        let undefined = || Problem::Undefined { what: "element", name: own.to_string() };
        self.by_number.get(&(scope, own)).copied().ok_or_else(undefined)
    }

    /// The nodes of each beam and truss.
    pub fn bars(&self) -> impl Iterator<Item = &[u32]> {
        let bars = self.all.iter().filter(|(shape, ..)| shape.family == ElementFamily::Bar);
        bars.map(|&(_, start, end)| &self.nodes[start..end])
    }

    /// The nodes of an element.
    pub fn nodes(&self, element: u32) -> &[u32] {
        let (_, start, end) = self.all[element as usize];
        &self.nodes[start..end]
    }

    /// The shape of an element.
    pub fn shape(&self, element: u32) -> ElementShape {
        self.all[element as usize].0
    }
}

#[cfg(test)]
mod tests {
    use super::ElementShape;

    #[test]
    fn faces_go_round_their_corners_and_then_their_middles() {
        let nodes: Vec<u32> = (1..=20).collect();
        assert_eq!(ElementShape::from_type("C3D20R").face("S4", &nodes), Some(vec![2, 6, 7, 3, 18, 14, 19, 10]));
        assert_eq!(ElementShape::from_type("C3D8").face("S6", &nodes[..8]), Some(vec![4, 8, 5, 1]));
        assert_eq!(ElementShape::from_type("C3D10").face("S2", &nodes[..10]), Some(vec![1, 4, 2, 8, 9, 5]));
        assert_eq!(ElementShape::from_type("CPS4").face("S4", &nodes[..4]), Some(vec![4, 1]));
        assert_eq!(ElementShape::from_type("C3D8").face("S7", &nodes[..8]), None);
        assert!(
            ElementShape::from_type("S8R").rotates
                && ElementShape::from_type("B32R").nodes == Some(3)
                && !ElementShape::from_type("T3D2").rotates
        );
        let expands = |kind| ElementShape::from_type(kind).is_expanded();
        assert!(["S3", "M3D4", "CPS4R", "CAX8", "B31R", "T3D2"].into_iter().all(expands));
        assert!(!["C3D8", "SPRINGA", "DCOUP3D", "MASS", "GAPUNI"].into_iter().any(expands));
    }
}

//! The elements of each part: their nodes, their faces, and which nodes have rotations.

use rustc_hash::{FxHashMap, FxHashSet};

use super::group::Gap;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ElementKind {
    Solid,
    Shell,
    Beam,
    /// Without rotations and without faces, such as a truss.
    Link,
}

/// An element.
#[derive(Clone, Debug)]
pub struct KeywordElement {
    pub kind: ElementKind,
    pub nodes: Vec<u32>,
}

/// The elements of a deck by their part.
#[derive(Default)]
pub struct ElementStore {
    parts: FxHashMap<u32, Vec<KeywordElement>>,
    /// A keyword that defines elements but is not read; then the nodes of parts are not known.
    unread: Option<String>,
    of_solids: FxHashSet<u32>,
    of_others: FxHashSet<u32>,
}

impl ElementStore {
    pub fn add(&mut self, part: u32, element: KeywordElement) {
        let has_rotations = matches!(element.kind, ElementKind::Shell | ElementKind::Beam);
        let users = if has_rotations { &mut self.of_others } else { &mut self.of_solids };
        users.extend(&element.nodes);
        self.parts.entry(part).or_default().push(element);
    }

    /// Records that cards with this keyword define elements, but are not read.
    pub fn leave_out(&mut self, keyword: String) {
        self.unread = Some(keyword);
    }

    /// The elements of these parts.
    pub fn of(&self, parts: &[u32]) -> Result<Vec<&KeywordElement>, Gap> {
        match &self.unread {
            Some(keyword) => Err(Gap::Unread(format!("needs the nodes of a part, and {keyword} is not read"))),
            None => Ok(parts.iter().filter_map(|part| self.parts.get(part)).flatten().collect()),
        }
    }

    /// The nodes of these parts, ascending, each once.
    pub fn nodes_of(&self, parts: &[u32]) -> Result<Vec<u32>, Gap> {
        let elements = self.of(parts)?;
        let mut nodes: Vec<u32> = elements.into_iter().flat_map(|element| &element.nodes).copied().collect();
        nodes.sort_unstable();
        nodes.dedup();
        Ok(nodes)
    }

    pub fn has_shells(&self) -> bool {
        self.parts.values().flatten().any(|element| element.kind == ElementKind::Shell)
    }

    /// Whether a node has rotations. It has them if it belongs to a shell or a beam, or to no element.
    pub fn rotates(&self, node: u32) -> bool {
        self.of_others.contains(&node) || !self.of_solids.contains(&node)
    }
}

/// The faces of shells, and those faces of solids that belong to only one of these solids.
pub fn outside(elements: &[&KeywordElement]) -> Vec<Vec<u32>> {
    let mut faces = solid_faces(elements);
    let key = |face: &Vec<u32>| {
        let mut key = face.clone();
        key.sort_unstable();
        key
    };
    let mut users = FxHashMap::<Vec<u32>, usize>::default();
    faces.iter().for_each(|face| *users.entry(key(face)).or_default() += 1);
    faces.retain(|face| users[&key(face)] == 1);
    faces.extend(shell_faces(elements));
    faces
}

/// The faces of shells.
pub fn shell_faces(elements: &[&KeywordElement]) -> Vec<Vec<u32>> {
    let shells = elements.iter().filter(|one| one.kind == ElementKind::Shell);
    shells.map(|shell| distinct(&shell.nodes[..shell.nodes.len().min(4)])).collect()
}

/// All faces of solids.
pub fn solid_faces(elements: &[&KeywordElement]) -> Vec<Vec<u32>> {
    const SIDES: [[usize; 4]; 6] = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];
    let mut faces = Vec::new();
    for element in elements.iter().filter(|one| one.kind == ElementKind::Solid && one.nodes.len() > 3) {
        let nodes = &element.nodes;
        // Index of the last corner. A tetrahedron repeats its last corner, unless it has ten nodes, of which four are corners.
        let last = if nodes.len() == 10 { 3 } else { nodes.len().min(8) - 1 };
        let sides = SIDES.iter().map(|side| distinct(&side.map(|k| nodes[k.min(last)])));
        faces.extend(sides.filter(|side| side.len() > 2));
    }
    faces
}

/// The nodes of a face, each once: a triangle has its last node twice.
pub fn distinct(face: &[u32]) -> Vec<u32> {
    let mut nodes: Vec<u32> = Vec::with_capacity(face.len());
    for node in face {
        if !nodes.contains(node) {
            nodes.push(*node);
        }
    }
    nodes
}

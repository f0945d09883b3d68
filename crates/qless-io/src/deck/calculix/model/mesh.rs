//! Parses the text of `*ELEMENT` and `*SURFACE` cards, and finds the elements at a node.

use rustc_hash::FxHashMap;

use crate::deck::Problem;
use crate::deck::calculix::model::elements::{ElementShape, MeshElements};
use crate::deck::calculix::model::{DeckDefinitions, ElementDefinition, folded};
use crate::deck::calculix::syntax::parameters::undefined;
use crate::deck::calculix::syntax::{DataLines, Scope, fold_name, number};
use crate::fault::quote;

impl DeckDefinitions {
    /// Parses the `*ELEMENT` cards. Each element is a number followed by its nodes, on as many lines as needed.
    pub fn parse_elements(&self) -> Result<MeshElements, Problem> {
        let (mut elements, mut fields) = (MeshElements::default(), Vec::new());
        for block in &self.blocks {
            let shape = ElementShape::from_type(&block.kind);
            block.each_element(&mut fields, |fields| {
                let own = number(fields[0], "an element")?;
                let start = elements.nodes.len();
                for field in &fields[1..] {
                    elements.nodes.push(self.node(block.scope, field)?);
                }
                let index = elements.all.len() as u32;
                elements.all.push((shape, start, elements.nodes.len()));
                elements.by_number.insert((block.scope, own), index);
                if let Some(set) = &block.set {
                    elements.by_set.entry((block.scope, set.clone())).or_default().push(index);
                }
                Ok(())
            })?;
        }
        Ok(elements)
    }

    /// Whether a node belongs to an element whose nodes have rotations.
    pub fn rotates(&self, node: u32) -> bool {
        self.expanded_at(node).iter().any(|shape| shape.rotates)
    }

    /// Whether a node belongs to a plane element or to a beam or truss in the plane, and so has no third component.
    pub fn is_flat(&self, node: u32) -> bool {
        self.expanded_at(node).iter().any(|shape| self.is_flat_shape(shape))
    }

    /// ccx takes beams and trusses in the plane as those in space.
    fn is_flat_shape(&self, shape: &ElementShape) -> bool {
        shape.is_plane() || self.is_abaqus && shape.is_flat
    }

    /// Whether the nodes of an element at this node have the rotation `component`, from 4 to 6. In the plane, this is 6.
    pub fn rotates_about(&self, node: u32, component: u8) -> bool {
        self.expanded_at(node).iter().any(|shape| shape.rotates && (component == 6 || !self.is_flat_shape(shape)))
    }

    /// The components of a node: two or three translations, and the rotations that it has if `rotates`.
    pub fn components(&self, node: u32, rotates: bool) -> Vec<u8> {
        let last = if self.is_flat(node) { 2 } else { 3 };
        let rotations = (4..=6).filter(|&component| rotates && self.rotates_about(node, component));
        (1..=last).chain(rotations).collect()
    }

    /// Shapes of those elements at a node that ccx expands into solids. All elements with rotations are among them.
    pub fn expanded_at(&self, node: u32) -> &[ElementShape] {
        let find = || {
            let mut all: FxHashMap<u32, Vec<ElementShape>> = FxHashMap::default();
            let shape = |block: &ElementDefinition| ElementShape::from_type(&block.kind);
            let mut fields = Vec::new();
            for block in self.blocks.iter().filter(|block| shape(block).is_expanded()) {
                // The visitor cannot fail.
                _ = block.each_element(&mut fields, |fields| {
                    for node in fields.iter().skip(1).filter_map(|field| self.node(block.scope, field).ok()) {
                        let shapes = all.entry(node).or_default();
                        if shapes.last() != Some(&shape(block)) {
                            shapes.push(shape(block));
                        }
                    }
                    Ok(())
                });
            }
            all
        };
        self.expanded.get_or_init(find).get(&node).map_or(&[], Vec::as_slice)
    }
}

/// A surface: single nodes and faces, where a face is a list of nodes.
#[derive(Default)]
pub struct DeckSurface {
    pub nodes: Vec<u32>,
    pub faces: Vec<Vec<u32>>,
    /// The element of each face.
    pub elements: Vec<u32>,
    /// Whether the faces are edges of plane elements or of shells.
    pub is_line: bool,
    /// Whether some faces belong to shells or membranes.
    pub has_shells: bool,
}

impl DeckSurface {
    /// All nodes of the surface, ascending, each once.
    pub fn all_nodes(&self) -> Vec<u32> {
        let mut nodes: Vec<u32> = self.nodes.iter().chain(self.faces.iter().flatten()).copied().collect();
        nodes.sort_unstable();
        nodes.dedup();
        nodes
    }

    /// Finds a surface by its name. The lines of its cards hold nodes or node sets, or `element or set, face`.
    pub fn find(definitions: &DeckDefinitions, scope: Scope, surface: &str) -> Result<Self, Problem> {
        let surface = fold_name(surface);
        let Some((_, patches)) = definitions.find(&definitions.surfaces, scope, &surface) else {
            return Err(undefined("surface", surface));
        };
        let mut found = Self::default();
        for patch in patches {
            for line in DataLines::new(&patch.data) {
                let mut fields = line.fields();
                let first = fields.next().unwrap_or_default();
                if patch.of_nodes {
                    found.nodes.extend(definitions.node_or_set(patch.scope, first)?);
                } else {
                    found.add_faces(definitions, patch.scope, first, &folded(fields.next().unwrap_or_default()))?;
                }
            }
        }
        Ok(found)
    }

    fn add_faces(&mut self, of: &DeckDefinitions, scope: Scope, elements: &[u8], face: &str) -> Result<(), Problem> {
        for element in of.element_or_set(scope, elements)? {
            let shape = of.elements()?.shape(element);
            let name = || format!("{face} of {}", String::from_utf8_lossy(elements));
            let Some(nodes) = shape.face(face, of.elements()?.nodes(element)) else {
                return Err(if shape.has_unknown_face(face) {
                    Problem::NotFollowed { what: format!("the face {}", name()) }
                } else {
                    Problem::Expected { expected: "a face that the element has", found: quote(name().as_bytes()) }
                });
            };
            let is_line = shape.is_line(face);
            if is_line != self.is_line && !self.faces.is_empty() {
                return Err(Problem::NotFollowed { what: format!("a surface of edges and faces, such as {}", name()) });
            }
            self.is_line = is_line;
            self.has_shells |= shape.is_shell();
            self.faces.push(nodes);
            self.elements.push(element);
        }
        Ok(())
    }
}

//! Positions, elements and surfaces, parsed where a card needs geometry.

use rustc_hash::FxHashMap;

use crate::deck::Problem;
use crate::deck::calculix::model::definitions::{Definitions, Key, word};
use crate::deck::calculix::model::parts::Scope;
use crate::deck::calculix::model::shape::Shape;
use crate::deck::calculix::syntax::data::{Lines, name};
use crate::deck::calculix::syntax::fields::{float, number};
use crate::deck::kinematics::vector::Vector;
use crate::fault::quote;

/// Elements: what they are and where their nodes stand.
#[derive(Default)]
pub struct Elements {
    nodes: Vec<u32>,
    /// Shape, and where its nodes begin and end.
    all: Vec<(Shape, usize, usize)>,
    by_number: FxHashMap<(Scope, u32), u32>,
    /// Elements of the sets that `*ELEMENT` cards name.
    pub by_set: FxHashMap<Key, Vec<u32>>,
}

impl Elements {
    /// The element with this number in the scope.
    pub fn index(&self, scope: Scope, own: u32) -> Result<u32, Problem> {
        let undefined = || Problem::Undefined { what: "element", name: own.to_string() };
        self.by_number.get(&(scope, own)).copied().ok_or_else(undefined)
    }

    /// The nodes of an element.
    pub fn nodes(&self, element: u32) -> &[u32] {
        let (_, start, end) = self.all[element as usize];
        &self.nodes[start..end]
    }

    /// The shape of an element.
    pub fn shape(&self, element: u32) -> Shape {
        self.all[element as usize].0
    }

    /// Parses `*ELEMENT` cards: a number and its nodes, on as many lines as they take.
    pub fn parse(definitions: &Definitions) -> Result<Self, Problem> {
        let mut elements = Self::default();
        for block in &definitions.blocks {
            let shape = Shape::of(&block.kind);
            let mut lines = Lines::new(&block.data);
            while let Some(line) = lines.next() {
                let mut fields = line.fields();
                let own = number(fields.next().unwrap_or_default(), "an element")?;
                let start = elements.nodes.len();
                elements.add(definitions, block.scope, fields)?;
                let mut goes_on = line.text.trim_ascii_end().ends_with(b",");
                while shape.nodes.map_or(goes_on, |count| elements.nodes.len() < start + count) {
                    let Some(line) = lines.next() else { break };
                    goes_on = line.text.trim_ascii_end().ends_with(b",");
                    elements.add(definitions, block.scope, line.fields())?;
                }
                let index = elements.all.len() as u32;
                elements.all.push((shape, start, elements.nodes.len()));
                elements.by_number.insert((block.scope, own), index);
                if let Some(set) = &block.set {
                    elements.by_set.entry((block.scope, set.clone())).or_default().push(index);
                }
            }
        }
        Ok(elements)
    }

    fn add<'a>(
        &mut self,
        definitions: &Definitions,
        scope: Scope,
        fields: impl Iterator<Item = &'a [u8]>,
    ) -> Result<(), Problem> {
        for field in fields.filter(|field| !field.is_empty()) {
            self.nodes.push(definitions.node(scope, field)?);
        }
        Ok(())
    }
}

/// Positions by node.
pub fn positions(lines: Lines) -> Result<FxHashMap<u32, Vector>, Problem> {
    let mut positions = FxHashMap::default();
    for line in lines {
        let mut fields = line.fields();
        let node = number(fields.next().unwrap_or_default(), "a node")?;
        let mut next = || fields.next().filter(|field| !field.is_empty()).map_or(Ok(0.0), float);
        positions.insert(node, [next()?, next()?, next()?]);
    }
    Ok(positions)
}

/// A surface: nodes by themselves, and faces.
#[derive(Default)]
pub struct Surface {
    pub nodes: Vec<u32>,
    pub faces: Vec<Vec<u32>>,
    /// Whether the faces are edges of plane elements.
    pub is_line: bool,
}

impl Surface {
    /// All nodes, ascending, each once.
    pub fn all_nodes(&self) -> Vec<u32> {
        let mut nodes: Vec<u32> = self.nodes.iter().chain(self.faces.iter().flatten()).copied().collect();
        nodes.sort_unstable();
        nodes.dedup();
        nodes
    }

    /// The surface of this name: nodes or sets of them, or `element or set, face`.
    pub fn find(definitions: &Definitions, scope: Scope, surface: &str) -> Result<Self, Problem> {
        let surface = name(surface);
        let Some((_, patches)) = definitions.find(&definitions.surfaces, scope, &surface) else {
            return Err(Problem::Undefined { what: "surface", name: surface });
        };
        let mut found = Self::default();
        for patch in patches {
            for line in Lines::new(&patch.data) {
                let mut fields = line.fields();
                let first = fields.next().unwrap_or_default();
                if patch.of_nodes {
                    found.nodes.extend(definitions.node_or_set(patch.scope, first)?);
                } else {
                    found.add_faces(definitions, patch.scope, first, &word(fields.next().unwrap_or_default()))?;
                }
            }
        }
        Ok(found)
    }

    fn add_faces(&mut self, of: &Definitions, scope: Scope, elements: &[u8], face: &str) -> Result<(), Problem> {
        for element in of.element_or_set(scope, elements)? {
            let shape = of.elements()?.shape(element);
            let nodes = shape.face(face, of.elements()?.nodes(element)).ok_or_else(|| Problem::Expected {
                expected: "a face that the element has",
                found: quote(format!("{face} of {}", String::from_utf8_lossy(elements)).as_bytes()),
            })?;
            self.is_line |= shape.is_plane();
            self.faces.push(nodes);
        }
        Ok(())
    }
}

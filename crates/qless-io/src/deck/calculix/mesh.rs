//! Positions, elements and surfaces, parsed where a card needs geometry.

use rustc_hash::FxHashMap;

use super::data::{Lines, name};
use super::definitions::{Block, Definitions};
use super::fields::{float, number};
use super::shape::Shape;
use crate::deck::Problem;
use crate::deck::kinematics::vector::Vector;
use crate::fault::quote;

/// Elements: what they are and where their nodes stand.
#[derive(Default)]
pub struct Elements {
    nodes: Vec<u32>,
    by_number: FxHashMap<u32, (Shape, usize, usize)>,
    /// Elements of the sets that `*ELEMENT` cards name.
    pub by_set: FxHashMap<String, Vec<u32>>,
}

impl Elements {
    /// The shape and the nodes of an element.
    pub fn get(&self, element: u32) -> Result<(Shape, &[u32]), Problem> {
        let undefined = || Problem::Undefined { what: "element", name: element.to_string() };
        let &(shape, start, end) = self.by_number.get(&element).ok_or_else(undefined)?;
        Ok((shape, &self.nodes[start..end]))
    }

    /// Parses `*ELEMENT` cards: a number and its nodes, on as many lines as they take.
    pub fn parse(blocks: &[Block]) -> Result<Self, Problem> {
        let mut elements = Self::default();
        for block in blocks {
            let shape = Shape::of(&block.kind);
            let mut lines = Lines::new(&block.data);
            while let Some(line) = lines.next() {
                let mut fields = line.fields();
                let element = number(fields.next().unwrap_or_default(), "an element")?;
                let start = elements.nodes.len();
                elements.add(fields)?;
                let mut goes_on = line.text.trim_ascii_end().ends_with(b",");
                while shape.nodes.map_or(goes_on, |count| elements.nodes.len() < start + count) {
                    let Some(line) = lines.next() else { break };
                    goes_on = line.text.trim_ascii_end().ends_with(b",");
                    elements.add(line.fields())?;
                }
                elements.by_number.insert(element, (shape, start, elements.nodes.len()));
                if let Some(set) = &block.set {
                    elements.by_set.entry(set.clone()).or_default().push(element);
                }
            }
        }
        Ok(elements)
    }

    fn add<'a>(&mut self, fields: impl Iterator<Item = &'a [u8]>) -> Result<(), Problem> {
        for field in fields.filter(|field| !field.is_empty()) {
            self.nodes.push(number(field, "a node of an element")?);
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
    pub fn find(definitions: &Definitions, surface: &str) -> Result<Self, Problem> {
        let surface = name(surface);
        let Some(cards) = definitions.surfaces.get(&surface) else {
            return Err(Problem::Undefined { what: "surface", name: surface });
        };
        let mut found = Self::default();
        for (of_nodes, pieces) in cards {
            for line in Lines::new(pieces) {
                let mut fields = line.fields();
                let first = fields.next().unwrap_or_default();
                if *of_nodes {
                    found.nodes.extend(definitions.node_or_set(first)?);
                    continue;
                }
                let face = name(&String::from_utf8_lossy(fields.next().unwrap_or_default()));
                for element in definitions.element_or_set(first)? {
                    let (shape, nodes) = definitions.elements()?.get(element)?;
                    let face = shape.face(&face, nodes).ok_or_else(|| Problem::Expected {
                        expected: "a face that the element has",
                        found: quote(format!("{face} of element {element}").as_bytes()),
                    })?;
                    found.is_line |= shape.is_plane();
                    found.faces.push(face);
                }
            }
        }
        Ok(found)
    }
}

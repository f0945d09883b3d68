//! Finds the nodes and faces of a group. This is done when a constraint uses the group, because it may name groups that the deck defines
//! later.

use rustc_hash::{FxHashMap, FxHashSet};

use super::groups::{FaceExtent, GroupKind, GroupSource, Listed};
use super::mesh::RadiossMesh;
use crate::deck::Problem;
use crate::deck::keyword::elements::{distinct, outside, shell_faces, solid_faces};
use crate::deck::keyword::group::Gap;
use crate::deck::keyword::line::{FieldLayout, FieldWidth, KeywordLine, Parameters};

/// Deepest nesting of groups.
const DEPTH: usize = 100;

/// Resolves the groups that a field of a line names, directly or through other groups.
struct GroupResolver<'a> {
    mesh: &'a RadiossMesh,
    line: &'a KeywordLine<'a>,
    field: usize,
    /// The groups that are being resolved, the outermost first.
    open: Vec<(GroupKind, u32)>,
    nodes: FxHashMap<u32, Vec<u32>>,
    faces: FxHashMap<u32, Vec<Vec<u32>>>,
}

impl RadiossMesh {
    /// The nodes of the group that a field names, each once.
    pub fn group_nodes(&self, line: &KeywordLine, field: usize) -> Result<Vec<u32>, Gap> {
        GroupResolver::new(self, line, field).nodes(line.id(field)?)
    }

    /// The faces of the surface that a field names.
    pub fn surface(&self, line: &KeywordLine, field: usize) -> Result<Vec<Vec<u32>>, Gap> {
        GroupResolver::new(self, line, field).faces(line.id(field)?)
    }

    /// The nodes of the group with this number; `None` if there is none, or if it is not read.
    pub fn nodes_of_group(&self, id: u32) -> Option<Vec<u32>> {
        let parameters = Parameters::default();
        let layout = FieldLayout::Common;
        let line = KeywordLine { number: 0, text: b"", width: FieldWidth::Columns, layout, parameters: &parameters };
        GroupResolver::new(self, &line, 0).nodes(id).ok()
    }
}

impl<'a> GroupResolver<'a> {
    fn new(mesh: &'a RadiossMesh, line: &'a KeywordLine, field: usize) -> Self {
        Self { mesh, line, field, open: Vec::new(), nodes: FxHashMap::default(), faces: FxHashMap::default() }
    }

    /// The group with this number, which is opened.
    fn open(&mut self, kind: GroupKind, id: u32) -> Result<&'a GroupSource, Gap> {
        let what = if kind == GroupKind::Nodes { "node group" } else { "surface" };
        let fault = |problem| Err(self.line.fault_at(self.field, problem).into());
        if self.open.contains(&(kind, id)) {
            return fault(Problem::Circular { what, name: id.to_string() });
        }
        if self.open.len() == DEPTH {
            return fault(Problem::Limit { what: "the depth of groups", limit: DEPTH, advice: "name their members" });
        }
        let undefined = || self.mesh.undefined(self.line, self.field, what, id);
        let source = self.mesh.groups.get(&(kind, id)).ok_or_else(undefined)?;
        if let Listed::Unread(keyword) = &source.listed {
            return Err(Gap::Unread(format!("uses {what} {id}, which {keyword} defines")));
        }
        self.open.push((kind, id));
        Ok(source)
    }

    fn nodes(&mut self, id: u32) -> Result<Vec<u32>, Gap> {
        if let Some(known) = self.nodes.get(&id) {
            return Ok(known.clone());
        }
        let source = self.open(GroupKind::Nodes, id)?;
        let of = |number: i64| number.unsigned_abs() as u32;
        let mut seen: FxHashSet<u32> = FxHashSet::default();
        for &number in source.numbers.iter().filter(|number| **number < 0) {
            seen.extend(self.nodes_named(source, of(number))?);
        }
        let mut nodes =
            if let Listed::Ranges(has_step) = source.listed { self.between(source, has_step) } else { Vec::new() };
        let is_range = matches!(source.listed, Listed::Ranges(_));
        for &number in source.numbers.iter().filter(|number| **number > 0 && !is_range) {
            nodes.extend(self.nodes_named(source, of(number))?);
        }
        nodes.retain(|node| seen.insert(*node));
        self.open.pop();
        self.nodes.insert(id, nodes.clone());
        Ok(nodes)
    }

    /// The nodes that one number of a group names.
    fn nodes_named(&mut self, source: &GroupSource, number: u32) -> Result<Vec<u32>, Gap> {
        match &source.listed {
            Listed::Groups => self.nodes(number),
            Listed::Surfaces => Ok(self.faces(number)?.concat()),
            Listed::Parts(place) => self.mesh.elements.nodes_of(&self.parts(*place, number)),
            _ if self.mesh.nodes.contains_key(&number) => Ok(vec![number]),
            _ => Err(self.mesh.undefined(self.line, self.field, "node", number)),
        }
    }

    /// The nodes in ranges of numbers, ascending.
    fn between(&self, source: &GroupSource, has_step: bool) -> Vec<u32> {
        let ranges: Vec<&[i64]> = source.numbers.chunks(if has_step { 3 } else { 2 }).collect();
        let is_inside = |node: &u32| {
            let node = i64::from(*node);
            let is_in = |range: &&[i64]| match **range {
                [first, last] => first <= node && node <= last,
                [first, last, step] => first <= node && node <= last && (node - first) % step.max(1) == 0,
                _ => false,
            };
            ranges.iter().any(is_in)
        };
        let mut nodes: Vec<u32> = self.mesh.nodes.keys().copied().filter(is_inside).collect();
        nodes.sort_unstable();
        nodes
    }

    fn faces(&mut self, id: u32) -> Result<Vec<Vec<u32>>, Gap> {
        if let Some(known) = self.faces.get(&id) {
            return Ok(known.clone());
        }
        let source = self.open(GroupKind::Surface, id)?;
        let of = |number: &i64| number.unsigned_abs() as u32;
        let mut faces = Vec::new();
        match source.listed {
            Listed::Segments => {
                let corners = |face: &[i64]| face.iter().filter(|node| **node != 0).map(of).collect::<Vec<_>>();
                faces.extend(source.numbers.chunks(4).map(|face| distinct(&corners(face))));
            }
            Listed::Groups => {
                for number in &source.numbers {
                    faces.extend(self.faces(of(number))?);
                }
            }
            Listed::Parts(place) => {
                let named = |number: &i64| self.parts(place, of(number));
                let without: FxHashSet<u32> = source.numbers.iter().filter(|n| **n < 0).flat_map(named).collect();
                let parts = source.numbers.iter().filter(|n| **n > 0).flat_map(named);
                faces.extend(
                    self.sides(&parts.filter(|part| !without.contains(part)).collect::<Vec<_>>(), source.extent)?,
                );
            }
            _ => {}
        }
        self.open.pop();
        self.faces.insert(id, faces.clone());
        Ok(faces)
    }

    fn sides(&self, parts: &[u32], extent: FaceExtent) -> Result<Vec<Vec<u32>>, Gap> {
        let elements = self.mesh.elements.of(parts)?;
        Ok(match extent {
            FaceExtent::Shells => shell_faces(&elements),
            FaceExtent::Outside => outside(&elements),
            FaceExtent::All => [solid_faces(&elements), shell_faces(&elements)].concat(),
        })
    }

    /// The parts that a number names, ascending. A subset has the parts of the subsets in it.
    fn parts(&self, place: Option<usize>, number: u32) -> Vec<u32> {
        let Some(place) = place else { return vec![number] };
        let mut names = vec![number];
        let mut next = 0;
        while place == 2 && next < names.len() {
            let inner = self.mesh.subsets.get(&names[next]).into_iter().flatten();
            let new: Vec<u32> = inner.copied().filter(|subset| !names.contains(subset)).collect();
            names.extend(new);
            next += 1;
        }
        let own = self.mesh.parts.iter().filter(|(_, numbers)| names.contains(&numbers[place]));
        let mut parts: Vec<u32> = own.map(|(&part, _)| part).collect();
        parts.sort_unstable();
        parts
    }
}

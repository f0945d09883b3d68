//! Finds the nodes and faces of a group. This is done when a constraint uses the group, because it may name groups that the deck defines
//! later.

use std::rc::Rc;

use rustc_hash::{FxHashMap, FxHashSet};

use super::groups::{FaceExtent, GroupKind, GroupSource, Listed};
use super::mesh::RadiossMesh;
use crate::deck::Problem;
use crate::deck::keyword::elements::{distinct, outside, shell_faces, solid_faces};
use crate::deck::keyword::group::Gap;
use crate::deck::keyword::line::{FieldLayout, FieldWidth, KeywordLine, Parameters};
use crate::deck::limits::MEMBERS;

/// Deepest nesting of groups.
const DEPTH: usize = 100;

/// The members of the groups that are resolved, by the number of the group.
type ResolvedMembers<T> = FxHashMap<u32, Rc<[T]>>;

/// Resolves the groups that a field of a line names, directly or through other groups.
struct GroupResolver<'a> {
    mesh: &'a RadiossMesh,
    line: &'a KeywordLine<'a>,
    field: usize,
    /// The groups that are being resolved, the outermost first.
    open: Vec<(GroupKind, u32)>,
    nodes: ResolvedMembers<u32>,
    faces: ResolvedMembers<Vec<u32>>,
    /// The number of members that were gathered, each as often as it was.
    gathered: usize,
}

impl RadiossMesh {
    /// The nodes of the group that a field names, each once.
    pub fn group_nodes(&self, line: &KeywordLine, field: usize) -> Result<Vec<u32>, Gap> {
        Ok(GroupResolver::new(self, line, field).nodes(line.id(field)?)?.to_vec())
    }

    /// The faces of the surface that a field names.
    pub fn surface(&self, line: &KeywordLine, field: usize) -> Result<Vec<Vec<u32>>, Gap> {
        Ok(GroupResolver::new(self, line, field).faces(line.id(field)?)?.to_vec())
    }

    /// The nodes of the group with this number; `None` if there is none, or if it is not read.
    pub fn nodes_of_group(&self, id: u32) -> Option<Vec<u32>> {
        let parameters = Parameters::default();
        let layout = FieldLayout::Common;
        let line = KeywordLine { number: 0, text: b"", width: FieldWidth::Columns, layout, parameters: &parameters };
        GroupResolver::new(self, &line, 0).nodes(id).ok().map(|nodes| nodes.to_vec())
    }
}

impl<'a> GroupResolver<'a> {
    fn new(mesh: &'a RadiossMesh, line: &'a KeywordLine, field: usize) -> Self {
        let (nodes, faces) = (ResolvedMembers::default(), ResolvedMembers::default());
        Self { mesh, line, field, open: Vec::new(), nodes, faces, gathered: 0 }
    }

    fn fault<T>(&self, problem: Problem) -> Result<T, Gap> {
        Err(self.line.fault_at(self.field, problem).into())
    }

    /// The group with this number, which is opened.
    fn open(&mut self, kind: GroupKind, id: u32) -> Result<&'a GroupSource, Gap> {
        let what = if kind == GroupKind::Nodes { "node group" } else { "surface" };
        if self.open.contains(&(kind, id)) {
            return self.fault(Problem::Circular { what, name: id.to_string() });
        }
        if self.open.len() == DEPTH {
            let what = "the depth of groups";
            return self.fault(Problem::Limit { what, limit: DEPTH, advice: "name their members" });
        }
        let undefined = || self.mesh.undefined(self.line, self.field, what, id);
        let source = self.mesh.groups.get(&(kind, id)).ok_or_else(undefined)?;
        if let Listed::Unread(keyword) = &source.listed {
            return Err(Gap::Unread(format!("uses {what} {id}, which {keyword} defines")));
        }
        self.open.push((kind, id));
        Ok(source)
    }

    /// Counts members, because groups of groups multiply them.
    fn gather<T>(&mut self, members: Vec<T>) -> Result<Vec<T>, Gap> {
        self.gathered += members.len();
        if self.gathered > MEMBERS {
            let (what, advice) = ("the number of members of groups", "name fewer groups in groups");
            return self.fault(Problem::Limit { what, limit: MEMBERS, advice });
        }
        Ok(members)
    }

    fn nodes(&mut self, id: u32) -> Result<Rc<[u32]>, Gap> {
        if let Some(known) = self.nodes.get(&id) {
            return Ok(Rc::clone(known));
        }
        let source = self.open(GroupKind::Nodes, id)?;
        let [added, removed] = split(source);
        let mut seen: FxHashSet<u32> = self.nodes_named(source, &removed)?.into_iter().collect();
        let mut nodes = self.nodes_named(source, &added)?;
        nodes.retain(|node| seen.insert(*node));
        self.open.pop();
        let nodes: Rc<[u32]> = nodes.into();
        self.nodes.insert(id, Rc::clone(&nodes));
        Ok(nodes)
    }

    /// The nodes that some numbers of a group name.
    fn nodes_named(&mut self, source: &GroupSource, numbers: &[u32]) -> Result<Vec<u32>, Gap> {
        let mut nodes = Vec::new();
        match source.listed {
            Listed::Groups => {
                for &group in numbers {
                    let members = self.nodes(group)?;
                    nodes.extend(self.gather(members.to_vec())?);
                }
            }
            Listed::Surfaces => {
                for &surface in numbers {
                    let faces = self.faces(surface)?;
                    nodes.extend(self.gather(faces.concat())?);
                }
            }
            Listed::Parts(place) => nodes = self.mesh.elements.nodes_of(&self.parts(place, numbers))?,
            Listed::Ranges(has_step) => nodes = self.between(numbers.chunks(if has_step { 3 } else { 2 }))?,
            _ => nodes.extend(numbers),
        }
        match nodes.iter().find(|node| !self.mesh.nodes.contains_key(node)) {
            Some(&node) => Err(self.mesh.undefined(self.line, self.field, "node", node)),
            None => Ok(nodes),
        }
    }

    /// The nodes in ranges of numbers: the first one, the last one and, if there is one, the step.
    fn between<'b>(&mut self, ranges: impl Iterator<Item = &'b [u32]>) -> Result<Vec<u32>, Gap> {
        let mut all: Vec<u32> = self.mesh.nodes.keys().copied().collect();
        all.sort_unstable();
        let mut nodes = Vec::new();
        for range in ranges {
            let (first, last) = (range[0], range.get(1).copied().unwrap_or_default());
            let step = range.get(2).map_or(1, |step| (*step).max(1));
            let inside = &all[all.partition_point(|node| *node < first)..];
            let inside = inside.iter().take_while(|node| **node <= last).copied();
            nodes.extend(self.gather(inside.filter(|node| (node - first) % step == 0).collect())?);
        }
        Ok(nodes)
    }

    fn faces(&mut self, id: u32) -> Result<Rc<[Vec<u32>]>, Gap> {
        if let Some(known) = self.faces.get(&id) {
            return Ok(Rc::clone(known));
        }
        let source = self.open(GroupKind::Surface, id)?;
        let ([added, removed], mut faces) = (split(source), Vec::new());
        match source.listed {
            Listed::Segments => {
                let corners = |face: &[u32]| face.iter().copied().filter(|node| *node != 0).collect::<Vec<_>>();
                faces.extend(added.chunks(4).map(|face| distinct(&corners(face))));
            }
            Listed::Groups => {
                for surface in added {
                    let more = self.faces(surface)?;
                    faces.extend(self.gather(more.to_vec())?);
                }
            }
            Listed::Parts(place) => {
                let without: FxHashSet<u32> = self.parts(place, &removed).into_iter().collect();
                let parts = self.parts(place, &added).into_iter().filter(|part| !without.contains(part));
                faces = self.sides(&parts.collect::<Vec<_>>(), source.extent)?;
            }
            _ => {}
        }
        self.open.pop();
        let faces: Rc<[Vec<u32>]> = faces.into();
        self.faces.insert(id, Rc::clone(&faces));
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

    /// The parts that numbers name, ascending. A subset has the parts of the subsets in it.
    fn parts(&self, place: Option<usize>, numbers: &[u32]) -> Vec<u32> {
        let Some(place) = place else { return numbers.to_vec() };
        let mut names: FxHashSet<u32> = numbers.iter().copied().collect();
        let mut open = numbers.to_vec();
        while let Some(subset) = open.pop().filter(|_| place == 2) {
            let inner = self.mesh.subsets.get(&subset).into_iter().flatten();
            open.extend(inner.copied().filter(|subset| names.insert(*subset)));
        }
        let own = self.mesh.parts.iter().filter(|(_, numbers)| names.contains(&numbers[place]));
        let mut parts: Vec<u32> = own.map(|(&part, _)| part).collect();
        parts.sort_unstable();
        parts
    }
}

/// The positive numbers of a group, and the negative ones without their sign. Each is listed once, unless its place matters.
fn split(source: &GroupSource) -> [Vec<u32>; 2] {
    let is_ordered = matches!(source.listed, Listed::Segments | Listed::Ranges(_));
    let mut seen = FxHashSet::default();
    let mut of = |is_added: bool| -> Vec<u32> {
        let numbers = source.numbers.iter().filter(|number| (**number >= 0) == is_added);
        numbers
            .filter(|number| is_ordered || seen.insert(**number))
            .map(|number| number.unsigned_abs() as u32)
            .collect()
    };
    [of(true), of(false)]
}

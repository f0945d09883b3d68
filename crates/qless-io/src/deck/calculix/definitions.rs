//! What a deck defines, parsed only where something asks for it: node numbers, sets of nodes.

use std::cell::{OnceCell, RefCell};
use std::rc::Rc;

use rustc_hash::{FxHashMap, FxHashSet};

use super::card::{Card, Piece};
use super::data::{Lines, name};
use super::fields::number;
use super::frames::{Local, locals};
use super::mesh::{Elements, positions};
use crate::deck::Problem;
use crate::deck::kinematics::body::Pose;
use crate::deck::kinematics::row::Poses;
use crate::deck::kinematics::vector::Vector;
use crate::fault::quote;

/// Members of a set at most.
const MEMBERS: usize = 200_000_000;

/// Where the parts of a set stand.
enum Part {
    /// Lines that begin with a node.
    Lines(Vec<Piece>),
    /// Numbers and names of other sets.
    List(Vec<Piece>),
    /// `first, last, increment` a line.
    Generate(Vec<Piece>),
    /// The nodes of an element set.
    OfElements(String),
}

/// An `*ELEMENT` card.
pub struct Block {
    pub kind: String,
    pub set: Option<String>,
    pub data: Vec<Piece>,
}

/// A set that is being parsed, or has been.
enum Known {
    InProgress,
    Done(Rc<Vec<u32>>),
}

/// Definitions, as text until they are needed.
#[derive(Default)]
pub struct Definitions {
    nodes: Vec<Piece>,
    node_sets: FxHashMap<String, Vec<Part>>,
    element_sets: FxHashMap<String, Vec<Part>>,
    blocks: Vec<Block>,
    /// By name: whether it is of nodes, and its data.
    pub surfaces: FxHashMap<String, Vec<(bool, Vec<Piece>)>>,
    /// `*TRANSFORM`: node set, whether cylindrical, data.
    pub transforms: Vec<(String, bool, Vec<Piece>)>,
    /// `*ORIENTATION` by name: whether cylindrical, data.
    pub orientations: FxHashMap<String, (bool, Vec<Piece>)>,
    known: RefCell<FxHashMap<(bool, String), Known>>,
    positions: OnceCell<Result<FxHashMap<u32, Vector>, Problem>>,
    elements: OnceCell<Result<Elements, Problem>>,
    locals: OnceCell<Result<FxHashMap<u32, Local>, Problem>>,
    rotating: OnceCell<FxHashSet<u32>>,
    /// Whether a step is geometrically nonlinear.
    pub is_nonlinear: bool,
    /// Bounds of the number of equations and of their terms.
    pub equations: usize,
    pub terms: usize,
    /// Whether nodes may exist that no `*NODE` card lists.
    pub generates_nodes: bool,
}

impl Definitions {
    /// Notes what a card defines.
    pub fn note(&mut self, card: &Card) {
        match card.keyword.as_slice() {
            b"*NODE" => {
                self.nodes.extend_from_slice(&card.data);
                self.part(card.word("NSET"), || Part::Lines(card.data.clone()));
            }
            b"*NSET" if card.parameter("GENERATE").is_some() => {
                self.part(card.word("NSET"), || Part::Generate(card.data.clone()));
            }
            b"*NSET" if card.parameter("ELSET").is_some() => {
                let elements = card.word("ELSET").unwrap_or_default();
                self.part(card.word("NSET"), || Part::OfElements(elements));
            }
            b"*ELSET" => {
                let data = card.data.clone();
                let part = if card.parameter("GENERATE").is_some() { Part::Generate(data) } else { Part::List(data) };
                self.element_sets.entry(card.word("ELSET").unwrap_or_default()).or_default().push(part);
            }
            b"*ELEMENT" => self.blocks.push(Block {
                kind: card.word("TYPE").unwrap_or_default(),
                set: card.word("ELSET"),
                data: card.data.clone(),
            }),
            b"*SURFACE" => {
                let of_nodes = card.word("TYPE").as_deref() == Some("NODE");
                let surface = card.word("NAME").unwrap_or_default();
                self.surfaces.entry(surface).or_default().push((of_nodes, card.data.clone()));
            }
            b"*TRANSFORM" => {
                let set = card.word("NSET").unwrap_or_default();
                self.transforms.push((set, card.word("TYPE").as_deref() == Some("C"), card.data.clone()));
            }
            b"*ORIENTATION" => {
                let cylindrical = card.word("SYSTEM").as_deref() == Some("CYLINDRICAL");
                self.orientations.insert(card.word("NAME").unwrap_or_default(), (cylindrical, card.data.clone()));
            }
            b"*STEP" => self.is_nonlinear |= card.parameter("NLGEOM").is_some_and(|value| value != "NO"),
            b"*NSET" => self.part(card.word("NSET"), || Part::List(card.data.clone())),
            b"*EQUATION" => card.data.iter().for_each(|piece| self.count(piece)),
            b"*NGEN" | b"*NCOPY" | b"*NFILL" | b"*NMAP" => self.generates_nodes = true,
            _ => {}
        }
    }

    /// An equation takes two lines at least; a line of k terms has 3 k - 1 commas.
    fn count(&mut self, piece: &Piece) {
        let text = &piece.text[piece.range.clone()];
        let lines = memchr::memchr_iter(b'\n', text).count();
        self.equations += lines / 2;
        self.terms += (memchr::memchr_iter(b',', text).count() + lines / 2) / 3;
    }

    fn part(&mut self, set: Option<String>, part: impl FnOnce() -> Part) {
        if let Some(set) = set {
            self.node_sets.entry(set).or_default().push(part());
        }
    }

    /// The numbers of all nodes listed, ascending.
    pub fn node_numbers(&self) -> Vec<u32> {
        let mut numbers: Vec<u32> =
            Lines::new(&self.nodes).filter_map(|line| number(line.fields().next()?, "a node").ok()).collect();
        numbers.sort_unstable();
        numbers.dedup();
        numbers
    }

    /// The nodes of a set, in the order of its definition, each once.
    pub fn nodes(&self, set: &str) -> Result<Rc<Vec<u32>>, Problem> {
        self.members(false, name(set))
    }

    /// The names of all node sets.
    pub fn node_set_names(&self) -> impl Iterator<Item = &str> {
        self.node_sets.keys().map(String::as_str)
    }

    /// A node, or the nodes of a set.
    pub fn node_or_set(&self, field: &[u8]) -> Result<Vec<u32>, Problem> {
        match number(field, "a node") {
            Ok(node) => Ok(vec![node]),
            Err(_) => self.nodes(&String::from_utf8_lossy(field)).map(|nodes| nodes.to_vec()),
        }
    }

    /// An element, or the elements of a set.
    pub fn element_or_set(&self, field: &[u8]) -> Result<Vec<u32>, Problem> {
        match number(field, "an element") {
            Ok(element) => Ok(vec![element]),
            Err(_) => self.members(true, name(&String::from_utf8_lossy(field))).map(|elements| elements.to_vec()),
        }
    }

    /// The nodes of the elements of a set, ascending, each once.
    pub fn nodes_of(&self, elements: &str) -> Result<Vec<u32>, Problem> {
        let mut nodes = Vec::new();
        for &element in self.members(true, name(elements))?.iter() {
            nodes.extend_from_slice(self.elements()?.get(element)?.1);
        }
        nodes.sort_unstable();
        nodes.dedup();
        Ok(nodes)
    }

    fn members(&self, of_elements: bool, set: String) -> Result<Rc<Vec<u32>>, Problem> {
        let what = if of_elements { "element set" } else { "node set" };
        let key = (of_elements, set);
        match self.known.borrow().get(&key) {
            Some(Known::Done(members)) => return Ok(Rc::clone(members)),
            Some(Known::InProgress) => return Err(Problem::Circular { what, name: key.1 }),
            None => {}
        }
        let parts = if of_elements { &self.element_sets } else { &self.node_sets }.get(&key.1);
        let named = if of_elements { self.elements()?.by_set.get(&key.1) } else { None };
        if parts.is_none() && named.is_none() {
            return Err(Problem::Undefined { what, name: key.1 });
        }
        self.known.borrow_mut().insert(key.clone(), Known::InProgress);
        let mut members = named.cloned().unwrap_or_default();
        for part in parts.into_iter().flatten() {
            self.add(part, of_elements, &mut members)?;
        }
        let mut seen = FxHashSet::default();
        members.retain(|&member| seen.insert(member));
        let members = Rc::new(members);
        self.known.borrow_mut().insert(key, Known::Done(Rc::clone(&members)));
        Ok(members)
    }

    fn add(&self, part: &Part, of_elements: bool, members: &mut Vec<u32>) -> Result<(), Problem> {
        let what = if of_elements { "an element" } else { "a node" };
        match part {
            Part::Lines(pieces) => {
                for line in Lines::new(pieces) {
                    members.push(number(line.fields().next().unwrap_or_default(), what)?);
                }
            }
            Part::List(pieces) => {
                for field in Lines::new(pieces).flat_map(|line| line.fields()).filter(|field| !field.is_empty()) {
                    if let Ok(member) = number(field, what) {
                        members.push(member);
                    } else {
                        let set = name(&String::from_utf8_lossy(field));
                        members.extend_from_slice(&self.members(of_elements, set)?);
                    }
                }
            }
            Part::Generate(pieces) => {
                for line in Lines::new(pieces) {
                    generate(&mut line.fields(), members)?;
                }
            }
            Part::OfElements(set) => members.extend(self.nodes_of(set)?),
        }
        Ok(())
    }

    /// All elements.
    pub fn elements(&self) -> Result<&Elements, Problem> {
        self.elements.get_or_init(|| Elements::parse(&self.blocks)).as_ref().map_err(Clone::clone)
    }

    /// Where all nodes are.
    pub fn all_positions(&self) -> Result<FxHashMap<u32, Vector>, Problem> {
        positions(Lines::new(&self.nodes))
    }

    /// Where a node is.
    pub fn position(&self, node: u32) -> Result<Vector, Problem> {
        let all = self.positions.get_or_init(|| positions(Lines::new(&self.nodes))).as_ref().map_err(Clone::clone)?;
        all.get(&node).copied().ok_or_else(|| Problem::Undefined { what: "node", name: node.to_string() })
    }

    /// Whether a node belongs to an element whose nodes rotate.
    pub fn rotates(&self, node: u32) -> bool {
        let find = || {
            let kinds = self.blocks.iter().filter(|block| super::shape::Shape::of(&block.kind).rotates);
            let fields = kinds.flat_map(|block| Lines::new(&block.data)).flat_map(|line| line.fields().skip(1));
            fields.filter_map(|field| number(field, "a node").ok()).collect()
        };
        self.rotating.get_or_init(find).contains(&node)
    }
}

impl Poses for Definitions {
    fn pose(&self, node: u32) -> Result<Pose, Problem> {
        let position = self.position(node)?;
        let locals = self.locals.get_or_init(|| locals(self)).as_ref().map_err(Clone::clone)?;
        Ok(Pose {
            position,
            axes: locals.get(&node).map_or(crate::deck::kinematics::axes::BASIC_AXES, |local| local.axes_at(position)),
        })
    }
}

/// `first, last, increment`.
fn generate<'a>(fields: &mut impl Iterator<Item = &'a [u8]>, nodes: &mut Vec<u32>) -> Result<(), Problem> {
    let mut next = || fields.next().filter(|field| !field.is_empty());
    let first = number(next().unwrap_or_default(), "the first node of a range")?;
    let last = next().map_or(Ok(first), |field| number(field, "the last node of a range"))?;
    let step = next().map_or(Ok(1), |field| number(field, "an increment"))?;
    if step == 0 || last < first {
        let found = quote(format!("{first}, {last}, {step}").as_bytes());
        return Err(Problem::Expected { expected: "an ascending range with an increment of at least 1", found });
    }
    if nodes.len() + ((last - first) / step) as usize >= MEMBERS {
        return Err(Problem::Limit { what: "the size of a set", limit: MEMBERS, advice: "correct the range" });
    }
    nodes.extend((first..=last).step_by(step as usize));
    Ok(())
}

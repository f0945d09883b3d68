//! What a deck defines, parsed only where something asks for it: node numbers, sets of nodes.

use std::cell::RefCell;
use std::rc::Rc;

use rustc_hash::FxHashMap;

use super::card::{Card, Piece};
use super::data::{Lines, name};
use super::fields::number;
use crate::deck::Problem;
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
    known: RefCell<FxHashMap<String, Known>>,
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

    /// Whether any node is listed.
    pub fn has_nodes(&self) -> bool {
        !self.nodes.is_empty()
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
        let set = name(set);
        match self.known.borrow().get(&set) {
            Some(Known::Done(nodes)) => return Ok(Rc::clone(nodes)),
            Some(Known::InProgress) => return Err(Problem::Circular { what: "node set", name: set }),
            None => {}
        }
        let Some(parts) = self.node_sets.get(&set) else {
            return Err(Problem::Undefined { what: "node set", name: set });
        };
        self.known.borrow_mut().insert(set.clone(), Known::InProgress);
        let mut nodes = Vec::new();
        for part in parts {
            self.add(part, &mut nodes)?;
        }
        let mut seen = rustc_hash::FxHashSet::default();
        nodes.retain(|&node| seen.insert(node));
        let nodes = Rc::new(nodes);
        self.known.borrow_mut().insert(set, Known::Done(Rc::clone(&nodes)));
        Ok(nodes)
    }

    fn add(&self, part: &Part, nodes: &mut Vec<u32>) -> Result<(), Problem> {
        match part {
            Part::Lines(pieces) => {
                for line in Lines::new(pieces) {
                    nodes.push(number(line.fields().next().unwrap_or_default(), "a node")?);
                }
            }
            Part::List(pieces) => {
                for field in Lines::new(pieces).flat_map(|line| line.fields()).filter(|field| !field.is_empty()) {
                    match number(field, "a node") {
                        Ok(node) => nodes.push(node),
                        Err(_) => nodes.extend_from_slice(&self.nodes(&String::from_utf8_lossy(field))?),
                    }
                }
            }
            Part::Generate(pieces) => {
                for line in Lines::new(pieces) {
                    generate(&mut line.fields(), nodes)?;
                }
            }
        }
        Ok(())
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

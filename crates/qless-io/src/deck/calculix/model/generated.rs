//! Nodes and elements of Abaqus that other cards than `*NODE` and `*ELEMENT` make, and nodes that are not in global coordinates. They are stored
//! as the lines of `*NODE` and `*ELEMENT` that would define them.
//!
//! | card | meaning |
//! | --- | --- |
//! | `*NGEN` | nodes between two others: `x_k = x_0 + (x_n - x_0) k / n` |
//! | `*ELGEN` | rows and layers of copies of an element, whose numbers and nodes increase evenly |
//! | `*SYSTEM` | coordinates of later nodes are in a frame with origin a; b lies on the first axis, c in the plane of the first two |
//! | `*NODE, SYSTEM=C` | cylindrical coordinates, in degrees |

use std::fmt::Write;
use std::sync::Arc;

use crate::deck::calculix::model::frames::along;
use crate::deck::calculix::model::{DeckDefinitions, ElementDefinition, Generation, SetMembers, SetPart};
use crate::deck::calculix::syntax::{
    DataFields, DataLine, DataLines, DataPiece, KeywordCard, Scope, float, number, unless_not_followed,
};
use crate::deck::kinematics::axes::{Frame, FrameKind};
use crate::deck::kinematics::vector::{Vector, minus, plus, scaled};

/// Largest number of nodes, elements and nodes of elements that the cards make. It bounds the memory, to about 200 bytes each.
const GENERATED: usize = 1_000_000;

impl DeckDefinitions {
    /// Records `*NODE`. Nodes in coordinates that this reader does not follow have no position.
    pub fn nodes_of_card(&mut self, card: &KeywordCard) {
        let system = self.generation.systems.get(&card.scope).copied().unwrap_or(Some(Frame::BASIC));
        let frame = match card.word("SYSTEM").unwrap_or_default().as_bytes() {
            b"" | b"R" => system,
            b"C" => system.map(|system| Frame { kind: FrameKind::Cylindrical, ..system }),
            _ => None,
        };
        let has_parameters = card.has_parameters();
        self.generation.has_unknown_nodes |= has_parameters;
        let pieces = card.data.iter();
        match frame.filter(|_| !has_parameters) {
            Some(Frame::BASIC) => self.list(card.scope, pieces.cloned().collect(), true),
            Some(frame) => self.list(card.scope, pieces.map(|piece| in_global(piece, &frame)).collect(), true),
            None => self.list(card.scope, pieces.cloned().collect(), false),
        }
    }

    /// Adds lines of nodes to a scope, with or without positions.
    fn list(&mut self, scope: Scope, pieces: Vec<DataPiece>, are_placed: bool) {
        let lists = if are_placed { &mut self.nodes } else { &mut self.unplaced };
        lists.resize_with(lists.len().max(scope.0 as usize + 1), Vec::new);
        lists[scope.0 as usize].extend(pieces);
    }

    /// Records `*SYSTEM`. The frame is unknown if a point is missing or is no point.
    pub fn system(&mut self, card: &KeywordCard) {
        self.check_numbers("*SYSTEM", card, 6);
        let found = frame(card);
        if found.is_none() {
            self.not_followed.push((card.file, card.line, "*SYSTEM has a point that is none, or points on one line"));
        }
        self.generation.systems.insert(card.scope, found);
    }

    /// Records `*NGEN, NSET=`, with lines `first, last, increment`. Only nodes on a straight line have positions.
    pub fn generate_nodes(&mut self, card: &KeywordCard) {
        self.check_numbers("*NGEN", card, 3);
        for line in card.lines() {
            let (mut text, mut placed) = (String::new(), String::new());
            if self.generated_nodes(card, &line, &mut text, &mut placed).is_none() {
                self.generation.has_unknown_nodes = true;
                let text = "*NGEN does not count from one node up to another in even steps, or makes too many nodes";
                self.not_followed.push((line.file, line.number, text));
            }
            self.list(card.scope, vec![piece(card, text)], false);
            self.list(card.scope, vec![piece(card, placed)], true);
        }
        self.set(card, || SetMembers::Generate(card.data.clone()));
    }

    fn generated_nodes(
        &mut self,
        card: &KeywordCard,
        line: &DataLine,
        text: &mut String,
        placed: &mut String,
    ) -> Option<()> {
        let [first, last, step] = whole_numbers(line, [0, 0, 1])?;
        let count = last.checked_sub(first)?.checked_div(step)?;
        let made = self.generation.count.saturating_add(count as usize);
        if made > GENERATED || first + count * step != last {
            return None;
        }
        self.generation.count = made;
        let ends = [first, last].map(|node| self.own_position(card.scope, node));
        let straight = card.parameter("LINE").is_none();
        for k in 1..count {
            let node = first + k * step;
            if let ([Some(a), Some(b)], true) = (ends, straight) {
                let x = plus(a, scaled(minus(b, a), f64::from(k) / f64::from(count)));
                node_line(placed, node, x);
            } else {
                _ = writeln!(text, "{node}");
            }
        }
        Some(())
    }

    /// The position of a node in its scope; `None` if no line so far gives one.
    fn own_position(&mut self, scope: Scope, node: u32) -> Option<Vector> {
        let (read, known) = self.generation.positions.entry(scope).or_default();
        let pieces = self.nodes.get(scope.0 as usize).map_or(&[][..], Vec::as_slice);
        known.extend(DataLines::new(&pieces[*read..]).filter_map(|line| node_of(&line)));
        *read = pieces.len();
        known.get(&node).copied()
    }

    /// Records `*ELGEN, ELSET=`, with lines `element, count, nodes, elements, rows, nodes, elements, layers, nodes, elements`: the number of
    /// copies in a row, of rows and of layers, each with its increments of node and element numbers.
    pub fn generate_elements(&mut self, card: &KeywordCard) {
        self.check_numbers("*ELGEN", card, 10);
        for line in card.lines() {
            let counts = whole_numbers(&line, [0, 1, 1, 1, 1, 0, 0, 1, 0, 0]);
            let block = counts.and_then(|counts| self.copies(card, counts));
            let members = if let (Some(block), Some([master, ..])) = (block, counts) {
                self.blocks.push(block);
                SetMembers::List(vec![piece(card, master.to_string())])
            } else {
                let text =
                    "*ELGEN copies an element that no *ELEMENT before it defines, or makes too many nodes of elements";
                self.not_followed.push((line.file, line.number, text));
                SetMembers::Unknown("*ELGEN")
            };
            if let Some(set) = card.word("ELSET") {
                self.sets.of_elements.entry((card.scope, set)).or_default().push(SetPart::from_card(card, members));
            }
        }
    }

    /// Records the first field that is no number, among the first `count` fields of each line.
    fn check_numbers(&mut self, name: &'static str, card: &KeywordCard, count: usize) {
        for line in card.lines() {
            let mut fields = DataFields::new(&line);
            let result = (0..count).try_for_each(|_| fields.real().map(drop));
            if let Err(fault) = result.or_else(unless_not_followed) {
                self.wrong.get_or_insert((name, line.file, line.number, fault));
            }
        }
    }

    fn copies(&mut self, card: &KeywordCard, counts: [u32; 10]) -> Option<ElementDefinition> {
        let [master, count, rest @ ..] = counts;
        let [by_node, by_element, rows, row_nodes, row_elements, layers, layer_nodes, layer_elements] = rest;
        let (kind, nodes) = self.own_element(card.scope, master)?;
        let all = count.checked_mul(rows)?.checked_mul(layers)?;
        let made = self.generation.count.saturating_add((all as usize).saturating_mul(1 + nodes.len()));
        if all == 0 || made > GENERATED {
            return None;
        }
        self.generation.count = made;
        let mut text = String::new();
        for at in 1..all {
            let place = [at % count, at / count % rows, at / count / rows];
            let add = |first: u32, by: [u32; 3]| {
                place.iter().zip(by).try_fold(first, |sum, (k, by)| sum.checked_add(k.checked_mul(by)?))
            };
            write!(text, "{}", add(master, [by_element, row_elements, layer_elements])?).ok()?;
            for node in &nodes {
                write!(text, ",{}", add(*node, [by_node, row_nodes, layer_nodes])?).ok()?;
            }
            text.push('\n');
        }
        Some(ElementDefinition { scope: card.scope, kind, set: card.word("ELSET"), data: vec![piece(card, text)] })
    }

    /// The type of an element of a scope, and its nodes there; `None` if no card so far defines it.
    fn own_element(&mut self, scope: Scope, element: u32) -> Option<(String, Vec<u32>)> {
        let (Generation { blocks, elements, .. }, mut fields) = (&mut self.generation, Vec::new());
        for (at, block) in self.blocks.iter().enumerate().skip(*blocks) {
            // The visitor cannot fail.
            _ = block.each_element(&mut fields, |fields| {
                let numbers: Result<Vec<u32>, _> = fields.iter().map(|field| number(field, "a number")).collect();
                numbers.into_iter().for_each(|own| _ = elements.insert((block.scope, own[0]), (at, own[1..].to_vec())));
                Ok(())
            });
        }
        *blocks = self.blocks.len();
        elements.get(&(scope, element)).map(|(at, nodes)| (self.blocks[*at].kind.clone(), nodes.clone()))
    }
}

/// The frame of `*SYSTEM`; `None` if it is not known.
fn frame(card: &KeywordCard) -> Option<Frame> {
    let mut lines = card.lines();
    let Some(first) = lines.next() else { return Some(Frame::BASIC) };
    let mut numbers = [0.0; 6];
    for (x, field) in numbers.iter_mut().zip(first.fields()) {
        *x = if field.is_empty() { 0.0 } else { float(field).ok()? };
    }
    let [ax, ay, az, bx, by, bz] = numbers;
    let a = [ax, ay, az];
    if first.fields().skip(3).all(<[u8]>::is_empty) {
        return Some(Frame { origin: a, ..Frame::BASIC });
    }
    let to_b = minus([bx, by, bz], a);
    let axes = match lines.next() {
        None => along([to_b[0], to_b[1], 0.0], [-to_b[1], to_b[0], 0.0]),
        Some(line) => along(to_b, minus(point(&mut line.fields())?, a)),
    };
    axes.map(|axes| Frame { origin: a, ..axes })
}

fn point<'a>(fields: &mut impl Iterator<Item = &'a [u8]>) -> Option<Vector> {
    let mut next = || fields.next().filter(|field| !field.is_empty()).map_or(Some(0.0), |field| float(field).ok());
    Some([next()?, next()?, next()?])
}

/// The node and the coordinates on a line of `*NODE`; `None` if they are wrong.
fn node_of(line: &DataLine) -> Option<(u32, Vector)> {
    let mut fields = line.fields();
    Some((number(fields.next()?, "a node").ok()?, point(&mut fields)?))
}

/// The numbers in the fields of a line, with defaults for empty ones; `None` if one is wrong.
fn whole_numbers<const N: usize>(line: &DataLine, mut numbers: [u32; N]) -> Option<[u32; N]> {
    for (value, field) in numbers.iter_mut().zip(line.fields()).filter(|(_, field)| !field.is_empty()) {
        *value = number(field, "a number").ok()?;
    }
    Some(numbers)
}

/// The lines of a piece, with coordinates in a frame converted to global ones. Lines that are wrong stay as they are, and so do all line
/// numbers.
fn in_global(piece: &DataPiece, frame: &Frame) -> DataPiece {
    let mut text = String::new();
    for (k, row) in piece.text[piece.range.clone()].split(|&byte| byte == b'\n').enumerate() {
        let line = DataLine { file: piece.file, number: piece.line + k as u32, text: row };
        match node_of(&line) {
            Some((node, x)) => node_line(&mut text, node, frame.point(x)),
            None => text.extend([&*String::from_utf8_lossy(row), "\n"]),
        }
    }
    DataPiece { range: 0..text.len(), text: Arc::new(text.into_bytes()), ..piece.clone() }
}

fn node_line(text: &mut String, node: u32, [x, y, z]: Vector) {
    _ = writeln!(text, "{node},{x:e},{y:e},{z:e}");
}

/// Lines that a card stands for.
fn piece(card: &KeywordCard, text: String) -> DataPiece {
    DataPiece { file: card.file, line: card.line, range: 0..text.len(), text: Arc::new(text.into_bytes()) }
}

//! Stores what constraints refer to: nodes, elements, parts, rigid materials and sets.

use rustc_hash::{FxHashMap, FxHashSet};

use crate::deck::Problem;
use crate::deck::keyword::elements::{ElementKind, ElementStore, KeywordElement};
use crate::deck::keyword::group::Gap;
use crate::deck::keyword::line::{FieldLayout, KeywordFault, KeywordLine, Parameters};
use crate::deck::kinematics::axes::BASIC_AXES;
use crate::deck::kinematics::body::{Pose, Poses};
use crate::deck::kinematics::vector::Vector;
use crate::deck::lsdyna::syntax::card::DynaCard;

/// A part: the number of its material, and its centre of mass if `*PART_INERTIA` gives it.
#[derive(Clone, Copy, Debug)]
pub struct DynaPart {
    pub material: u32,
    pub centre: Option<Vector>,
}

/// What a set consists of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SetKind {
    Node,
    Part,
    /// Faces of four nodes; a triangle repeats its last node.
    Segment,
}

/// The members of a set. If this reader does not read the set, the error holds the keyword of its card.
type NamedMembers = Result<Vec<u32>, String>;

/// All definitions of a deck that constraints may refer to.
#[derive(Default)]
pub struct DynaMesh {
    pub nodes: FxHashMap<u32, Vector>,
    pub parts: FxHashMap<u32, DynaPart>,
    /// Numbers of the materials that make a part rigid.
    pub rigid: FxHashSet<u32>,
    pub sets: FxHashMap<(SetKind, u32), NamedMembers>,
    pub elements: ElementStore,
    /// The highest number of a node so far.
    highest: u32,
}

impl DynaMesh {
    /// Records what a card defines; ignores all other cards.
    pub fn note(&mut self, card: &DynaCard, parameters: &Parameters) -> Result<(), KeywordFault> {
        let (name, [has_title]) = card.without(["_TITLE"]);
        let mut lines = card.lines(parameters).skip(usize::from(has_title)).filter(|line| !line.is_blank());
        match name {
            "NODE" => lines.try_for_each(|line| self.node(line)),
            "MAT_RIGID" | "MAT_020" => {
                self.rigid.extend(lines.next().map(|line| line.id(0)).transpose()?);
                Ok(())
            }
            _ if name.starts_with("ELEMENT_") => self.add_elements(card, lines),
            _ if is_part(name) => part_lines(card, parameters)?.into_iter().try_for_each(|(line, inertia)| {
                let centre = inertia.map(|line| self.centre(&line)).transpose()?;
                self.parts.insert(line.id(0)?, DynaPart { material: line.id(2)?, centre });
                Ok(())
            }),
            _ => name.strip_prefix("SET_").map_or(Ok(()), |set| self.set(set, &mut lines)),
        }
    }

    fn node(&mut self, line: KeywordLine) -> Result<(), KeywordFault> {
        let line = line.laid_out(FieldLayout::Node);
        let node = line.id(0)?;
        self.highest = self.highest.max(node);
        self.nodes.insert(node, line.vector(1)?);
        Ok(())
    }

    /// Records the elements of one card. Options add lines to each element. If an option is unknown, the nodes of parts are not known any
    /// more.
    fn add_elements<'a>(
        &mut self,
        card: &DynaCard,
        lines: impl Iterator<Item = KeywordLine<'a>>,
    ) -> Result<(), KeywordFault> {
        let Some(kind) = element_kind(card) else { return Ok(()) };
        let options: Vec<&str> = card.keyword.split('_').skip(2).collect();
        let Some(more) = options.iter().map(|option| option_lines(kind, option)).sum::<Option<usize>>() else {
            self.elements.leave_out(format!("*{}", card.keyword));
            return Ok(());
        };
        // The angle of a shell needs no line of its own if the shell has a line with its thickness.
        let has = |option| kind == ElementKind::Shell && options.contains(&option);
        let more = more - usize::from(has("THICKNESS") && (has("BETA") || has("MCID")));
        let mut lines = lines.map(|line| line.laid_out(FieldLayout::Element));
        while let Some(line) = lines.next() {
            let (part, mut nodes) = (line.id(1)?, line.ids(2, 8)?);
            // A solid may have its nodes on a line of their own.
            if nodes.is_empty() && kind == ElementKind::Solid {
                nodes = lines.next().map(|line| line.ids(0, 10)).transpose()?.unwrap_or_default();
            }
            // The third node of a beam only orients it. A shell with nodes in the middle of its edges has their thickness on another line.
            nodes.truncate(if kind == ElementKind::Beam { 2 } else { 10 });
            let middle = usize::from(nodes.len() > 4 && has("THICKNESS"));
            (0..more + middle).for_each(|_| _ = lines.next());
            self.elements.add(part, KeywordElement { kind, nodes });
        }
        Ok(())
    }

    fn set(&mut self, name: &str, lines: &mut dyn Iterator<Item = KeywordLine<'_>>) -> Result<(), KeywordFault> {
        let (Some((word, kind)), Some(first)) = (set_kind(name), lines.next()) else { return Ok(()) };
        let members = self.sets.entry((kind, first.id(0)?)).or_insert(Ok(Vec::new()));
        match (name[word.len()..].as_ref(), members) {
            ("" | "_LIST", Ok(members)) => {
                for line in lines {
                    let ids = line.ids(0, if kind == SetKind::Segment { 4 } else { line.count(8) })?;
                    members.extend(&ids);
                    let missing = if kind == SetKind::Segment { 4 - ids.len() } else { 0 };
                    members.extend(ids.last().map_or(vec![0; missing], |last| vec![*last; missing]));
                }
            }
            (_, members) => *members = Err(format!("*SET_{name}")),
        }
        Ok(())
    }

    /// The members of the set that a field of a line names.
    pub fn members(&self, kind: SetKind, line: &KeywordLine, field: usize) -> Result<&[u32], Gap> {
        let id = line.id(field)?;
        let what = match kind {
            SetKind::Node => "node set",
            SetKind::Part => "part set",
            SetKind::Segment => "segment set",
        };
        match self.sets.get(&(kind, id)) {
            Some(Ok(members)) => Ok(members),
            Some(Err(keyword)) => Err(Gap::Unread(format!("uses {what} {id}, which {keyword} defines"))),
            None => Err(line.fault_at(field, Problem::Undefined { what, name: id.to_string() }).into()),
        }
    }

    /// The nodes of the set that a field names, each once, in the order of the set; or the single node that the field names.
    pub fn node_list(&self, is_set: bool, line: &KeywordLine, field: usize) -> Result<Vec<u32>, Gap> {
        let mut seen = FxHashSet::default();
        let nodes = if is_set { self.members(SetKind::Node, line, field)?.to_vec() } else { vec![line.id(field)?] };
        match nodes.iter().find(|node| !self.nodes.contains_key(node)) {
            Some(node) => Err(line.fault_at(field, Problem::Undefined { what: "node", name: node.to_string() }).into()),
            None => Ok(nodes.into_iter().filter(|&node| seen.insert(node)).collect()),
        }
    }

    /// The centre of mass on a line `XC, YC, ZC, TM, IRCS, NODEID`: the position of the node, or the coordinates if no such node exists.
    pub fn centre(&self, line: &KeywordLine) -> Result<Vector, KeywordFault> {
        self.nodes.get(&line.id(5)?).map_or_else(|| line.vector(0), |position| Ok(*position))
    }

    /// Adds a node at this position. Returns its number, which no node of the deck has.
    pub fn add_node(&mut self, position: Vector) -> Option<u32> {
        self.highest = self.highest.checked_add(1)?;
        self.nodes.insert(self.highest, position);
        Some(self.highest)
    }
}

impl Poses for DynaMesh {
    fn pose(&self, node: u32) -> Result<Pose, Problem> {
        let undefined = || Problem::Undefined { what: "node", name: node.to_string() };
        self.nodes.get(&node).map(|&position| Pose { position, axes: BASIC_AXES }).ok_or_else(undefined)
    }
}

/// Whether a card defines nodes, elements, parts, rigid materials or sets to which constraints may refer.
pub fn is_definition(card: &DynaCard) -> bool {
    let (name, _) = card.without(["_TITLE"]);
    matches!(name, "NODE" | "MAT_RIGID" | "MAT_020")
        || element_kind(card).is_some()
        || is_part(name)
        || name.strip_prefix("SET_").is_some_and(|set| set_kind(set).is_some())
}

/// The kind of the elements that a card defines; `None` for other cards, and for elements whose nodes no constraint needs.
fn element_kind(card: &DynaCard) -> Option<ElementKind> {
    match card.keyword.strip_prefix("ELEMENT_")?.split('_').next()? {
        "SOLID" | "TSHELL" => Some(ElementKind::Solid),
        "SHELL" => Some(ElementKind::Shell),
        "BEAM" => Some(ElementKind::Beam),
        _ => None,
    }
}

/// The kind of a set by the keyword after `SET_`, with its word there.
fn set_kind(name: &str) -> Option<(&'static str, SetKind)> {
    let kinds = [("NODE", SetKind::Node), ("PART", SetKind::Part), ("SEGMENT", SetKind::Segment)];
    kinds.into_iter().find(|(word, _)| name.split('_').next() == Some(word))
}

/// Whether cards with this keyword, without its title, define parts. `*PART_SENSOR` switches elements of a part on and off, and
/// `*PART_ADAPTIVE_FAILURE` lets one part split: both name a part that another card defines.
pub fn is_part(name: &str) -> bool {
    name == "PART" || name.starts_with("PART_") && !["PART_SENSOR", "PART_ADAPTIVE_FAILURE"].contains(&name)
}

/// The number of lines that an option adds to an element; `None` if the option is unknown.
fn option_lines(kind: ElementKind, option: &str) -> Option<usize> {
    match (kind, option) {
        (ElementKind::Shell, "THICKNESS" | "BETA" | "MCID" | "OFFSET")
        | (ElementKind::Beam, "THICKNESS" | "SCALAR" | "SECTION" | "PID" | "OFFSET" | "ORIENTATION") => Some(1),
        (ElementKind::Solid, "ORTHO") => Some(2),
        _ => None,
    }
}

/// The line with the numbers of a part, and, if the card has it, the line with its centre of mass.
pub type PartLines<'a> = (KeywordLine<'a>, Option<KeywordLine<'a>>);

/// Options of `*PART` that this reader knows. Each adds a line to a part, and `INERTIA` adds more.
const OPTIONS: [&str; 5] = ["INERTIA", "REPOSITION", "CONTACT", "PRINT", "ATTACHMENT"];

fn part_options(card: &DynaCard) -> Vec<&str> {
    card.keyword.split('_').skip(1).filter(|option| *option != "NODES").collect()
}

/// Whether a card defines parts, which may be rigid, with an option that this reader does not know. Parts of composites, of averaged trusses
/// and of annealed elements are not rigid.
pub fn has_unknown_option(card: &DynaCard) -> bool {
    let mut options = part_options(card).into_iter();
    options.any(|option| !OPTIONS.contains(&option) && !["COMPOSITE", "LONG", "AVERAGED", "ANNEAL"].contains(&option))
}

/// The parts on a card. Each has a line with a title, a line with numbers, and more lines for options. If the card has other options than
/// these, no parts are returned, so that none becomes rigid: see [`has_unknown_option`].
pub fn part_lines<'a>(card: &'a DynaCard, parameters: &'a Parameters) -> Result<Vec<PartLines<'a>>, KeywordFault> {
    let options = part_options(card);
    if options.iter().any(|option| !OPTIONS.contains(option)) {
        return Ok(Vec::new());
    }
    let has_inertia = options.contains(&"INERTIA");
    let (mut lines, mut parts) = (card.lines(parameters), Vec::new());
    while let (Some(_), Some(line)) = (lines.next(), lines.next()) {
        let inertia = has_inertia.then(|| lines.next()).flatten();
        // If the inertia has a local frame, the part has another line.
        let more = inertia.map_or(Ok(0), |line| line.whole(4).map(|frame| if frame == 1 { 3 } else { 2 }))?;
        (0..more + options.len() - usize::from(has_inertia)).for_each(|_| _ = lines.next());
        if !line.is_blank() {
            parts.push((line, inertia));
        }
    }
    Ok(parts)
}

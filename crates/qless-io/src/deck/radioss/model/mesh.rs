//! Stores what constraints refer to: nodes, elements, parts, groups, surfaces and skew frames.

use rustc_hash::{FxHashMap, FxHashSet};

use super::groups::{GroupKind, GroupSource};
use crate::deck::Problem;
use crate::deck::keyword::elements::{ElementKind, ElementStore, KeywordElement};
use crate::deck::keyword::group::Gap;
use crate::deck::keyword::line::{FieldLayout, KeywordFault, KeywordLine, Parameters};
use crate::deck::kinematics::axes::BASIC_AXES;
use crate::deck::kinematics::body::{Pose, Poses, clean};
use crate::deck::kinematics::vector::{Vector, cross, minus, unit};
use crate::deck::radioss::syntax::card::RadiossCard;

/// The numbers on the line of a part: its property, its material and its subset.
pub type PartNumbers = [u32; 3];

/// How a skew frame is given.
#[derive(Clone, Copy, Debug)]
enum SkewSource {
    /// By its second axis, and by a vector in the plane of its second and third axes.
    Fixed(Vector, Vector),
    /// By three nodes. The first two give axis `k`, and the third one lies in the plane of axes `k` and `k + 1`.
    Moving([u32; 3], usize),
    /// By three nodes. The first two give the third axis, and the last one lies in the plane of the third and first axes.
    Moving2([u32; 3]),
}

/// Where a card is: its number in the model, and its place in the deck.
#[derive(Clone, Debug, Default)]
pub struct CardPlace {
    pub number: u32,
    pub file: u32,
    pub line: u32,
    pub name: String,
}

/// A rigid body with a main node: `/RBODY` or `/RBE2`.
#[derive(Clone, Debug)]
pub struct RadiossBody {
    pub main: u32,
    pub slaves: Vec<u32>,
    /// Whether the solver moves the main node to the centre of mass.
    pub moves: bool,
    pub place: CardPlace,
}

/// A weighted mean.
#[derive(Clone, Debug)]
pub struct RadiossMean {
    pub reference: u32,
    pub nodes: Vec<u32>,
    /// Whether springs never replace it.
    pub is_strict: bool,
    pub place: CardPlace,
}

/// All definitions of a deck that constraints may refer to.
#[derive(Default)]
pub struct RadiossMesh {
    pub nodes: FxHashMap<u32, Vector>,
    pub elements: ElementStore,
    pub parts: FxHashMap<u32, PartNumbers>,
    /// The subsets in each subset.
    pub subsets: FxHashMap<u32, Vec<u32>>,
    pub groups: FxHashMap<(GroupKind, u32), GroupSource>,
    /// A card that may define nodes and groups, but is not read.
    pub unread: Option<String>,
    skews: FxHashMap<u32, SkewSource>,
    /// The card that is being read.
    pub card: CardPlace,
    /// The `/RBODY`, `/RBE2` and `/RBE3` cards that were read.
    pub bodies: Vec<RadiossBody>,
    pub links: Vec<RadiossBody>,
    pub means: Vec<RadiossMean>,
    /// The slaves of `/INTER/TYPE2`.
    pub tied: FxHashSet<u32>,
    /// The skew frame in which `/BCS` holds a node.
    pub held_in: FxHashMap<u32, u32>,
    /// Why the solver stops, each with the card.
    pub stops: Vec<(CardPlace, String)>,
}

/// The kind of an element, the number of its nodes that count, and the number of its lines.
fn element_kind(word: &str) -> Option<(ElementKind, usize, usize)> {
    Some(match word {
        "SHELL" => (ElementKind::Shell, 4, 1),
        "SH3N" => (ElementKind::Shell, 3, 1),
        "BRICK" => (ElementKind::Solid, 8, 1),
        "PENTA6" => (ElementKind::Solid, 6, 1),
        "TETRA4" => (ElementKind::Solid, 4, 1),
        "TETRA10" => (ElementKind::Solid, 10, 2),
        "BRIC20" => (ElementKind::Solid, 20, 3),
        "SHEL16" => (ElementKind::Solid, 16, 3),
        // The third node of a beam, and the third to sixth of a spring, only orient it.
        "BEAM" | "SPRING" => (ElementKind::Beam, 2, 1),
        "TRUSS" => (ElementKind::Link, 2, 1),
        "QUAD" => (ElementKind::Link, 4, 1),
        "TRIA" => (ElementKind::Link, 3, 1),
        _ => return None,
    })
}

impl RadiossMesh {
    /// Records what a card defines; ignores all other cards.
    pub fn note(&mut self, card: &RadiossCard, parameters: &Parameters) -> Result<(), KeywordFault> {
        let mut lines = card.data(parameters);
        match card.keyword.split('/').next().unwrap_or_default() {
            "NODE" if card.units == 0 && card.id == 0 => {
                let filled = card.lines(parameters).filter(|line| !line.is_blank());
                filled.map(|line| line.laid_out(FieldLayout::Wide)).try_for_each(|line| self.node(line))
            }
            "NODE" | "CNODE" | "SET" | "INCLUDE_LS-DYNA" => {
                self.unread = Some(card.name());
                Ok(())
            }
            "PART" => lines.next().map_or(Ok(()), |line| {
                self.parts.insert(card.id, [line.id(0)?, line.id(1)?, line.id(2)?]);
                Ok(())
            }),
            "SUBSET" => lines.try_for_each(|line| {
                self.subsets.entry(card.id).or_default().extend(line.ids(0, line.count(10))?);
                Ok(())
            }),
            "GRNOD" | "SURF" => self.group(card, lines),
            "SKEW" => self.skew(card, &lines.collect::<Vec<_>>()),
            "SPHCEL" | "XELEM" => {
                self.elements.leave_out(format!("/{}", card.keyword));
                Ok(())
            }
            _ => self.add_elements(card, parameters),
        }
    }

    fn node(&mut self, line: KeywordLine) -> Result<(), KeywordFault> {
        let position = [line.number(1)?, line.number(3)?, line.number(5)?].map(|x| x.unwrap_or(0.0));
        self.nodes.insert(line.laid_out(FieldLayout::Common).id(0)?, position);
        Ok(())
    }

    fn group<'a>(
        &mut self,
        card: &RadiossCard,
        mut lines: impl Iterator<Item = KeywordLine<'a>>,
    ) -> Result<(), KeywordFault> {
        let Some((kind, source)) = GroupSource::of(&card.keyword) else { return Ok(()) };
        let source = self.groups.entry((kind, card.id)).or_insert(source);
        lines.try_for_each(|line| source.extend(&line))
    }

    fn add_elements(&mut self, card: &RadiossCard, parameters: &Parameters) -> Result<(), KeywordFault> {
        let Some((kind, count, size)) = element_kind(&card.keyword) else { return Ok(()) };
        let mut lines = card.lines(parameters).filter(|line| !line.is_blank());
        while let Some(line) = lines.next() {
            // The number of the element comes first. In an element of several lines, its nodes may begin on the second one.
            let mut nodes = line.ids(1, count.min(8))?;
            for _ in 1..size {
                nodes.extend(lines.next().map(|line| line.ids(0, 10)).transpose()?.unwrap_or_default());
            }
            nodes.truncate(count);
            if let ("PENTA6", &[a, b, c, d, e, f]) = (card.keyword.as_str(), nodes.as_slice()) {
                nodes = vec![a, b, c, c, d, e, f, f];
            }
            self.elements.add(card.id, KeywordElement { kind, nodes });
        }
        Ok(())
    }

    fn skew(&mut self, card: &RadiossCard, lines: &[KeywordLine]) -> Result<(), KeywordFault> {
        let nodes = |line: &KeywordLine| Ok::<_, KeywordFault>([line.id(0)?, line.id(1)?, line.id(2)?]);
        let source = match (card.keyword.as_str(), lines) {
            // From version 12.0 on, a line with the origin comes first.
            ("SKEW/FIX", [.., second, third]) => {
                let vector = |line: &KeywordLine| {
                    let line = line.laid_out(FieldLayout::Wide);
                    Ok::<_, KeywordFault>([line.number(0)?, line.number(2)?, line.number(4)?].map(|x| x.unwrap_or(0.0)))
                };
                SkewSource::Fixed(vector(second)?, vector(third)?)
            }
            ("SKEW/MOV", [line, ..]) => {
                let axis = match line.field(3) {
                    b"Y" | b"y" => 1,
                    b"Z" | b"z" => 2,
                    _ => 0,
                };
                SkewSource::Moving(nodes(line)?, axis)
            }
            ("SKEW/MOV2", [line, ..]) => SkewSource::Moving2(nodes(line)?),
            _ => return Ok(()),
        };
        self.skews.insert(card.id, source);
        Ok(())
    }

    /// The axes of the skew frame that a field names; `None` for the global frame.
    pub fn axes(&self, line: &KeywordLine, field: usize) -> Result<Option<[Vector; 3]>, Gap> {
        let id = line.id(field)?;
        if id == 0 {
            return Ok(None);
        }
        let Some(source) = self.skews.get(&id) else { return Err(self.undefined(line, field, "skew frame", id)) };
        let degenerate = |problem| Gap::from(line.fault_at(field, problem));
        let axes = self.axes_of(*source).map_err(degenerate)?;
        let what = || Problem::Degenerate { what: format!("the axes of skew frame {id} are on a line") };
        axes.map(Some).ok_or_else(|| degenerate(what()))
    }

    /// The axes of a skew frame; `None` if its vectors are on a line.
    fn axes_of(&self, source: SkewSource) -> Result<Option<[Vector; 3]>, Problem> {
        let from_first = |nodes: [u32; 3]| {
            let [a, b, c] = nodes.map(|node| self.pose(node).map(|pose| pose.position));
            let a = a?;
            Ok::<_, Problem>((minus(b?, a), minus(c?, a)))
        };
        // The axis with this number has the direction `first`, and the next one lies in the plane of `first` and `second`.
        let (k, first, second) = match source {
            SkewSource::Fixed(first, second) => (1, first, second),
            SkewSource::Moving(nodes, k) => from_first(nodes).map(|(first, second)| (k, first, second))?,
            SkewSource::Moving2(nodes) => from_first(nodes).map(|(first, second)| (2, first, second))?,
        };
        let axes = || {
            let first = unit(first)?;
            let last = unit(cross(first, unit(second)?))?;
            let mut axes = [[0.0; 3]; 3];
            [axes[k], axes[(k + 1) % 3], axes[(k + 2) % 3]] = [first, cross(last, first), last];
            Some(axes.map(|axis| axis.map(|x| clean(x, 1.0))))
        };
        Ok(axes())
    }

    /// The gap that something is not defined. It is a fault of the deck only if every card that may define it is read.
    pub fn undefined(&self, line: &KeywordLine, field: usize, what: &'static str, id: u32) -> Gap {
        match &self.unread {
            Some(card) => Gap::Unread(format!("names {what} {id}, which {card} may define")),
            None => line.fault_at(field, Problem::Undefined { what, name: id.to_string() }).into(),
        }
    }

    /// The node that a field names.
    pub fn node_at(&self, line: &KeywordLine, field: usize) -> Result<u32, Gap> {
        let node = line.id(field)?;
        if self.nodes.contains_key(&node) { Ok(node) } else { Err(self.undefined(line, field, "node", node)) }
    }
}

impl Poses for RadiossMesh {
    fn pose(&self, node: u32) -> Result<Pose, Problem> {
        let undefined = || Problem::Undefined { what: "node", name: node.to_string() };
        self.nodes.get(&node).map(|&position| Pose { position, axes: BASIC_AXES }).ok_or_else(undefined)
    }
}

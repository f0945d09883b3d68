//! What a deck defines (nodes, sets, elements and so on), and the lookups that cards need.

use std::cell::{OnceCell, RefCell};
use std::ops::Range;

use rustc_hash::{FxHashMap, FxHashSet};

use crate::deck::calculix::model::elements::{ElementShape, MeshElements};
use crate::deck::calculix::model::instances::{Instance, InstanceMotion, NodeNumbers};
use crate::deck::calculix::model::steps::StepTraits;
use crate::deck::calculix::model::{
    AxesCard, ElementDefinition, Generation, LocalAxes, ScopedName, SetMembers, SetPart, SetTable, SurfaceCard, axes,
};
use crate::deck::calculix::syntax::parameters::DeckParameters;
use crate::deck::calculix::syntax::walk::walk;
use crate::deck::calculix::syntax::{
    DataFields, DataLine, DataLines, DataPiece, FieldFault, KeywordCard, Scope, float, number, unless_not_followed,
};
use crate::deck::kinematics::axes::{BASIC_AXES, Frame};
use crate::deck::kinematics::body::Pose;
use crate::deck::kinematics::body::Poses;
use crate::deck::kinematics::vector::Vector;
use crate::deck::source::SolverReason;
use crate::deck::{DeckError, Problem, Solver, Sources};

/// The definitions of a deck: nodes, sets, elements and so on. They are kept as text until they are needed.
#[derive(Default)]
pub struct DeckDefinitions {
    /// Text of the `*NODE` cards of each scope.
    pub(super) nodes: Vec<Vec<DataPiece>>,
    /// Text that names nodes whose positions are not known, for each scope.
    pub(super) unplaced: Vec<Vec<DataPiece>>,
    pub(super) generation: Generation,
    /// File and line of definitions that this reader does not follow, with what they do.
    pub not_followed: Vec<(u32, u32, &'static str)>,
    /// The first wrong field of a card that generates nodes or elements: the card, file and line, and the fault.
    pub wrong: Option<(&'static str, u32, u32, FieldFault)>,
    pub parameters: DeckParameters,
    /// Whether the deck is read for Abaqus, and not for ccx.
    pub is_abaqus: bool,
    pub sets: SetTable,
    pub blocks: Vec<ElementDefinition>,
    pub surfaces: FxHashMap<ScopedName, Vec<SurfaceCard>>,
    /// Names of node sets with the `*TRANSFORM` cards that give them local axes.
    pub transforms: Vec<(String, AxesCard)>,
    pub orientations: FxHashMap<ScopedName, AxesCard>,
    /// Names of `*AMPLITUDE` cards.
    pub amplitudes: FxHashSet<String>,
    pub instances: Vec<Instance>,
    pub by_instance: FxHashMap<String, Scope>,
    assemblies: Vec<String>,
    numbers: OnceCell<Result<NodeNumbers, Problem>>,
    positions: OnceCell<Result<FxHashMap<u32, Vector>, Problem>>,
    elements: OnceCell<Result<MeshElements, Problem>>,
    locals: OnceCell<Result<LocalAxes, Problem>>,
    /// For each node, the shapes of its elements that ccx expands into solids.
    pub(super) expanded: OnceCell<FxHashMap<u32, Vec<ElementShape>>>,
    /// Positions of the nodes that the solver makes.
    made: RefCell<FxHashMap<u32, Vector>>,
    /// What steps of the deck ask for.
    pub steps: StepTraits,
    /// Estimated number of equations and of their terms, used to reserve memory.
    pub equations: usize,
    pub terms: usize,
}

/// Cards that Abaqus knows and ccx does not, and that change what other cards mean.
const ONLY_ABAQUS: [&str; 10] =
    ["*INSTANCE", "*SYSTEM", "*NGEN", "*NCOPY", "*NFILL", "*NMAP", "*ELGEN", "*ELCOPY", "*IMPERFECTION", "*PARAMETER"];

impl DeckDefinitions {
    /// Reads the definitions of a deck, and calls `also` for each card. A deck with cards that only Abaqus knows is one of Abaqus.
    pub fn read(sources: &mut Sources, mut also: impl FnMut(&KeywordCard)) -> Result<Self, DeckError> {
        let mut parameters = DeckParameters::default();
        let mut define = |card: &KeywordCard| {
            if card.is("*PARAMETER") {
                parameters.define(card);
            }
            also(card);
        };
        let (mut definitions, mut reason) = Self::noted(sources, &DeckParameters::default(), &mut define)?;
        if !parameters.is_empty() {
            // A parameter has one value in all of the deck: the cards are read again with the values of all parameters.
            (definitions, reason) = Self::noted(sources, &parameters, &mut also)?;
        }
        if definitions.is_abaqus {
            sources.set_solver(Solver::Abaqus, reason);
        }
        definitions.is_abaqus = sources.solver() == Solver::Abaqus;
        definitions.parameters = parameters;
        Ok(definitions)
    }

    /// Reads the definitions with these parameters. Returns them, and the first card that only Abaqus knows.
    fn noted(
        sources: &mut Sources,
        parameters: &DeckParameters,
        also: &mut dyn FnMut(&KeywordCard),
    ) -> Result<(Self, Option<SolverReason>), DeckError> {
        let (mut definitions, mut reason) = (Self::default(), None);
        walk(sources, parameters, &mut |card: &KeywordCard| {
            definitions.note(card);
            also(card);
            if definitions.is_abaqus && reason.is_none() {
                let keyword = String::from_utf8_lossy(&card.keyword);
                reason = Some((card.file, card.line, format!("only Abaqus knows this {keyword}")));
            }
            Ok(())
        })?;
        Ok((definitions, reason))
    }

    /// Records what a card defines.
    pub fn note(&mut self, card: &KeywordCard) {
        let key = |parameter| (card.scope, card.word(parameter).unwrap_or_default());
        let has_system = card.is("*NODE") && card.parameter("SYSTEM").is_some();
        self.is_abaqus |= has_system || ONLY_ABAQUS.iter().any(|keyword| card.is(keyword));
        self.steps.note(card);
        match card.keyword.as_slice() {
            b"*INSTANCE" => self.instance(card),
            b"*ASSEMBLY" => self.assemblies.extend(card.word("NAME")),
            b"*NODE" => {
                self.nodes_of_card(card);
                self.set(card, || SetMembers::Lines(card.data.clone()));
            }
            b"*NSET" if card.parameter("GENERATE").is_some() => {
                self.set(card, || SetMembers::Generate(card.data.clone()));
            }
            b"*NSET" if card.parameter("ELSET").is_some() => {
                self.set(card, || SetMembers::OfElements(card.word("ELSET").unwrap_or_default()));
            }
            b"*NSET" => self.set(card, || SetMembers::List(card.data.clone())),
            b"*ELSET" => {
                let data = card.data.clone();
                let part = if card.parameter("GENERATE").is_some() {
                    SetMembers::Generate(data)
                } else {
                    SetMembers::List(data)
                };
                self.sets.of_elements.entry(key("ELSET")).or_default().push(SetPart::from_card(card, part));
            }
            b"*ELEMENT" => self.elements_of_card(card),
            b"*SURFACE" => {
                let of_nodes = card.word("TYPE").as_deref() == Some("NODE");
                let patch = SurfaceCard { scope: card.scope, of_nodes, data: card.data.clone() };
                self.surfaces.entry(key("NAME")).or_default().push(patch);
            }
            b"*TRANSFORM" => {
                let set = card.word("NSET").unwrap_or_default();
                self.transforms.push((set, axes(card, "TYPE")));
            }
            b"*ORIENTATION" => _ = self.orientations.insert(key("NAME"), axes(card, "SYSTEM")),
            b"*AMPLITUDE" => self.amplitudes.extend(card.word("NAME")),
            b"*EQUATION" => card.data.iter().for_each(|piece| self.count(piece)),
            b"*SYSTEM" => self.system(card),
            b"*NGEN" => self.generate_nodes(card),
            b"*ELGEN" => self.generate_elements(card),
            b"*NCOPY" | b"*NFILL" => {
                self.generation.has_unknown_nodes = true;
                self.set(card, || SetMembers::Unknown("*NFILL"));
                let copied = card.word("NEWSET").map(|set| self.sets.of_nodes.entry((card.scope, set)).or_default());
                copied.into_iter().for_each(|set| set.push(SetPart::from_card(card, SetMembers::Unknown("*NCOPY"))));
            }
            b"*NMAP" => {
                self.generation.has_moved_nodes = true;
                self.not_followed.push((card.file, card.line, "*NMAP moves nodes"));
            }
            b"*ELCOPY" => {
                let set = self.sets.of_elements.entry(key("NEWSET")).or_default();
                set.push(SetPart::from_card(card, SetMembers::Unknown("*ELCOPY")));
                self.not_followed.push((card.file, card.line, "*ELCOPY makes elements"));
            }
            _ => {}
        }
    }

    fn elements_of_card(&mut self, card: &KeywordCard) {
        let kind = card.word("TYPE").unwrap_or_default();
        if card.has_parameters() || kind.contains('<') {
            self.not_followed.push((card.file, card.line, "*ELEMENT has a parameter whose value is not known"));
        }
        let (scope, data) = (card.scope, card.data.clone());
        self.blocks.push(ElementDefinition { scope, kind, set: card.word("ELSET"), data });
    }

    fn instance(&mut self, card: &KeywordCard) {
        let name = card.parameter("NAME").unwrap_or_default().to_owned();
        let key = card.word("NAME").unwrap_or_default();
        self.by_instance.insert(key, card.scope);
        self.instances.push(Instance { name, data: card.data.clone() });
    }

    /// Adds members to the node set that a card names; does nothing if it names none.
    pub(super) fn set(&mut self, card: &KeywordCard, part: impl FnOnce() -> SetMembers) {
        if let Some(set) = card.word("NSET") {
            self.sets.of_nodes.entry((card.scope, set)).or_default().push(SetPart::from_card(card, part()));
        }
    }

    /// Adds the number of equations on a card, estimated from its text: two lines for each equation, and 3 k - 1 commas on a line of k
    /// terms.
    fn count(&mut self, piece: &DataPiece) {
        let text = &piece.text[piece.range.clone()];
        let lines = memchr::memchr_iter(b'\n', text).count();
        self.equations += lines / 2;
        self.terms += (memchr::memchr_iter(b',', text).count() + lines / 2) / 3;
    }

    /// Looks up a name in `scope`. If it is not there, looks it up in the instance with which the name begins.
    pub fn find<'m, V>(
        &self,
        map: &'m FxHashMap<ScopedName, V>,
        scope: Scope,
        name: &str,
    ) -> Option<(ScopedName, &'m V)> {
        let own = (scope, name.to_owned());
        if let Some(value) = map.get(&own) {
            return Some((own, value));
        }
        let (scope, rest) = self.qualified(name)?;
        let key = (scope, rest.to_owned());
        map.get(&key).map(|value| (key, value))
    }

    /// Splits `I.rest`, where I is the name of an instance, into the scope of I and the rest. The name of the assembly may precede I.
    pub fn qualified<'n>(&self, name: &'n str) -> Option<(Scope, &'n str)> {
        let inner = |assembly: &String| name.strip_prefix(assembly.as_str()).and_then(|rest| rest.strip_prefix('.'));
        let name = self.assemblies.iter().find_map(inner).unwrap_or(name);
        let split = |dot: usize| self.by_instance.get(&name[..dot]).map(|scope| (*scope, &name[dot + 1..]));
        name.match_indices('.').find_map(|(dot, _)| split(dot))
    }

    /// Checks the lines of all `*NODE` cards. The error holds the first wrong line with its wrong field. Later errors could not name a
    /// line, because positions are parsed for all nodes at once, and only if a card needs them.
    pub fn check_nodes(&self) -> Result<(), (DataLine<'_>, FieldFault)> {
        for line in self.nodes.iter().chain(&self.unplaced).flat_map(|pieces| DataLines::new(pieces)) {
            let mut fields = DataFields::new(&line);
            let read = number(fields.next().unwrap_or_default(), "a node").map_err(|problem| (Some(1), problem));
            let read = read.and_then(|_| (0..3).try_for_each(|_| fields.real().map(drop)));
            read.or_else(unless_not_followed).map_err(|fault| (line, fault))?;
        }
        Ok(())
    }

    /// The numbers that the nodes of instances have in the whole deck.
    pub fn numbers(&self) -> Result<&NodeNumbers, Problem> {
        let find = || {
            let scopes = 1..=self.instances.len();
            NodeNumbers::build(&self.listed(0), scopes.map(|scope| self.listed(scope)))
        };
        self.numbers.get_or_init(find).as_ref().map_err(Clone::clone)
    }

    /// The node numbers of a scope as its cards give them, ascending.
    fn listed(&self, scope: usize) -> Vec<u32> {
        let lists = [&self.nodes, &self.unplaced].map(|lists| lists.get(scope).map_or(&[][..], Vec::as_slice));
        let lines = lists.into_iter().flat_map(DataLines::new);
        let mut numbers: Vec<u32> = lines.filter_map(|line| number(line.fields().next()?, "a node").ok()).collect();
        numbers.sort_unstable();
        numbers.dedup();
        numbers
    }

    /// Whether cards define nodes whose numbers are not known.
    pub fn has_unknown_nodes(&self) -> bool {
        self.generation.has_unknown_nodes
    }

    /// Numbers of all nodes of the deck, ascending.
    pub fn node_numbers(&self) -> Vec<u32> {
        let mut all = self.listed(0);
        for (first, own) in self.numbers().map_or(&[][..], NodeNumbers::instances) {
            all.extend((0..own.len() as u32).map(|k| first + k));
        }
        all.extend(self.made.borrow().keys());
        all.sort_unstable();
        all
    }

    /// Names of the node sets outside all instances.
    pub fn node_set_names(&self) -> impl Iterator<Item = &str> {
        let own = self.sets.of_nodes.keys().filter(|(scope, _)| *scope == Scope::DECK);
        own.map(|(_, name)| name.as_str())
    }

    /// Adds a node that the solver makes. Returns its number, which no other node has.
    pub fn make_node(&self, position: Vector) -> Result<u32, Problem> {
        self.make_nodes(&[position]).map(|nodes| nodes.start)
    }

    /// Adds nodes that the solver makes. Returns their numbers, which no other nodes have.
    pub fn make_nodes(&self, positions: &[Vector]) -> Result<Range<u32>, Problem> {
        let advice = "use smaller numbers";
        let limit = Problem::Limit { what: "the largest number of a node", limit: u32::MAX as usize, advice };
        let first = self.node_numbers().last().map_or(Some(1), |last| last.checked_add(1)).ok_or(limit.clone())?;
        let end = u32::try_from(positions.len()).ok().and_then(|count| first.checked_add(count)).ok_or(limit)?;
        self.made.borrow_mut().extend((first..end).zip(positions.iter().copied()));
        Ok(first..end)
    }

    /// All elements.
    pub fn elements(&self) -> Result<&MeshElements, Problem> {
        self.elements.get_or_init(|| self.parse_elements()).as_ref().map_err(Clone::clone)
    }

    /// Positions of all nodes that `*NODE` cards list.
    pub fn all_positions(&self) -> Result<FxHashMap<u32, Vector>, Problem> {
        let mut all = FxHashMap::default();
        for (pieces, scope) in self.nodes.iter().zip(0..) {
            let motion = match scope {
                0 => None,
                _ => Some(self.motion(Scope(scope))?),
            };
            for (own, position) in positions(DataLines::new(pieces))? {
                let position = motion.map_or(position, |motion| motion.point(position));
                all.insert(self.numbered(Scope(scope), own)?, position);
            }
        }
        Ok(all)
    }

    /// The rigid motion that places an instance in the deck.
    fn motion(&self, scope: Scope) -> Result<InstanceMotion, Problem> {
        InstanceMotion::read(&self.instances[scope.0 as usize - 1].data)
    }

    /// Converts a frame from the coordinates of an instance to those of the deck. A frame of the deck itself is unchanged.
    pub fn placed(&self, scope: Scope, frame: Frame) -> Result<Frame, Problem> {
        if scope == Scope::DECK { Ok(frame) } else { Ok(self.motion(scope)?.frame(frame)) }
    }

    /// Position of a node.
    pub fn position(&self, node: u32) -> Result<Vector, Problem> {
        if self.generation.has_moved_nodes {
            return Err(Problem::NotFollowed { what: format!("the position of node {node} after *NMAP") });
        }
        if let Some(position) = self.made.borrow().get(&node) {
            return Ok(*position);
        }
        let all = self.positions.get_or_init(|| self.all_positions()).as_ref().map_err(Clone::clone)?;
        let are_known = !self.generation.has_unknown_nodes && self.unplaced.iter().all(Vec::is_empty);
        all.get(&node).copied().ok_or_else(|| {
            if are_known {
                Problem::Undefined { what: "node", name: node.to_string() }
            } else {
                Problem::NotFollowed { what: format!("the position of node {node}") }
            }
        })
    }

    /// The nodes to which `*TRANSFORM` gives local axes. Sets that are not defined are skipped.
    pub fn nodes_with_axes(&self) -> impl Iterator<Item = u32> {
        let nodes = |(set, axes): &(String, AxesCard)| self.nodes(axes.scope, set).map(|nodes| nodes.to_vec());
        self.transforms.iter().flat_map(move |transform| nodes(transform).unwrap_or_default())
    }

    /// The axes along which the components of a node are.
    pub fn axes(&self, node: u32) -> Result<[Vector; 3], Problem> {
        match self.locals.get_or_init(|| self.locals()).as_ref().map_err(Clone::clone)?.get(&node) {
            Some(Ok(frame)) => Ok(frame.axes_at(self.position(node)?)),
            Some(Err(problem)) => Err(problem.clone()),
            None => Ok(BASIC_AXES),
        }
    }
}

/// The position of each node that these lines define.
fn positions(lines: DataLines) -> Result<FxHashMap<u32, Vector>, Problem> {
    let mut positions = FxHashMap::default();
    for line in lines {
        let mut fields = line.fields();
        let node = number(fields.next().unwrap_or_default(), "a node")?;
        let mut next = || fields.next().filter(|field| !field.is_empty()).map_or(Ok(0.0), float);
        positions.insert(node, [next()?, next()?, next()?]);
    }
    Ok(positions)
}

impl Poses for DeckDefinitions {
    fn pose(&self, node: u32) -> Result<Pose, Problem> {
        Ok(Pose { position: self.position(node)?, axes: self.axes(node)? })
    }
}

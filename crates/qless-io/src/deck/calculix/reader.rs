//! From cards to a model: every step inherits what holds before it.

use std::collections::BTreeMap;

use super::card::{Card, walk};
use super::coupling::{self, Coupling};
use super::definitions::Definitions;
use super::{boundary, equation, mpc, rigid, tie};
use crate::deck::{DeckError, Dof, Load, LoadCase, Model, Origin, Prescribed, Problem, Solver, Sources};

/// Cards that constrain in ways that this reader does not follow.
const UNKNOWN: [&str; 9] = [
    "*CYCLICSYMMETRYMODEL",
    "*PRE-TENSIONSECTION",
    "*EMBEDDEDELEMENT",
    "*SHELLTOSOLIDCOUPLING",
    "*CONNECTORSECTION",
    "*SUBMODEL",
    "*NETWORKMPC",
    "*MPCUSER",
    "*RELEASE",
];

/// Reads a deck.
///
/// # Errors
/// [`DeckError`].
pub fn read(sources: &mut Sources) -> Result<Model, DeckError> {
    let mut definitions = Definitions::default();
    let mut instance = None;
    walk(sources, &mut |card: &Card| {
        definitions.note(card);
        if card.is("*INSTANCE") && instance.is_none() {
            instance = Some((card.file, card.line));
        }
        Ok(())
    })?;
    let mut reader = Reader::new(sources, definitions);
    if let Some((file, line)) = instance {
        return Err(reader.refuse_instances(file, line));
    }
    walk(sources, &mut |card: &Card| reader.card(card))?;
    reader.finish()
}

struct Reader {
    solver: Solver,
    model: Model,
    definitions: Definitions,
    /// Values in force, with the step that gave them; 0 before the first.
    prescribed: BTreeMap<Dof, (Prescribed, usize)>,
    clashes: Vec<Prescribed>,
    loads: Vec<Load>,
    removed: Vec<u32>,
    /// The last `*COUPLING`, for the card that says of which kind it is.
    coupling: Option<Coupling>,
    steps: usize,
    in_step: bool,
}

impl Reader {
    fn new(sources: &Sources, definitions: Definitions) -> Self {
        let mut model = Model::new(sources.paths().to_vec());
        model.reserve(definitions.equations, definitions.terms);
        Self {
            solver: sources.solver(),
            model,
            definitions,
            prescribed: BTreeMap::new(),
            clashes: Vec::new(),
            loads: Vec::new(),
            removed: Vec::new(),
            coupling: None,
            steps: 0,
            in_step: false,
        }
    }

    fn card(&mut self, card: &Card) -> Result<(), DeckError> {
        match card.keyword.as_slice() {
            b"*EQUATION" if card.parameter("REMOVE").is_some() || card.parameter("REMOVEALL").is_some() => {
                self.removed.extend(equation::removed(card, &mut self.model, &self.definitions)?);
                self.removed.sort_unstable();
                self.removed.dedup();
            }
            b"*EQUATION" => equation::read(card, &mut self.model, &self.definitions)?,
            b"*MPC" => mpc::read(card, &mut self.model, &self.definitions)?,
            b"*RIGIDBODY" => rigid::read(card, self.solver, &mut self.model, &self.definitions)?,
            b"*COUPLING" => self.coupling = Some(Coupling::of(card)),
            b"*KINEMATIC" | b"*DISTRIBUTING" => {
                if let Some(coupling) = &self.coupling {
                    coupling::read(card, coupling, &mut self.model, &self.definitions)?;
                }
            }
            b"*KINEMATICCOUPLING" => coupling::kinematic_coupling(card, &mut self.model, &self.definitions)?,
            b"*DISTRIBUTINGCOUPLING" => coupling::distributing_coupling(card, &mut self.model, &self.definitions)?,
            b"*TIE" => tie::read(card, &mut self.model, &self.definitions)?,
            b"*BOUNDARY" => self.boundary(card)?,
            b"*CLOAD" => self.load(card)?,
            b"*STEP" => (self.steps, self.in_step) = (self.steps + 1, true),
            b"*ENDSTEP" => self.end_step(),
            keyword if UNKNOWN.iter().any(|unknown| unknown.as_bytes() == keyword) => self.unknown(card),
            _ => {}
        }
        Ok(())
    }

    /// Values of a later step replace earlier ones; two in the same step contradict each other.
    fn boundary(&mut self, card: &Card) -> Result<(), DeckError> {
        if card.word("OP").as_deref() == Some("NEW") {
            self.prescribed.retain(|_, (_, step)| *step == self.steps && self.steps > 0);
        }
        for given in boundary::read(card, &mut self.model, &self.definitions)? {
            match self.prescribed.get(&given.dof) {
                Some((before, step)) if *step == self.steps => {
                    if before.value != given.value && !is_from_elsewhere(card) {
                        self.clashes.push(given);
                    }
                }
                _ => {
                    self.prescribed.insert(given.dof, (given, self.steps));
                    self.clashes.retain(|clash| clash.dof != given.dof);
                }
            }
        }
        if is_from_elsewhere(card) {
            let text = "*BOUNDARY: the values are not in the deck; they are taken as 0, so contradictions among them are not seen";
            self.model.warn(card.file, card.line, text);
        }
        Ok(())
    }

    fn load(&mut self, card: &Card) -> Result<(), DeckError> {
        if card.word("OP").as_deref() == Some("NEW") {
            self.loads.clear();
        }
        self.loads.extend(boundary::loads(card, &mut self.model, &self.definitions)?);
        Ok(())
    }

    fn end_step(&mut self) {
        if std::mem::take(&mut self.in_step) {
            let case = self.case(format!("step {}", self.steps));
            self.model.cases.push(case);
        }
    }

    fn case(&self, name: String) -> LoadCase {
        LoadCase {
            name,
            prescribed: self.prescribed.values().map(|(given, _)| *given).collect(),
            clashes: self.clashes.clone(),
            loads: self.loads.clone(),
            removed: self.removed.clone(),
        }
    }

    fn unknown(&mut self, card: &Card) {
        let keyword = String::from_utf8_lossy(&card.keyword).into_owned();
        self.model.leave_out(card.file, card.line, format!("{keyword} constrains, but is not understood: left out"));
    }

    fn refuse_instances(&mut self, file: u32, line: u32) -> DeckError {
        let card = self.model.card("*INSTANCE", file, line);
        let problem = Problem::Expected {
            expected: "a deck without parts and instances (write it flat, with one numbering of nodes)",
            found: "`*INSTANCE`".into(),
        };
        self.model.error(Origin { card, line, lines: 1 }, None, problem)
    }

    fn finish(mut self) -> Result<Model, DeckError> {
        self.end_step();
        if self.model.cases.is_empty() {
            let case = self.case("model".into());
            self.model.cases.push(case);
        }
        self.check_nodes()?;
        self.model.traits.has_local_axes = !self.definitions.transforms.is_empty();
        self.model.traits.is_nonlinear = self.definitions.is_nonlinear;
        self.model.shrink();
        Ok(self.model)
    }

    /// A node that no card defines: the first equation that names it is at fault.
    fn check_nodes(&self) -> Result<(), DeckError> {
        let defined = self.definitions.node_numbers();
        if defined.is_empty() || self.definitions.generates_nodes {
            return Ok(());
        }
        let mut used: Vec<u32> = self.model.dofs.iter().map(|dof| dof.node).collect();
        used.sort_unstable();
        used.dedup();
        let mut rest = defined.as_slice();
        let undefined = |node: &&u32| {
            rest = &rest[rest.partition_point(|defined| defined < *node)..];
            rest.first() != Some(*node)
        };
        let Some(&node) = used.iter().find(undefined) else { return Ok(()) };
        let names = |i: &usize| self.model.nth(*i).columns.iter().any(|&j| self.model.dofs[j as usize].node == node);
        let origin = (0..self.model.equations()).find(names).map(|i| self.model.nth(i).origin);
        let problem = Problem::Undefined { what: "node", name: node.to_string() };
        origin.map_or(Ok(()), |origin| Err(self.model.error(origin, None, problem)))
    }
}

/// Whether the values come from another model or from a user's routine.
fn is_from_elsewhere(card: &Card) -> bool {
    card.parameter("SUBMODEL").is_some() || card.parameter("USER").is_some()
}

//! Keeps the prescribed values and loads that are in force while the cards of a deck are read. Each step inherits those of earlier steps.
//!
//! A value that is not in the deck counts as 0, so that its DOF is prescribed. It makes the deck incomplete if equations have the DOF:
//!
//! | parameter of `*BOUNDARY` | value |
//! | --- | --- |
//! | `FIXED` | what the step before reaches: its prescribed value, zero in the first step, otherwise not in the deck |
//! | `USER`, `SUBMODEL` | not in the deck |
//! | `TYPE=VELOCITY`, `TYPE=ACCELERATION` (Abaqus) | a time history of its own; from the second step on, not in the deck |

use std::collections::{BTreeMap, BTreeSet};

use super::cards::boundary;
use super::model::DeckDefinitions;
use super::syntax::KeywordCard;
use crate::deck::{DeckError, Dof, Load, LoadCase, Model, Prescribed, Solver};

/// The prescribed values, each with the step of its card. Step 0 stands for the time before the first step.
type PrescribedBySteps = BTreeMap<Dof, (Prescribed, usize)>;

/// What is in force at a card.
#[derive(Default)]
struct InForce {
    prescribed: PrescribedBySteps,
    clashes: Vec<Prescribed>,
    /// Prescribed DOFs whose values are not in the deck.
    unknown: BTreeSet<Dof>,
    loads: Vec<Load>,
}

/// What is in force at a card, and the step of the card.
#[derive(Default)]
pub struct StepValues {
    now: InForce,
    steps: usize,
    /// Whether a `*BOUNDARY` card has occurred in the current step. Before the first step: whether any has occurred.
    has_boundary: bool,
    in_step: bool,
    /// What returns after a perturbation step.
    base: Option<InForce>,
    /// File and line of cards with values that are not in the deck, and their DOFs.
    unknown: Vec<(u32, u32, BTreeSet<Dof>)>,
}

impl StepValues {
    /// Whether a step has begun.
    pub fn has_begun(&self) -> bool {
        self.steps > 0
    }

    /// Whether a DOF is prescribed.
    pub fn prescribes(&self, dof: Dof) -> bool {
        self.now.prescribed.contains_key(&dof)
    }

    /// Begins a step.
    pub fn begin_step(&mut self) {
        (self.steps, self.in_step, self.has_boundary) = (self.steps + 1, true, false);
    }

    /// Begins a perturbation step of Abaqus: what is prescribed before stays at its value, so that its perturbation is zero, and loads do not
    /// act. Later steps continue from the state before.
    pub fn perturb(&mut self, solver: Solver) {
        if solver != Solver::Abaqus || !self.in_step || self.base.is_some() {
            return;
        }
        let prescribed = self.now.prescribed.clone();
        self.base = Some(std::mem::replace(&mut self.now, InForce { prescribed, ..InForce::default() }));
        for (given, _) in self.now.prescribed.values_mut() {
            (given.value, given.history) = (0.0, 0);
        }
    }

    /// Ends a step, if one is open, and returns its load case.
    pub fn end_step(&mut self, removed: &[u32]) -> Option<LoadCase> {
        let case = std::mem::take(&mut self.in_step).then(|| self.case(format!("step {}", self.steps), removed));
        if let Some(base) = self.base.take() {
            self.now = base;
        }
        case
    }

    /// The load case of what is in force, without the equations in `removed`.
    pub fn case(&self, name: String, removed: &[u32]) -> LoadCase {
        LoadCase {
            name,
            prescribed: self.now.prescribed.values().map(|(given, _)| *given).collect(),
            clashes: self.now.clashes.clone(),
            loads: self.now.loads.clone(),
            removed: removed.to_vec(),
        }
    }

    /// Reads `*CLOAD`.
    pub fn load(
        &mut self,
        card: &KeywordCard,
        model: &mut Model,
        definitions: &DeckDefinitions,
    ) -> Result<(), DeckError> {
        if card.word("OP").as_deref() == Some("NEW") {
            self.now.loads.clear();
        }
        self.now.loads.extend(boundary::loads(card, model, definitions)?);
        Ok(())
    }

    /// Reads `*BOUNDARY`.
    pub fn boundary(
        &mut self,
        card: &KeywordCard,
        model: &mut Model,
        definitions: &DeckDefinitions,
    ) -> Result<(), DeckError> {
        if card.word("LOADCASE").is_some_and(|case| case != "1") || card.parameter("IMAGINARY").is_some() {
            let text =
                "*BOUNDARY of a second load case or of imaginary parts, which this reader does not follow: left out";
            model.leave_out(card.file, card.line, text);
            return Ok(());
        }
        let is_first = !std::mem::replace(&mut self.has_boundary, true);
        let rate = card.word("TYPE").filter(|kind| definitions.is_abaqus && kind != "DISPLACEMENT");
        let rate = rate.map(|kind| kind.to_lowercase());
        let reached = card.parameter("FIXED").map(|_| self.now.prescribed.clone());
        if card.word("OP").as_deref() == Some("NEW") {
            self.forget(card, is_first || definitions.is_abaqus, model);
        }
        let mut all = boundary::read(card, model, definitions, rate.as_deref())?;
        let unknown = self.unknown_of(card, reached.as_ref(), &mut all, model);
        all.into_iter().for_each(|given| self.prescribe(given, unknown.contains(&given.dof)));
        if rate.is_some() && self.steps > 1 {
            let text = "*BOUNDARY of a rate starts from the displacements that the step before reaches, which this reader does not follow";
            model.leave_out(card.file, card.line, text);
        }
        if !unknown.is_empty() {
            self.unknown.push((card.file, card.line, unknown));
        }
        Ok(())
    }

    /// Says which cards have values that are not in the deck, after all equations have been read.
    pub fn say_unknown(&self, model: &mut Model) {
        for (file, line, dofs) in &self.unknown {
            let text = |dof: &Dof, effect| {
                let name = model.dof_name(*dof);
                format!("*BOUNDARY: values that are not in the deck, such as that of {name}, count as 0: {effect}")
            };
            if let Some(dof) = dofs.iter().find(|dof| model.column(**dof).is_some()) {
                model.leave_out(*file, *line, text(dof, "what is said of conflicts with them may be wrong"));
            } else if let Some(dof) = dofs.first() {
                model.warn(*file, *line, text(dof, "no equation has these DOFs"));
            }
        }
    }

    /// The DOFs on a card whose values the deck does not have. Sets those of `FIXED` that it has, from what is `reached` before.
    fn unknown_of(
        &self,
        card: &KeywordCard,
        reached: Option<&PrescribedBySteps>,
        all: &mut [Prescribed],
        model: &mut Model,
    ) -> BTreeSet<Dof> {
        if ["USER", "SUBMODEL"].iter().any(|source| card.parameter(source).is_some()) {
            return all.iter().map(|given| given.dof).collect();
        }
        let fix = |reached| all.iter_mut().filter_map(|given| self.fix(given, reached, model)).collect();
        reached.map(fix).unwrap_or_default()
    }

    /// Puts a value in force. It replaces one of an earlier step. Different values in the same step contradict each other.
    fn prescribe(&mut self, given: Prescribed, is_unknown: bool) {
        match self.now.prescribed.get(&given.dof) {
            Some((before, step)) if *step == self.steps => {
                let differs = (before.value, before.history) != (given.value, given.history);
                if differs && !is_unknown && !self.now.unknown.contains(&given.dof) {
                    self.now.clashes.push(given);
                }
            }
            _ => {
                self.now.prescribed.insert(given.dof, (given, self.steps));
                self.now.clashes.retain(|clash| clash.dof != given.dof);
                self.now.unknown.remove(&given.dof);
                self.now.unknown.extend(Some(given.dof).filter(|_| is_unknown));
            }
        }
    }

    /// Sets the value of `FIXED`, from the values `reached` before. Returns the DOF if the deck does not have it. A time history that has ended
    /// is another one than while it runs.
    fn fix(&self, given: &mut Prescribed, reached: &PrescribedBySteps, model: &mut Model) -> Option<Dof> {
        (given.value, given.history) = (0.0, 0);
        let before = reached.get(&given.dof).filter(|(_, step)| *step < self.steps);
        match before {
            // Nothing has moved before the first step.
            _ if self.steps <= 1 => None,
            Some((before, _)) if !self.now.unknown.contains(&given.dof) => {
                let name = model.histories().nth(before.history as usize).flatten().map(str::to_owned);
                given.value = before.value;
                given.history = name.map_or(0, |name| model.history(&format!("{name} at its end")));
                None
            }
            _ => Some(given.dof),
        }
    }

    /// Executes `OP=NEW`, which removes the values of earlier steps or, before the first step, all values. ccx heeds it only on the first
    /// `*BOUNDARY` of a step.
    fn forget(&mut self, card: &KeywordCard, counts: bool, model: &mut Model) {
        if !counts {
            let text =
                "*BOUNDARY, OP=NEW is not the first of its step: ccx ignores OP=NEW, so that earlier values remain";
            model.warn(card.file, card.line, text);
            return;
        }
        self.now.prescribed.retain(|_, (_, step)| *step == self.steps && self.steps > 0);
        self.now.clashes.retain(|clash| self.now.prescribed.contains_key(&clash.dof));
    }
}

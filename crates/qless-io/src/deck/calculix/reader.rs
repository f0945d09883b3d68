//! Builds the model from the cards of a deck. Each step inherits the removals of earlier steps; for its values, see `values`.

use super::cards::body_rotations::{self, ReadBody};
use super::cards::free_slave::{self, ChosenSlave, SlaveRule};
use super::cards::mean_rotation::MeanRotation;
use super::cards::pre_tension::{self, CutNodes};
use super::cards::{cyclic, equation, expanded, mpc, old_coupling, refused, rigid, tie, unread};
use super::nodes;
use crate::deck::calculix::cards::coupling::{self, CouplingCard};
use crate::deck::calculix::cards::rigid::BodyReference;
use crate::deck::calculix::model::DeckDefinitions;
use crate::deck::calculix::syntax::KeywordCard;
use crate::deck::calculix::syntax::walk::walk;
use crate::deck::calculix::values::StepValues;
use crate::deck::{DeckError, Model, Problem, Solver, Sources};

/// Reads a deck.
///
/// # Errors
/// [`DeckError`].
pub fn read(sources: &mut Sources) -> Result<Model, DeckError> {
    let mut has_mpc = false;
    let mut definitions = DeckDefinitions::read(sources, |card| has_mpc |= mpc::is_nonlinear(card))?;
    nodes::check_fields(&definitions, sources)?;
    // In ccx, some types of `*MPC` make all steps nonlinear.
    definitions.steps.is_nonlinear |= has_mpc && sources.solver() == Solver::Ccx;
    let mut reader = CalculixReader::new(sources, definitions)?;
    if reader.solver == Solver::Ccx {
        refused::byte_order_marks(sources, &mut reader.model);
    }
    for (file, line, what) in std::mem::take(&mut reader.definitions.not_followed) {
        let text = format!("{what}, which this reader does not follow: constraints that depend on it are left out");
        reader.model.leave_out(file, line, text);
    }
    let parameters = std::mem::take(&mut reader.definitions.parameters);
    walk(sources, &parameters, &mut |card: &KeywordCard| {
        for (file, line, name) in parameters.without_value(card) {
            let text = format!("the value of the parameter {name} is not followed: cards that need it are left out");
            reader.model.warn(file, line, text);
        }
        let result = reader.card(card);
        reader.or_left_out(result, card)
    })?;
    reader.finish()
}

struct CalculixReader {
    solver: Solver,
    model: Model,
    definitions: DeckDefinitions,
    /// The values in force at the card that is read.
    values: StepValues,
    removed: Vec<u32>,
    /// The last `*COUPLING` card. The card that follows it decides its type.
    coupling: Option<CouplingCard>,
    /// File and line of a `*COUPLING` whose type is not decided yet.
    open_coupling: Option<(u32, u32)>,
    /// File, line and reference of the couplings that only distribute forces.
    forces: Vec<(u32, u32, u32)>,
    /// Equations whose slaves are chosen at the end.
    chosen: Vec<ChosenSlave>,
    sections: Vec<CutNodes>,
    bodies: Vec<ReadBody>,
    /// Reference, file and line of the kinematic couplings in global axes. Others never make ccx stop.
    couplings: Vec<ReadBody>,
    /// `*CYCLIC SYMMETRY MODEL` cards, and the ties that they may use.
    sectors: Vec<KeywordCard>,
    cyclic: Vec<KeywordCard>,
}

impl CalculixReader {
    fn new(sources: &Sources, definitions: DeckDefinitions) -> Result<Self, DeckError> {
        let mut model = Model::new(sources.paths().to_vec());
        model.reserve(definitions.equations, definitions.terms);
        nodes::name(&mut model, &definitions)?;
        Ok(Self {
            solver: sources.solver(),
            model,
            definitions,
            values: StepValues::default(),
            removed: Vec::new(),
            coupling: None,
            open_coupling: None,
            forces: Vec::new(),
            chosen: Vec::new(),
            sections: Vec::new(),
            bodies: Vec::new(),
            couplings: Vec::new(),
            sectors: Vec::new(),
            cyclic: Vec::new(),
        })
    }

    /// Leaves out a card that needs what this reader does not follow. All other errors stay.
    fn or_left_out(&mut self, result: Result<(), DeckError>, card: &KeywordCard) -> Result<(), DeckError> {
        match result {
            Err(DeckError { problem: problem @ Problem::NotFollowed { .. }, line, card: name, .. }) => {
                self.model.leave_out(card.file, line as u32, format!("{name} constrains, but {problem}: left out"));
                let coupled = self.coupling.as_ref().and_then(|coupling| coupling.nodes(&self.definitions).ok());
                unread::claim_named(card, coupled.unwrap_or_default(), &mut self.model, &self.definitions);
                Ok(())
            }
            other => other,
        }
    }

    fn card(&mut self, card: &KeywordCard) -> Result<(), DeckError> {
        match card.keyword.as_slice() {
            b"*EQUATION" if card.parameter("REMOVE").is_some() || card.parameter("REMOVEALL").is_some() => {
                self.removed.extend(equation::removed(card, &mut self.model, &self.definitions)?);
                self.removed.sort_unstable();
                self.removed.dedup();
            }
            b"*EQUATION" => {
                if self.solver == Solver::Ccx {
                    refused::equation(card, self.values.has_begun(), &mut self.model);
                }
                equation::read(card, &mut self.model, &self.definitions)?;
            }
            b"*MPC" => {
                let rotations = mpc::read(card, &mut self.model, &self.definitions, self.solver)?;
                rotations.into_iter().for_each(|(equation, nodes)| self.note_mean_rotation(equation, nodes));
            }
            b"*RIGIDBODY" => {
                let body = rigid::read(card, &mut self.model, &self.definitions, self.solver)?;
                self.bodies.extend(body.map(|body| ReadBody { body, file: card.file, line: card.line }));
            }
            b"*COUPLING" => {
                if self.solver == Solver::Ccx {
                    refused::coupling(card, &mut self.model);
                }
                self.check_coupling();
                self.coupling = Some(CouplingCard::from_card(card));
                self.open_coupling = Some((card.file, card.line));
            }
            b"*KINEMATIC" | b"*DISTRIBUTING" => self.coupled(card)?,
            b"*KINEMATICCOUPLING" => {
                old_coupling::kinematic_coupling(card, &mut self.model, &self.definitions, self.solver)?;
            }
            b"*DISTRIBUTINGCOUPLING" => {
                old_coupling::distributing_coupling(card, &mut self.model, &self.definitions, self.solver)?;
            }
            b"*TIE" if card.parameter("CYCLICSYMMETRY").is_some() => self.cyclic.push(card.clone()),
            b"*TIE" => tie::read(card, &mut self.model, &self.definitions, self.solver)?,
            b"*BOUNDARY" => self.values.boundary(card, &mut self.model, &self.definitions)?,
            b"*CLOAD" => self.values.load(card, &mut self.model, &self.definitions)?,
            b"*STEP" => {
                // For several nodal diameters, the values of all steps decide whether the equations can be read.
                if !self.definitions.steps.has_diameters {
                    self.cyclic_symmetry()?;
                }
                self.values.begin_step();
                if card.parameter("PERTURBATION").is_some() {
                    self.values.perturb(self.solver);
                }
            }
            b"*ENDSTEP" => self.model.cases.extend(self.values.end_step(&self.removed)),
            b"*FREQUENCY"
            | b"*BUCKLE"
            | b"*COMPLEXFREQUENCY"
            | b"*MODALDYNAMIC"
            | b"*STEADYSTATEDYNAMICS"
            | b"*RANDOMRESPONSE"
            | b"*RESPONSESPECTRUM" => self.values.perturb(self.solver),
            b"*IMPERFECTION" => {
                let text = "*IMPERFECTION moves nodes: constraints that need positions are read with those before";
                self.model.warn(card.file, card.line, text);
            }
            b"*CYCLICSYMMETRYMODEL" => self.sectors.push(card.clone()),
            b"*PRE-TENSIONSECTION" if self.solver == Solver::Ccx => self.pre_tension(card)?,
            _ => unread::read(card, &mut self.model, &self.definitions),
        }
        Ok(())
    }

    /// Records a mean rotation, so that its slave can be chosen at the end.
    fn note_mean_rotation(&mut self, equation: usize, nodes: Vec<u32>) {
        let dofs = self.model.nth(equation).columns.iter().map(|&j| self.model.dofs[j as usize]);
        let prescribed = dofs.filter(|dof| self.values.prescribes(*dof)).collect();
        let rule = SlaveRule::MeanRotation(MeanRotation { prescribed, nodes });
        self.chosen.push(ChosenSlave { equation, rule });
    }

    fn pre_tension(&mut self, card: &KeywordCard) -> Result<(), DeckError> {
        let equation = self.model.equations();
        let is_late = self.values.has_begun();
        let (nodes, rule) = pre_tension::read(card, is_late, &mut self.model, &self.definitions)?;
        self.sections.push(nodes);
        self.chosen.extend(rule.map(|rule| ChosenSlave { equation, rule }));
        Ok(())
    }

    /// Leaves out the last `*COUPLING` if no `*KINEMATIC` or `*DISTRIBUTING` followed it.
    fn check_coupling(&mut self) {
        if let Some((file, line)) = self.open_coupling.take() {
            let text = "*COUPLING needs a *KINEMATIC or *DISTRIBUTING after it, and has none: left out";
            self.model.leave_out(file, line, text);
        }
    }

    /// Reads `*KINEMATIC` or `*DISTRIBUTING`, which decides the type of the last `*COUPLING`.
    fn coupled(&mut self, card: &KeywordCard) -> Result<(), DeckError> {
        let Some(coupling) = &self.coupling else { return Ok(()) };
        self.open_coupling = None;
        let constrains = coupling::read(card, coupling, &mut self.model, &self.definitions, self.solver)?;
        if constrains && card.is("*KINEMATIC") && coupling.orientation.is_none() {
            let body = BodyReference::with_rotations(coupling.reference(&self.definitions).unwrap_or_default());
            self.couplings.push(ReadBody { body, file: card.file, line: card.line });
        }
        if !constrains && card.is("*DISTRIBUTING") && self.solver == Solver::Ccx {
            // The default is never used, because `coupling::read` has already checked that the reference exists.
            let reference = coupling.reference(&self.definitions).unwrap_or_default();
            self.forces.push((card.file, card.line, reference));
        }
        Ok(())
    }

    /// Reads the `*CYCLIC SYMMETRY MODEL` cards collected so far. Each belongs to the tie that it names, or else to the only tie.
    fn cyclic_symmetry(&mut self) -> Result<(), DeckError> {
        if self.sectors.is_empty() {
            return Ok(());
        }
        let ties = std::mem::take(&mut self.cyclic);
        for card in std::mem::take(&mut self.sectors) {
            let name = card.word("TIE");
            let named = ties.iter().find(|tie| name.is_some() && tie.word("NAME") == name);
            let only = ties.first().filter(|_| ties.len() == 1);
            if let Some(tie) = named.or(only) {
                let result = cyclic::read(&card, tie, &mut self.model, &self.definitions);
                self.or_left_out(result, &card)?;
            } else {
                let text =
                    "*CYCLIC SYMMETRY MODEL constrains, but no *TIE with CYCLIC SYMMETRY belongs to it: left out";
                self.model.leave_out(card.file, card.line, text);
            }
        }
        Ok(())
    }

    fn finish(mut self) -> Result<Model, DeckError> {
        self.check_coupling();
        self.model.cases.extend(self.values.end_step(&self.removed));
        if self.model.cases.is_empty() {
            let case = self.values.case("model".into(), &self.removed);
            self.model.cases.push(case);
        }
        self.cyclic_symmetry()?;
        for card in std::mem::take(&mut self.cyclic) {
            tie::leave_out(&card, "CYCLIC SYMMETRY", &mut self.model, &self.definitions);
        }
        free_slave::choose(&mut self.model, &self.chosen);
        pre_tension::leave_out_shared(&mut self.model, &self.sections);
        nodes::check(&self.model, &self.definitions)?;
        self.values.say_unknown(&mut self.model);
        self.warn_of_forces();
        if self.solver == Solver::Ccx {
            body_rotations::check(&mut self.model, &self.definitions, &self.bodies, &self.couplings);
            expanded::leave_out(&mut self.model, &self.definitions);
            self.model.nodes_with_axes = self.definitions.nodes_with_axes().collect();
            self.model.keeps_repeated_terms = true;
        }
        // In two cases, cleaning must not remove single nodes from a card. Solvers other than ccx may tie a node-based surface in another
        // way. If the constraints differ between steps, one step may need a node that is redundant in another.
        if self.solver != Solver::Ccx || self.model.cases.windows(2).any(|two| !two[0].constrains_as(&two[1])) {
            self.model.cards.keep_whole();
        }
        self.model.traits.has_local_axes = !self.definitions.transforms.is_empty();
        self.model.traits.is_nonlinear = self.definitions.steps.is_nonlinear;
        self.model.shrink();
        Ok(self.model)
    }

    /// Warns if a motion is prescribed at a reference that only distributes forces.
    fn warn_of_forces(&mut self) {
        for (file, line, node) in std::mem::take(&mut self.forces) {
            let mut given = self.model.cases.iter().flat_map(|case| &case.prescribed);
            if let Some(given) = given.find(|given| given.dof.node == node) {
                let (place, node) = (self.model.place(given.origin), self.model.node_name(node));
                let text = format!(
                    "*DISTRIBUTING only distributes forces in ccx: the value that {place} prescribes at its reference {node} has no effect on the surface"
                );
                self.model.warn(file, line, text);
            }
        }
    }
}

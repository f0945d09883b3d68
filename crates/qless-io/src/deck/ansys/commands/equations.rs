//! Reads the command `CE`: the equation `CONST = sum of C_i U_i`, as commands that add terms, and in the format of archives.
//!
//! ```text
//! CE, NEQN, CONST, NODE1, Lab1, C1, NODE2, Lab2, C2, NODE3, Lab3, C3
//! CE, R5.0, DEFI, terms, NEQN, CONST
//! CE, R5.0, NODE, NODE1, Lab1, C1, NODE2, Lab2, C2
//! ```
//!
//! Later releases write `UNBL` for `R5.0`.

use std::collections::BTreeSet;

use super::numbering::{PastVersion, SearchBudget, StartsAt, StepIndex, delete, numbered, uncertain_deletion};
use crate::deck::ansys::model::numbered::NumberedSets;
use crate::deck::ansys::model::selection::{NodeSelection, SelectedNodes};
use crate::deck::ansys::model::terms::{OwnedTerms, TermStore};
use crate::deck::ansys::syntax::archive::{ArchiveStatement, DofCoefficient};
use crate::deck::ansys::syntax::command::AnsysCommand;
use crate::deck::ansys::syntax::field::{FieldFault, component, expected, is_nothing, real, signed_node, whole};
use crate::deck::{Dof, Problem};
use crate::number;

/// One equation.
#[derive(Debug, Default)]
pub struct CeEquation {
    /// Terms with nonzero coefficients.
    pub terms: OwnedTerms,
    /// The right-hand side.
    pub constant: f64,
    /// The line on which the equation begins.
    pub line: u32,
    /// The line of the equation's last term.
    pub last_line: u32,
    /// The number of terms that an archive command announces for the equation.
    promised: Option<u32>,
    /// Number of terms read, including those with coefficient 0.
    count: u32,
    /// The first load step in which this version of the equation holds.
    from: StepIndex,
    /// One more than the index of the region that generated the equation; 0 for other equations.
    region: u32,
}

impl StartsAt for CeEquation {
    fn from(&self) -> StepIndex {
        self.from
    }
}

/// A region: a `CERIG` or `RBE3` command, which generates equations.
#[derive(Clone, Copy, Debug)]
pub struct NodeRegion {
    /// `CERIG` or `RBE3`.
    pub name: &'static str,
    /// The master node, which field 1 of the command names.
    pub node: u32,
    pub line: u32,
    /// The number of the first equation that the region generates. `last` is that of the last one.
    pub first: u32,
    pub last: u32,
}

/// Limit on the terms of all earlier versions of equations. It bounds the memory.
const PAST_TERMS: usize = 20_000_000;

/// The equations of a deck, each with its number.
#[derive(Debug, Default)]
pub struct CeEquations {
    pub sets: NumberedSets<CeEquation>,
    pub terms: TermStore,
    /// Versions of equations that held in earlier load steps and were changed or deleted since.
    pub past: Vec<PastVersion<CeEquation>>,
    past_terms: usize,
    pub regions: Vec<NodeRegion>,
    /// Number of load steps solved so far.
    pub now: StepIndex,
    /// Numbers of equations that are left out because one of their commands could not be read.
    unknown: BTreeSet<u32>,
    /// Number of the equation that an archive is defining.
    open: u32,
    /// A remark for the user about the last command.
    pub remark: Option<String>,
    /// Why the effect of the last command is uncertain; `None` if it is certain.
    pub doubt: Option<String>,
    budget: SearchBudget,
}

impl CeEquations {
    /// Reads `CE` in plain or archive form. Returns the number of the equation.
    pub fn read(&mut self, command: &AnsysCommand) -> Result<u32, FieldFault> {
        if command.archive_tag().is_none() {
            return self.command(command);
        }
        match command.field(2).to_ascii_uppercase().as_slice() {
            b"DEFI" => self.define(command),
            b"NODE" => self.nodes(command),
            _ => Err(expected(command, 2, "DEFI or NODE")),
        }
    }

    /// Executes `CECMOD, NEQN, CONST`, which changes the constant of an equation.
    pub fn change_constant(&mut self, command: &AnsysCommand) -> Result<u32, FieldFault> {
        let number = whole(command.field(1)).ok_or_else(|| expected(command, 1, "the number of an equation"))?;
        let constant = real(command, 2)?;
        self.keep(number)?;
        self.remark_region(number);
        match self.sets.get_mut(number) {
            Some(equation) => equation.constant = constant,
            None => self.remark = Some(format!("CECMOD changes CE {number}, which is not defined: left out")),
        }
        Ok(number)
    }

    /// Executes `CEDELE, NEQN1, NEQN2, NINC, Nsel`, which deletes equations with selected nodes.
    pub fn delete(&mut self, command: &AnsysCommand, selection: &NodeSelection) -> Result<(), FieldFault> {
        if command.is(1, "ALL") && selection.nodes == SelectedNodes::All {
            self.unknown.clear();
        } else if whole(command.field(1)).is_some_and(|number| self.is_generated(number)) {
            self.remark_region(whole(command.field(1)).unwrap_or_default());
        }
        let nodes = |equation: &CeEquation| self.terms.iter(&equation.terms).map(|(dof, _)| dof.node).collect();
        let items = (&mut self.sets, &mut self.past);
        let uncertain = delete(command, selection, items, self.now, &mut self.budget, nodes)?;
        if !uncertain.is_empty() {
            self.doubt = Some(uncertain_deletion(command));
            self.unknown.extend(uncertain);
        }
        Ok(())
    }

    /// The highest number of an equation so far, also of an equation that is left out; 0 if there is none.
    pub fn highest(&self) -> u32 {
        self.sets.highest().max(self.unknown.last().copied()).unwrap_or(0)
    }

    /// Leaves out a whole equation because one of its commands could not be read.
    pub fn leave_out(&mut self, command: &AnsysCommand) {
        let archived = command.archive_tag().is_some();
        let number = match (archived, command.is(2, "NODE")) {
            (true, true) => Some(self.open),
            (true, false) => whole(command.field(4)),
            _ => numbered(command, 1, self.highest()).ok(),
        };
        let Some(number) = number else { return };
        self.sets.remove(number);
        self.unknown.insert(number);
    }

    /// Adds the equations that a `CERIG` or `RBE3` generates. Their numbers follow the highest number so far. Returns the index of this
    /// region.
    pub fn region(
        &mut self,
        name: &'static str,
        node: u32,
        line: u32,
        equations: impl ExactSizeIterator<Item = Vec<DofCoefficient>>,
    ) -> Result<Option<usize>, Problem> {
        let advice = "number the equations from 1";
        let limit = Problem::Limit { what: "the number of equations", limit: u32::MAX as usize, advice };
        let first = self.highest().checked_add(1).ok_or(limit.clone())?;
        let count = u32::try_from(equations.len()).map_err(|_| limit.clone())?;
        let Some(last) = count.checked_sub(1) else { return Ok(None) };
        let last = first.checked_add(last).ok_or(limit)?;
        self.regions.push(NodeRegion { name, node, line, first, last });
        let (region, from) = (self.regions.len() as u32, self.now);
        for (number, terms) in (first..).zip(equations) {
            let mut equation = CeEquation { line, last_line: line, from, region, ..CeEquation::default() };
            terms.into_iter().for_each(|term| equation.add(term, &mut self.terms));
            self.unknown.remove(&number);
            self.sets.insert(number, equation);
        }
        Ok(Some(self.regions.len() - 1))
    }

    fn is_generated(&mut self, number: u32) -> bool {
        self.sets.get_mut(number).is_some_and(|equation| equation.region > 0)
    }

    /// Records a doubt if `CERIG` or `RBE3` generated the equation: ANSYS does not document how it numbers such equations.
    fn remark_region(&mut self, number: u32) {
        if self.is_generated(number) {
            let text = format!(
                "CE {number} is generated by CERIG or RBE3: this reader assumes an order of such equations, by node and then by component"
            );
            self.doubt = Some(text);
        }
    }

    /// Call this before an equation changes: stores its present version for the earlier load steps, if it held in any.
    fn keep(&mut self, number: u32) -> Result<(), FieldFault> {
        let now = self.now;
        let Some(equation) = self.sets.get_mut(number).filter(|equation| equation.from < now) else { return Ok(()) };
        self.past_terms += self.terms.count(&equation.terms) + 1;
        if self.past_terms > PAST_TERMS {
            let advice = "make a deck for each load step";
            let what = "the number of terms of earlier load steps";
            return Err((None, Problem::Limit { what, limit: PAST_TERMS, advice }));
        }
        let terms = self.terms.copy(&equation.terms);
        let value = CeEquation { terms: std::mem::replace(&mut equation.terms, terms), ..*equation };
        self.past.push(PastVersion { number, last: now - 1, value });
        equation.from = now;
        Ok(())
    }

    /// The first equation with fewer terms than its archive announces.
    pub fn incomplete(&self) -> Option<(u32, u32, Problem)> {
        self.sets.iter().find_map(|(number, equation)| {
            let promised = equation.promised.filter(|&promised| promised > equation.count)? as usize;
            let found = equation.count as usize;
            Some((number, equation.line, Problem::TooFew { what: "terms", promised, found }))
        })
    }

    fn command(&mut self, command: &AnsysCommand) -> Result<u32, FieldFault> {
        let number = numbered(command, 1, self.highest())?;
        if self.unknown.contains(&number) {
            self.doubt =
                Some(format!("CE {number} has a command that could not be read: the whole equation is left out"));
            return Ok(number);
        }
        self.keep(number)?;
        self.remark_region(number);
        let is_new = self.sets.get_mut(number).is_none();
        let constant = if command.field(2).is_empty() { None } else { Some(real(command, 2)?) };
        let equation = self.sets.get_or_insert_with(number, CeEquation::default);
        if is_new {
            (equation.line, equation.from) = (command.line, self.now);
        }
        equation.last_line = command.line;
        if let Some(constant) = constant {
            if !is_new && constant != equation.constant && !is_nothing(command, 3) {
                let before = equation.constant;
                self.remark = Some(format!("the constant of CE {number} was {before} and becomes {constant}"));
            }
            equation.constant = constant;
        }
        let rest = command.fields.iter().skip(11).position(|field| !field.is_empty());
        if let Some(beyond) = rest {
            return Err(expected(command, beyond + 12, "no more than 3 terms in a command (repeat it to add terms)"));
        }
        for at in [3, 6, 9] {
            equation.term(command, at, &mut self.terms, &mut self.budget)?;
        }
        Ok(number)
    }

    fn define(&mut self, command: &AnsysCommand) -> Result<u32, FieldFault> {
        let promised = number::whole(command.field(3)).ok_or_else(|| expected(command, 3, "the number of terms"))?;
        let number = whole(command.field(4)).ok_or_else(|| expected(command, 4, "the number of the equation"))?;
        // Saturates: no deck has more terms than u32 can count.
        let promised = u32::try_from(promised).unwrap_or(u32::MAX);
        self.keep(number)?;
        self.open(promised, number, real(command, 5)?, command.line);
        Ok(number)
    }

    /// Begins an equation that an archive defines; its terms follow on other lines.
    fn open(&mut self, promised: u32, number: u32, constant: f64, line: u32) {
        let promised = Some(promised);
        let equation =
            CeEquation { constant, line, last_line: line, promised, from: self.now, ..CeEquation::default() };
        if self.sets.insert(number, equation).is_some() {
            self.remark = Some(format!("CE {number} is defined again: the later definition counts"));
        }
        self.unknown.remove(&number);
        self.open = number;
    }

    /// Executes a statement that the fast path has read. Returns false if the line must take the general path.
    pub fn quick(&mut self, statement: &ArchiveStatement, line: u32) -> bool {
        match statement {
            ArchiveStatement::Define(promised, number, constant) => self.open(*promised, *number, *constant, line),
            ArchiveStatement::Terms(first, second) => {
                let Some(equation) = self.sets.last_mut(self.open) else { return false };
                let count = equation.count + 1 + u32::from(second.is_some());
                if equation.promised.is_some_and(|promised| count > promised) {
                    return false;
                }
                equation.last_line = line;
                std::iter::once(first).chain(second).for_each(|term| equation.add(*term, &mut self.terms));
            }
        }
        true
    }

    fn nodes(&mut self, command: &AnsysCommand) -> Result<u32, FieldFault> {
        if self.unknown.contains(&self.open) {
            self.doubt =
                Some(format!("CE {} has a command that could not be read: the whole equation is left out", self.open));
            return Ok(self.open);
        }
        let Some(equation) = self.sets.get_mut(self.open) else {
            return Err(expected(command, 2, "DEFI, which begins an equation, before NODE"));
        };
        equation.last_line = command.line;
        for at in (3..=command.fields.len()).step_by(3) {
            let before = equation.count;
            equation.term(command, at, &mut self.terms, &mut self.budget)?;
            let is_beyond = |promised| equation.count > promised;
            if equation.count > before && equation.promised.is_some_and(is_beyond) {
                return Err(expected(command, at, "no more terms than DEFI promises"));
            }
        }
        Ok(self.open)
    }
}

impl CeEquation {
    /// Index of the `CERIG` or `RBE3` that generated the equation, among all regions.
    pub fn region(&self) -> Option<usize> {
        self.region.checked_sub(1).map(|region| region as usize)
    }

    /// Reads a term, `node, label, coefficient`, from field `at` on. A negative node removes all terms of its DOF.
    fn term(
        &mut self,
        command: &AnsysCommand,
        at: usize,
        terms: &mut TermStore,
        budget: &mut SearchBudget,
    ) -> Result<(), FieldFault> {
        if is_nothing(command, at) && command.field(at + 1).is_empty() && is_zero(command, at + 2) {
            return Ok(());
        }
        let (node, is_removed) = signed_node(command, at)?;
        let dof = Dof { node, component: component(command, at + 1)? };
        let coefficient = real(command, at + 2)?;
        if is_removed {
            budget.spend(terms.count(&self.terms)).map_err(|problem| (Some(at), problem))?;
            terms.remove(&mut self.terms, dof);
            return Ok(());
        }
        self.add((dof, coefficient), terms);
        Ok(())
    }

    fn add(&mut self, term: DofCoefficient, terms: &mut TermStore) {
        self.count += 1;
        if term.1 != 0.0 {
            terms.push(&mut self.terms, term);
        }
    }
}

/// Whether field `at` is empty or the number 0; false for a malformed number.
fn is_zero(command: &AnsysCommand, at: usize) -> bool {
    real(command, at).is_ok_and(|value| value == 0.0)
}

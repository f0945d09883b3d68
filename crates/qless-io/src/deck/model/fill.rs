//! Methods with which readers fill a model.

use super::names::RunNames;
use super::storage::OriginRun;
use super::{Dof, Model, Origin, Warning};
use crate::deck::CardName;

impl Model {
    /// Reserves memory for equations and terms.
    pub(crate) fn reserve(&mut self, equations: usize, terms: usize) {
        self.ends.reserve_exact(equations);
        self.terms.columns.reserve_exact(terms);
        self.terms.coefficients.reserve_exact(terms);
        self.dofs.reserve_exact(terms);
    }

    /// Frees unused memory for DOFs: `reserve` allows one DOF for each term, but usually there are fewer.
    pub(crate) fn shrink(&mut self) {
        // Shrinking copies the list, which is not worth a small gain in memory.
        if self.dofs.len() < self.dofs.capacity() / 2 {
            self.dofs.shrink_to_fit();
        }
    }

    /// Adds an equation. Terms are stored as given, with repeated DOFs and zeros.
    pub(crate) fn push(&mut self, terms: impl IntoIterator<Item = (Dof, f64)>, rhs: f64, origin: Origin) {
        let i = self.equations();
        for (position, (dof, coefficient)) in terms.into_iter().enumerate() {
            let next = self.dofs.len() as u32;
            let column = self.columns.get_or_insert(dof, next, position);
            if column == next {
                self.dofs.push(dof);
            }
            self.terms.columns.push(column);
            self.terms.coefficients.push(coefficient);
        }
        self.ends.push(self.terms.columns.len() as u32);
        if rhs != 0.0 {
            self.rhs.resize(i, 0.0);
            self.rhs.push(rhs);
        }
        if !self.runs.last_mut().is_some_and(|run| run.try_extend(i, origin)) {
            self.runs.push(OriginRun { first: i as u32, origin, stride: 0, cards: 0 });
        }
    }

    /// Adds the equations, load cases and warnings of another model. In no load case do equations of both models hold.
    pub(crate) fn append(&mut self, other: &Self) {
        let (cards, own) = (self.cards.len() as u32, self.equations() as u32);
        let moved = |origin: Origin| Origin { card: origin.card + cards, ..origin };
        for card in (0..other.cards.len() as u32).map(|i| other.cards.nth(i)) {
            self.card(card.name, card.file, card.line);
        }
        for equation in (0..other.equations()).map(|i| other.nth(i)) {
            let dofs = equation.columns.iter().map(|&column| other.dofs[column as usize]);
            let terms = dofs.zip(equation.coefficients.iter().copied());
            self.push(terms, equation.rhs, moved(equation.origin));
        }
        let all = self.equations() as u32;
        self.cases.iter_mut().for_each(|case| case.removed.extend(own..all));
        let histories: Vec<u32> = other.histories().map(|name| name.map_or(0, |name| self.history(name))).collect();
        for case in &other.cases {
            let mut case = case.clone();
            for given in case.prescribed.iter_mut().chain(&mut case.clashes) {
                (given.origin, given.history) = (moved(given.origin), histories[given.history as usize]);
            }
            case.loads.iter_mut().for_each(|load| load.origin = moved(load.origin));
            case.removed = (0..own).chain(case.removed.into_iter().map(|i| i + own)).collect();
            self.cases.push(case);
        }
        self.warnings.extend_from_slice(&other.warnings);
    }

    /// Exchanges term `at` of an equation with the first one, and so makes it the slave.
    pub(crate) fn lead(&mut self, equation: usize, at: usize) {
        let start = if equation == 0 { 0 } else { self.ends[equation - 1] as usize };
        self.terms.columns.swap(start, start + at);
        self.terms.coefficients.swap(start, start + at);
    }

    /// Records that the solver does not make this equation, and why.
    pub(crate) fn mark_missing(&mut self, equation: usize, why: &'static str) {
        self.missing.insert(equation, why);
    }

    /// Adds a card and returns its number.
    pub(crate) fn card(&mut self, name: impl Into<CardName>, file: u32, line: u32) -> u32 {
        self.cards.push(name.into(), file, line)
    }

    /// Adds a warning about a line.
    pub(crate) fn warn(&mut self, file: u32, line: u32, text: impl Into<String>) {
        self.warnings.push(Warning { file, line, text: text.into(), leaves_out: false });
    }

    /// Records that a card stops the solver.
    pub(crate) fn refuse(&mut self, file: u32, line: u32, text: impl Into<String>) {
        self.refusals.push(Warning { file, line, text: text.into(), leaves_out: false });
    }

    /// Records that a card constrains but is left out.
    pub(crate) fn leave_out(&mut self, file: u32, line: u32, text: impl Into<String>) {
        self.warnings.push(Warning { file, line, text: text.into(), leaves_out: true });
    }

    /// Sets the DOFs that cards claim, so that these cannot be slaves.
    pub(crate) fn claim(&mut self, mut claims: Vec<(Dof, Origin)>) {
        claims.sort_by_key(|(dof, _)| *dof);
        claims.dedup_by_key(|(dof, _)| *dof);
        self.claims = claims;
    }

    /// Records that the solver enforces the equations of a card by multipliers, so that they have no slaves.
    pub(crate) fn keep_by_multipliers(&mut self, card: u32) {
        self.without_slaves.insert(card);
    }

    /// The index of the time history with this name; adds the history if it is new.
    pub(crate) fn history(&mut self, name: &str) -> u32 {
        let known = self.histories.iter().position(|known| known == name);
        let at = known.unwrap_or_else(|| {
            self.histories.push(name.to_owned());
            self.histories.len() - 1
        });
        at as u32 + 1
    }

    /// Gives names to the nodes of an instance, which are numbered from `first` on. A name consists of the instance and the node's number
    /// in it.
    pub(crate) fn name_nodes(&mut self, first: u32, instance: String, own: Vec<u32>) {
        self.names.insert(first, RunNames::Instance(instance, own));
    }

    /// Gives a name to a node.
    pub(crate) fn name_node(&mut self, node: u32, name: String) {
        self.names.insert(node, RunNames::One(name));
    }

    /// Records the DOFs that a left out card may claim.
    pub(crate) fn claim_left_out(&mut self, dofs: impl IntoIterator<Item = Dof>, origin: Origin) {
        self.left_out_claims.extend(dofs.into_iter().map(|dof| (dof, origin)));
        self.left_out_claims.sort_by_key(|(dof, origin)| (*dof, origin.card, origin.line));
        self.left_out_claims.dedup();
    }
}

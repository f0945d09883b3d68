//! Turns cards that constrain into equations and prescribed values. `reader.rs` calls the module of each card by keyword. This file holds
//! what the modules share: cards in the model, and equations between displacements along any direction.

pub mod body_rotations;
pub mod boundary;
pub mod coupling;
pub mod cyclic;
pub mod equation;
pub mod expanded;
pub mod free_slave;
pub mod mean_rotation;
pub mod mpc;
pub mod old_coupling;
pub mod pre_tension;
pub mod refused;
pub mod rigid;
pub mod tie;
pub mod unread;

use crate::deck::calculix::model::DeckDefinitions;
use crate::deck::calculix::syntax::{KeywordCard, Scope};
use crate::deck::kinematics::vector::{Vector, dot};
use crate::deck::{DeckError, Dof, Model, Origin, Problem};

/// Leaves out a line of a card that needs what this reader does not follow; the other lines of the card count. All other errors stay.
pub fn or_line_left_out<T: Default>(
    result: Result<T, DeckError>,
    file: u32,
    model: &mut Model,
) -> Result<T, DeckError> {
    match result {
        Err(DeckError { problem: problem @ Problem::NotFollowed { .. }, line, card, .. }) => {
            model.leave_out(file, line as u32, format!("{card} constrains, but {problem}: left out"));
            Ok(T::default())
        }
        other => other,
    }
}

/// An equation: its terms, slave first, and its right-hand side.
pub struct CardEquation {
    pub terms: Vec<(Dof, f64)>,
    pub rhs: f64,
}

/// Coefficients below this fraction of the largest one are rounding errors.
const ROUNDING: f64 = 1e-14;

impl CardEquation {
    /// Makes the equation `sum g_k . u_k = rhs` over the nodes k with displacements u_k, in the local axes of each node. `gradients` holds
    /// the nodes and their g_k. The slave is the component of the first node with the largest coefficient.
    pub fn along(definitions: &DeckDefinitions, gradients: &[(u32, Vector)], rhs: f64) -> Result<Self, Problem> {
        Self::along_with(definitions, gradients, &[], rhs)
    }

    /// Makes the equation of [`CardEquation::along`] with the additional terms `others`, which are never the slave.
    pub fn along_with(
        definitions: &DeckDefinitions,
        gradients: &[(u32, Vector)],
        others: &[(Dof, f64)],
        rhs: f64,
    ) -> Result<Self, Problem> {
        let terms = terms(definitions, gradients)?;
        let first = gradients.first().map_or(0, |(node, _)| *node);
        let own = terms.iter().enumerate().filter(|(_, (dof, _))| dof.node == first);
        // If coefficients are equal, the first component is the slave, as in ccx.
        let slave = own.rev().max_by(|a, b| a.1.1.abs().total_cmp(&b.1.1.abs())).map(|(k, _)| k);
        let Some(slave) = slave else {
            return Err(Problem::Degenerate { what: format!("node {first} is not constrained by its geometry") });
        };
        let mut equation = Self { terms, rhs };
        equation.terms.extend(others.iter().filter(|(_, a)| *a != 0.0));
        equation.lead(slave);
        Ok(equation)
    }

    /// Makes `slave` the slave of the equation, if the coefficient of this DOF is as large as that of the present slave.
    pub fn led_by(mut self, slave: Dof) -> Self {
        let at = self.terms.iter().position(|(dof, a)| *dof == slave && a.abs() >= 1.0 - ROUNDING);
        if let Some(at) = at {
            self.lead(at);
        }
        self
    }

    /// Chooses another slave if the present one is in `slaves`: the component of the same node with the largest coefficient that is not in
    /// `slaves`. If there is none, the slave stays.
    pub fn led_by_none_of(mut self, slaves: &[Dof]) -> Self {
        let own = self.terms[0].0;
        if slaves.contains(&own) {
            let is_like = |dof: &Dof| dof.node == own.node && (dof.component <= 3) == (own.component <= 3);
            let is_other = |dof: &Dof| is_like(dof) && !slaves.contains(dof);
            let others = self.terms.iter().enumerate().filter(|(_, (dof, _))| is_other(dof));
            let most = others.rev().max_by(|a, b| a.1.1.abs().total_cmp(&b.1.1.abs())).map(|(at, _)| at);
            if let Some(at) = most {
                self.lead(at);
            }
        }
        self
    }

    fn lead(&mut self, at: usize) {
        self.terms.swap(0, at);
        let scale = self.terms[0].1;
        self.terms.iter_mut().for_each(|(_, a)| *a /= scale);
        self.rhs /= scale;
    }
}

/// The terms of `sum g_k . u_k` over the nodes k with displacements u_k, in the order of the nodes and in the local axes of each node.
/// `gradients` holds the nodes and their g_k. Coefficients that are rounding errors are dropped.
fn terms(definitions: &DeckDefinitions, gradients: &[(u32, Vector)]) -> Result<Vec<(Dof, f64)>, Problem> {
    let mut terms: Vec<(Dof, f64)> = Vec::with_capacity(3 * gradients.len());
    for &(node, gradient) in gradients {
        let axes = definitions.axes(node)?;
        let component = |(axis, component): (&Vector, u8)| (Dof { node, component }, dot(*axis, gradient));
        terms.extend(axes.iter().zip(1..).map(component));
    }
    let largest = terms.iter().fold(0.0_f64, |largest, (_, a)| largest.max(a.abs()));
    terms.retain(|(_, a)| a.abs() > ROUNDING * largest);
    Ok(terms)
}

/// A card that was added to the model, so that equations can be added to it.
pub struct RegisteredCard {
    pub origin: Origin,
}

impl RegisteredCard {
    /// Adds the card to the model under `name`.
    pub fn register(card: &KeywordCard, model: &mut Model, name: &'static str) -> Self {
        let number = model.card(name, card.file, card.line);
        let last = card.lines().filter(|line| line.file == card.file).last().map_or(card.line, |line| line.number);
        let lines = (last + 1).saturating_sub(card.line).max(1);
        // All instances share the text of their Abaqus part, so the text cannot change for one instance alone.
        model.cards.mark_irreplaceable(number, card.scope != Scope::DECK);
        Self { origin: Origin { card: number, line: card.line, lines } }
    }

    /// An error of the card, at its keyword line.
    pub fn fail(&self, model: &Model, problem: Problem) -> DeckError {
        model.error(self.origin, None, problem)
    }

    /// Adds the equations in `rows` to the model. If `rows` is a problem, returns it as an error of the card.
    pub fn push(&self, model: &mut Model, rows: Result<Vec<CardEquation>, Problem>) -> Result<(), DeckError> {
        for row in rows.map_err(|problem| self.fail(model, problem))? {
            model.push(row.terms, row.rhs, self.origin);
        }
        Ok(())
    }

    /// Marks the card: equations cannot replace it in the deck.
    pub fn mark_irreplaceable(&self, model: &mut Model) {
        model.cards.mark_irreplaceable(self.origin.card, true);
    }
}

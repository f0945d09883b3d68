//! Plans the changes of a deck.
//!
//! Load case k has the equations `E_k` and the prescribed DOFs `P_k`. In each load case, the equations that are kept or written span the
//! same space as `E_k`. They are independent even without the columns of `P_k`, and they have distinct slaves outside `P_k`. Edits of cards
//! are preferred (`card_edits`). If edits do not suffice, equations are rewritten.

mod card_edits;
mod edit;
mod error;
mod layers;
mod solved;
mod steps;
mod subcases;

use std::sync::Arc;

use qless::Options;

use crate::deck::faults::EquationFault;
use crate::deck::{Deck, Dof, Format, Model, Origin};

pub(super) use card_edits::shortened;
pub(super) use edit::Edits;
pub use error::CleanError;
pub(crate) use error::Renamed;
pub(super) use steps::conflicts;

/// The changes of a deck: which equations are removed, and which are written.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plan {
    /// The equations that are removed from the text, ascending.
    pub removed: Vec<Removed>,
    /// The equations that are added to the text.
    pub written: Vec<Written>,
    /// The equations that stay in the text but end after some load case, ascending.
    pub ended: Vec<Ended>,
}

/// An equation that is removed from the text.
#[derive(Clone, Debug, PartialEq)]
pub struct Removed {
    /// The index of the equation, from 0.
    pub equation: usize,
    /// Why the equation is removed.
    pub reason: Reason,
}

/// Why an equation is removed from the text.
#[derive(Clone, Debug, PartialEq)]
pub enum Reason {
    /// The equation is a combination of others and of prescribed DOFs.
    Redundant(Combination),
    /// The equation is rewritten because it has this fault.
    Fault(EquationFault),
    /// The equation is rewritten because another equation of its connected component is rewritten.
    Connected,
}

/// What gives a dependent equation.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Combination {
    /// The kept equations (by index from 0), each with its coefficient. Empty if the dependent equation has no free DOF.
    pub equations: Vec<(usize, f64)>,
    /// The prescribed DOFs in which the sum of these equations differs from the dependent equation, each with its card.
    pub prescribed: Vec<(Dof, Origin)>,
}

/// A new equation, `slave + sum a_j u_j = rhs`.
#[derive(Clone, Debug, PartialEq)]
pub struct Written {
    /// The slave, whose coefficient is 1.
    pub slave: Dof,
    /// The terms besides the slave: each coefficient a_j with the DOF of u_j. Masters come first, then prescribed DOFs.
    pub terms: Vec<(Dof, f64)>,
    /// The right-hand side.
    pub rhs: f64,
    /// The load cases in which the equation holds.
    pub cases: Cases,
}

/// A set of load cases, which are numbered from 0.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Cases {
    /// All load cases.
    #[default]
    All,
    /// All load cases up to this one, included.
    UpTo(usize),
    /// Only these load cases, ascending.
    Only(Arc<[usize]>),
}

impl Cases {
    /// Whether the set contains load case `k`.
    pub fn contain(&self, k: usize) -> bool {
        match self {
            Self::All => true,
            Self::UpTo(last) => k <= *last,
            Self::Only(cases) => cases.binary_search(&k).is_ok(),
        }
    }
}

/// An equation that stays in the text but does not hold in the later load cases.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ended {
    /// The index of the equation, from 0.
    pub equation: usize,
    /// The index of the last load case in which the equation holds.
    pub last: usize,
}

impl Plan {
    /// Whether the plan changes nothing.
    pub fn is_empty(&self) -> bool {
        self.removed.is_empty() && self.ended.is_empty()
    }

    /// Checks that the removed and ended equations exist, that the removed ones ascend, and that explanations refer to existing equations.
    pub(super) fn check(&self, model: &Model) -> Result<(), CleanError> {
        let count = model.equations();
        let mut next = 0;
        for removed in &self.removed {
            let because = match &removed.reason {
                Reason::Redundant(because) => because.equations.iter().map(|&(i, _)| i).max(),
                Reason::Fault(_) | Reason::Connected => None,
            };
            let named = because.into_iter().chain([removed.equation]).find(|&i| i >= count);
            let outside = named.or((removed.equation < next).then_some(removed.equation));
            outside.map_or(Ok(()), |equation| Err(CleanError::Foreign { equation, count }))?;
            next = removed.equation + 1;
        }
        let foreign = self.ended.iter().find(|ended| ended.equation >= count);
        foreign.map_or(Ok(()), |ended| Err(CleanError::Foreign { equation: ended.equation, count }))
    }
}

/// Plans the changes after which, in every load case, the equations in force are independent, no DOF is the slave of two
/// equations, and no slave is prescribed.
///
/// # Errors
/// [`CleanError`] if the deck stops the solver, if equations conflict, if no single deck can serve all load cases, or if a card cannot be
/// replaced.
///
/// ```
/// # let place = tempfile::tempdir()?;
/// let path = place.path().join("tie.inp");
/// std::fs::write(&path, "*EQUATION\n2\n1,1,1.,2,1,-1.\n2\n2,1,3.,1,1,-3.\n")?;
/// let deck = qless_io::deck::read(&path)?;
/// let plan = qless_io::deck::clean::plan(&deck, &qless::Options::default())?;
/// assert_eq!((plan.removed[0].equation, plan.written.len()), (1, 0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn plan(deck: &Deck, options: &Options) -> Result<Plan, CleanError> {
    plan_with(deck, PlanOptions { options, edits_cards: true, explains: true })
}

/// Checks whether [`clean`](super::clean::clean) can make a plan, which takes a few analyses. First tries to rewrite equations, which is
/// possible even if no edit of cards helps. Tries edits of cards only if that fails.
///
/// # Errors
/// As [`plan`].
pub fn check_plan(deck: &Deck, options: &Options) -> Result<(), CleanError> {
    let made = |edits_cards| plan_with(deck, PlanOptions { options, edits_cards, explains: false }).map(drop);
    made(false).or_else(|_| made(true))
}

/// Options of a plan.
#[derive(Clone, Copy)]
pub(super) struct PlanOptions<'a> {
    pub options: &'a Options,
    /// Whether edits of cards are preferred to rewritten equations.
    pub edits_cards: bool,
    /// Whether the reasons hold certificates. Certificates cost more than all the rest of a plan.
    pub explains: bool,
}

/// Like [`plan`], with or without a preference for edits of cards.
pub(super) fn plan_with(deck: &Deck, options: PlanOptions) -> Result<Plan, CleanError> {
    let model = &deck.model;
    if let Some(refusal) = model.refusals().first() {
        return Err(CleanError::Refused { place: model.place_of(refusal), why: refusal.text.clone() });
    }
    let plan = match deck.format() {
        // A nonlinear step must not remove equations: CalculiX then crashes at random.
        Format::Calculix if model.traits.is_nonlinear => steps::plan(deck, options, steps::LateRemoval::Impossible)?,
        Format::Calculix => steps::plan(deck, options, steps::LateRemoval::Possible)?,
        Format::Ansys => steps::plan(deck, options, steps::LateRemoval::Impossible)?,
        Format::Nastran => subcases::plan(deck, options)?,
        format @ (Format::LsDyna | Format::Radioss) => return Err(CleanError::ReadOnly { format }),
    };
    check_removable(model, &plan.removed)?;
    Ok(plan)
}

/// Checks that no removed equation belongs to a card that equations cannot replace. If several do, the error names one with a fault of its
/// own, if possible.
fn check_removable(model: &Model, removed: &[Removed]) -> Result<(), CleanError> {
    let card = |removed: &Removed| model.nth(removed.equation).origin.card;
    let weight = |reason: &Reason| match reason {
        Reason::Fault(_) => 0,
        Reason::Redundant(_) => 1,
        Reason::Connected => 2,
    };
    let fixed = removed.iter().filter(|removed| model.cards.nth(card(removed)).is_fixed);
    let Some(first) = fixed.min_by_key(|removed| weight(&removed.reason)) else { return Ok(()) };
    let fault = match &first.reason {
        Reason::Fault(fault) => fault.describe(model),
        Reason::Redundant(_) => "it is redundant with other such cards".to_owned(),
        Reason::Connected => "an equation that shares DOFs with it must be replaced".to_owned(),
    };
    let why = match model.cards.why_fixed(card(first)) {
        Some(why) => format!("{fault}; {why}"),
        None => fault,
    };
    Err(CleanError::Fixed { place: model.place(model.nth(first.equation).origin), why })
}

/// Largest number of equations of a certificate, and of prescribed DOFs, that a comment names.
const NAMED: usize = 8;

/// Says why an equation is removed, for a comment in the written deck. If the equation is no combination of others, `now` says what becomes
/// of it.
pub(super) fn reason(model: &Model, removed: &Removed, now: &str) -> String {
    match &removed.reason {
        Reason::Redundant(because) if because.equations.is_empty() => {
            format!("removed: all of its DOFs are prescribed{}", given(model, &because.prescribed, " ("))
        }
        Reason::Redundant(because) => {
            let term = |(k, &(i, c)): (usize, &(usize, f64))| {
                let sign = match (k, c < 0.0) {
                    (0, false) => "",
                    (0, true) => "-",
                    (_, false) => " + ",
                    (_, true) => " - ",
                };
                // Twelve digits suffice, and hide the rounding error in the last digits.
                let size: f64 = format!("{:.11e}", c.abs()).parse().unwrap_or(c.abs());
                format!("{sign}{size} * ({})", model.label_of(i))
            };
            let terms: String = because.equations.iter().take(NAMED).enumerate().map(term).collect();
            let more = because.equations.len().saturating_sub(NAMED);
            let more = if more > 0 { format!(" + {more} more") } else { String::new() };
            let given = given(model, &because.prescribed, ", with prescribed DOFs (");
            format!("removed, redundant: {} = {terms}{more}{given}", model.label_of(removed.equation))
        }
        Reason::Fault(fault) => format!("{now}: {}", fault.describe(model)),
        Reason::Connected => format!("{now}: it shares DOFs with equations that are {now} too"),
    }
}

/// Prescribed DOFs after `start`, and a closing bracket: `, with prescribed DOFs (3:1 in line 20 *BOUNDARY)`. Empty if there are none.
fn given(model: &Model, prescribed: &[(Dof, Origin)], start: &str) -> String {
    if prescribed.is_empty() {
        return String::new();
    }
    let name = |&(dof, origin): &(Dof, Origin)| format!("{} in {}", model.dof_name(dof), model.place(origin));
    let names: Vec<String> = prescribed.iter().take(NAMED).map(name).collect();
    let more = prescribed.len().saturating_sub(NAMED);
    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
    format!("{start}{}{more})", names.join(", "))
}

#[cfg(test)]
mod tests {
    use super::Cases;

    #[test]
    fn sets_contain_their_load_cases() {
        let list = |cases: &Cases| (0..5).filter(|&k| cases.contain(k)).collect::<Vec<_>>();
        assert_eq!(list(&Cases::All), [0, 1, 2, 3, 4]);
        assert_eq!(list(&Cases::UpTo(2)), [0, 1, 2]);
        assert_eq!(list(&Cases::Only([1, 3].into())), [1, 3]);
    }
}

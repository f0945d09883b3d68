//! Plans the changes of a deck.
//!
//! Load case k has the equations `E_k` and the prescribed DOFs `P_k`. In each case, the equations kept or written are
//! independent without `P_k`, span the same space as `E_k`, and have distinct slaves outside `P_k`. Edits of cards are preferred
//! (`card_edits`). If edits do not suffice, equations are rewritten.

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
use crate::deck::{Deck, Dof, Format, Model};

pub(super) use card_edits::shortened;
pub(super) use edit::Edits;
pub use error::CleanError;
pub(crate) use error::Renamed;
pub(super) use steps::conflicts;

/// Changes of a deck: equations removed and equations written.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plan {
    /// Equations removed from the text, ascending.
    pub removed: Vec<Removed>,
    /// New equations.
    pub written: Vec<Written>,
    /// Equations that stay in the text but end after a load case, ascending.
    pub ended: Vec<Ended>,
}

/// An equation removed from the text.
#[derive(Clone, Debug, PartialEq)]
pub struct Removed {
    /// Its number, from 0.
    pub equation: usize,
    /// Why it is removed.
    pub reason: Reason,
}

/// Why an equation is removed from the text.
#[derive(Clone, Debug, PartialEq)]
pub enum Reason {
    /// It is dependent: this combination of others, as equation (from 0) and coefficient. Empty if the equation has no
    /// free DOF.
    Redundant(Vec<(usize, f64)>),
    /// It is rewritten because of this fault.
    Fault(EquationFault),
    /// It is rewritten because another equation of its part is.
    Connected,
}

/// `slave + sum a_j u_j = rhs`.
#[derive(Clone, Debug, PartialEq)]
pub struct Written {
    /// The slave; its coefficient is 1.
    pub slave: Dof,
    /// The other terms: masters, then prescribed DOFs.
    pub terms: Vec<(Dof, f64)>,
    /// The right-hand side.
    pub rhs: f64,
    /// Load cases in which it holds.
    pub cases: Cases,
}

/// A set of load cases, by number from 0.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Cases {
    /// All load cases.
    #[default]
    All,
    /// The first load cases, up to this one.
    UpTo(usize),
    /// These load cases, ascending.
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

/// An equation that ends after a load case.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ended {
    /// Its number, from 0.
    pub equation: usize,
    /// The last load case in which it holds.
    pub last: usize,
}

impl Plan {
    /// Whether the plan changes nothing.
    pub fn is_empty(&self) -> bool {
        self.removed.is_empty() && self.ended.is_empty()
    }

    /// Checks that the equations of the plan exist and ascend, and that its explanations refer to existing equations.
    pub(super) fn check(&self, model: &Model) -> Result<(), CleanError> {
        let count = model.equations();
        let mut next = 0;
        for removed in &self.removed {
            let because = match &removed.reason {
                Reason::Redundant(because) => because.iter().map(|&(i, _)| i).max(),
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
/// [`CleanError`]: a deck that stops the solver, conflicting equations, load cases that no single deck serves, or
/// cards that cannot be replaced.
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

/// Whether [`clean`](super::clean::clean) has a plan; costs a few analyses. Equations can be rewritten if no edit of cards serves, so edits
/// are tried only if that fails.
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
    /// Whether edits of cards are preferred.
    pub edits_cards: bool,
    /// Whether reasons have certificates, which cost more than all else.
    pub explains: bool,
}

/// [`plan`] with or without a preference for edits of cards.
pub(super) fn plan_with(deck: &Deck, options: PlanOptions) -> Result<Plan, CleanError> {
    let model = &deck.model;
    if let Some(refusal) = model.refusals().first() {
        return Err(CleanError::Refused { place: model.place_of(refusal), why: refusal.text.clone() });
    }
    let plan = match deck.format() {
        // CalculiX crashes at random if a nonlinear step removes equations.
        Format::Calculix if model.traits.is_nonlinear => steps::plan(deck, options, steps::LateRemoval::Impossible)?,
        Format::Calculix => steps::plan(deck, options, steps::LateRemoval::Possible)?,
        Format::Ansys => steps::plan(deck, options, steps::LateRemoval::Impossible)?,
        Format::Nastran => subcases::plan(deck, options)?,
        Format::LsDyna => return Err(CleanError::ReadOnly { format: Format::LsDyna }),
    };
    check_removable(model, &plan.removed)?;
    Ok(plan)
}

/// Checks that no removed equation belongs to a card that equations cannot replace. Faults of the card itself are
/// reported first.
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

/// Most equations of a certificate that a comment names.
const NAMED: usize = 8;

/// Why an equation is removed, for a comment in the written deck; `now` says what becomes of the claim of an equation that is no
/// combination of others.
pub(super) fn reason(model: &Model, removed: &Removed, now: &str) -> String {
    match &removed.reason {
        Reason::Redundant(because) if because.is_empty() => "removed: all of its DOFs are prescribed".to_owned(),
        Reason::Redundant(because) => {
            let term = |(k, &(i, c)): (usize, &(usize, f64))| {
                let sign = match (k, c < 0.0) {
                    (0, false) => "",
                    (0, true) => "-",
                    (_, false) => " + ",
                    (_, true) => " - ",
                };
                // Twelve digits, so that rounding in the last ones does not show.
                let size: f64 = format!("{:.11e}", c.abs()).parse().unwrap_or(c.abs());
                format!("{sign}{size} * ({})", model.label_of(i))
            };
            let terms: String = because.iter().take(NAMED).enumerate().map(term).collect();
            let more = because.len().saturating_sub(NAMED);
            let more = if more > 0 { format!(" + {more} more") } else { String::new() };
            format!("removed, redundant: {} = {terms}{more}", model.label_of(removed.equation))
        }
        Reason::Fault(fault) => format!("{now}: {}", fault.describe(model)),
        Reason::Connected => format!("{now}: it shares DOFs with equations that are {now} too"),
    }
}

//! The constraints of a deck of any format: equations, the prescribed values of each load case, and where both come from.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

use rustc_hash::FxHashMap;

use super::Cards;
use constraints::DeckTraits;
pub use constraints::{DeckEquation, Dof, Load, LoadCase, Origin, Prescribed, Warning};
use names::NodeNames;
use storage::{ColumnMap, OriginRun, TermStorage};

mod constraints;
mod fill;
mod names;
mod storage;
mod system;

/// The constraints of a deck.
#[derive(Clone, Debug, Default)]
pub struct Model {
    pub(crate) files: Vec<PathBuf>,
    pub(crate) cards: Cards,
    pub(crate) dofs: Vec<Dof>,
    pub(crate) cases: Vec<LoadCase>,
    pub(crate) warnings: Vec<Warning>,
    pub(crate) refusals: Vec<Warning>,
    /// Rotations that the solver adds for rigid bodies and that a new node can carry. Each is given by the first of its three components.
    pub(crate) own_rotations: BTreeSet<Dof>,
    pub(crate) traits: DeckTraits,
    /// Whether load cases are independent: none inherits values from earlier ones.
    pub(crate) has_separate_cases: bool,
    /// The names of the time histories, without the first one, which has no name.
    histories: Vec<String>,
    names: NodeNames,
    /// DOFs that left out cards may claim, ascending, each with the origin of its card.
    left_out_claims: Vec<(Dof, Origin)>,
    /// DOFs that cards claim, each with the origin of its card, so that they cannot be slaves; ascending.
    claims: Vec<(Dof, Origin)>,
    /// Nodes with local axes. If a value is prescribed at such a node, the slaves that ccx chooses there cannot be predicted.
    pub(crate) nodes_with_axes: BTreeSet<u32>,
    /// Whether the solver may fail to add up two terms of an equation that have the same DOF.
    pub(crate) keeps_repeated_terms: bool,
    /// Cards whose equations have no slaves, because the solver enforces them by multipliers.
    without_slaves: BTreeSet<u32>,
    /// Equations that the solver does not make, each with the reason.
    missing: BTreeMap<usize, &'static str>,
    columns: ColumnMap,
    terms: TermStorage,
    /// For each equation, the end of its terms in `terms`.
    ends: Vec<u32>,
    /// The right-hand sides of the equations, up to the last one that is not zero.
    rhs: Vec<f64>,
    runs: Vec<OriginRun>,
}

impl Model {
    /// An empty model of these files.
    pub(crate) fn new(files: Vec<PathBuf>) -> Self {
        Self { files, ..Self::default() }
    }

    /// Files of the deck, the main file first.
    pub fn files(&self) -> &[PathBuf] {
        &self.files
    }

    /// Cards that constrain, in the order of the deck.
    pub fn cards(&self) -> &Cards {
        &self.cards
    }

    /// The DOFs that occur in equations. The index of a DOF is its column.
    pub fn dofs(&self) -> &[Dof] {
        &self.dofs
    }

    /// The load cases, at least one.
    pub fn cases(&self) -> &[LoadCase] {
        &self.cases
    }

    /// Warnings, for example that a card is not understood or that equations are not exact.
    pub fn warnings(&self) -> &[Warning] {
        &self.warnings
    }

    /// Messages about cards at which the solver stops when it reads the deck, whatever their equations are.
    ///
    /// ```
    /// # let place = tempfile::tempdir()?;
    /// let path = place.path().join("late.inp");
    /// std::fs::write(&path, "*STEP\n*EQUATION\n2\n1,1,1.,2,1,-1.\n*END STEP\n")?;
    /// let deck = qless_io::deck::read(&path)?;
    /// assert!(deck.model().refusals()[0].text.starts_with("ccx stops: *EQUATION follows the start of a step"));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn refusals(&self) -> &[Warning] {
        &self.refusals
    }

    /// Names of the time histories of prescribed values. The first one is the solver's standard history and has no name. The others are
    /// amplitudes.
    pub fn histories(&self) -> impl Iterator<Item = Option<&str>> {
        std::iter::once(None).chain(self.histories.iter().map(|name| Some(name.as_str())))
    }

    /// Warnings about constraints that were left out. If there are any, results for the constraints that were read may not hold for the
    /// whole deck.
    pub fn left_out(&self) -> impl Iterator<Item = &Warning> {
        self.warnings.iter().filter(|warning| warning.leaves_out)
    }

    /// Number of equations.
    pub fn equations(&self) -> usize {
        self.ends.len()
    }

    /// Number of terms of all equations, zero coefficients included.
    pub fn terms(&self) -> usize {
        self.terms.columns.len()
    }

    /// Equation `i`, from 0; `None` if it does not exist.
    pub fn equation(&self, i: usize) -> Option<DeckEquation<'_>> {
        (i < self.equations()).then(|| self.nth(i))
    }

    /// Equation `i`, which must exist.
    pub(crate) fn nth(&self, i: usize) -> DeckEquation<'_> {
        let range = if i == 0 { 0 } else { self.ends[i - 1] as usize }..self.ends[i] as usize;
        let run = self.runs[self.runs.partition_point(|run| run.first <= i as u32) - 1];
        DeckEquation {
            columns: &self.terms.columns[range.clone()],
            coefficients: &self.terms.coefficients[range],
            rhs: self.rhs.get(i).copied().unwrap_or(0.0),
            origin: run.at(i),
        }
    }

    /// The column of a DOF; `None` if the DOF occurs in no equation.
    pub fn column(&self, dof: Dof) -> Option<u32> {
        self.columns.get(dof)
    }

    /// The card that claims a DOF, such as Nastran's `ASET`, and its line. A claimed DOF cannot be a slave. `None` if no card claims it.
    pub fn claimed(&self, dof: Dof) -> Option<Origin> {
        self.claims.binary_search_by_key(&dof, |(claimed, _)| *claimed).ok().map(|at| self.claims[at].1)
    }

    /// Whether another card claims a DOF, also a card that is left out. The DOF must not become the slave of a new equation.
    pub(crate) fn is_claimed(&self, dof: Dof) -> bool {
        let is_left_out = || self.left_out_claims.binary_search_by_key(&dof, |(claimed, _)| *claimed).is_ok();
        self.claimed(dof).is_some() || is_left_out()
    }

    /// Whether the first term of equation `i` is a slave. An equation that the solver enforces by a multiplier has no slave.
    pub fn has_slave(&self, i: usize) -> bool {
        self.without_slaves.is_empty() || !self.without_slaves.contains(&self.nth(i).origin.card)
    }

    /// Why the solver does not make equation `i`; `None` if it does.
    pub(crate) fn why_missing(&self, i: usize) -> Option<&'static str> {
        self.missing.get(&i).copied()
    }

    /// DOFs that left out cards may claim, ascending, each with the origin of the claim. New equations must not have them as slaves.
    pub fn left_out_claims(&self) -> &[(Dof, Origin)] {
        &self.left_out_claims
    }

    /// The indices of the equations that are in force in a load case.
    pub fn in_force(&self, case: &LoadCase) -> impl Iterator<Item = usize> + '_ {
        let removed = case.removed.clone();
        (0..self.equations()).filter(move |&i| removed.binary_search(&(i as u32)).is_err())
    }

    /// The columns that are prescribed in any of these load cases, each with the origin of its value.
    pub(crate) fn prescribed_in<'a>(&self, cases: impl IntoIterator<Item = &'a LoadCase>) -> FxHashMap<u32, Origin> {
        let mut prescribed = FxHashMap::default();
        for given in cases.into_iter().flat_map(|case| &case.prescribed) {
            if let Some(column) = self.column(given.dof) {
                prescribed.entry(column).or_insert(given.origin);
            }
        }
        prescribed
    }

    /// Returns the DOF itself, except for a translation of a node with local axes. That becomes component 0, which stands for all three
    /// global translations of the node.
    pub(crate) fn as_global(&self, dof: Dof) -> Dof {
        let has_axes = (1..=3).contains(&dof.component) && self.nodes_with_axes.contains(&dof.node);
        if has_axes { Dof { component: 0, ..dof } } else { dof }
    }
}

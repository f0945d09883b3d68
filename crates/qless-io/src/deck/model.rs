//! What a deck constrains, whatever its format: equations on DOFs, prescribed values by load case, and where each stands.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use super::columns::Columns;
use super::node_names::NodeNames;
use super::{CardName, Cards, DeckError};

/// One component of one node; `node:component` in reports.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Dof {
    /// The node's number in the deck.
    pub node: u32,
    /// 1 to 3 translations, 4 to 6 rotations, others as the format has them.
    pub component: u8,
}

impl std::fmt::Display for Dof {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}:{}", self.node, self.component)
    }
}

/// Where something is said: a card, and the lines of it, from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Origin {
    /// Index into [`Model::cards`].
    pub card: u32,
    /// First line.
    pub line: u32,
    /// How many lines.
    pub lines: u32,
}

/// One equation `sum a_j u_j = rhs`; its first term is the slave in formats that name one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Equation<'a> {
    /// Columns, which are indices into [`Model::dofs`], and coefficients; a zero one keeps its place.
    pub columns: &'a [u32],
    /// Coefficients, in the order of `columns`.
    pub coefficients: &'a [f64],
    /// The right-hand side.
    pub rhs: f64,
    /// Where it stands.
    pub origin: Origin,
}

/// A DOF with a given value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prescribed {
    /// The DOF.
    pub dof: Dof,
    /// Its value; at a time `t`, this times the course at `t`.
    pub value: f64,
    /// How the value runs in time: index into [`Model::courses`].
    pub course: u32,
    /// Where that is said.
    pub origin: Origin,
}

/// A loaded DOF.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Load {
    /// The DOF.
    pub dof: Dof,
    /// Where that is said.
    pub origin: Origin,
}

/// What holds at the same time: a step or a subcase.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LoadCase {
    /// `step 1`, `subcase 2`.
    pub name: String,
    /// Prescribed DOFs, ascending, each once.
    pub prescribed: Vec<Prescribed>,
    /// Further values of prescribed DOFs that contradict those in `prescribed`.
    pub clashes: Vec<Prescribed>,
    /// Loads.
    pub loads: Vec<Load>,
    /// Equations that are not in force, ascending.
    pub removed: Vec<u32>,
}

impl LoadCase {
    /// Whether the same holds in another load case, apart from loads.
    pub fn constrains_as(&self, other: &Self) -> bool {
        self.prescribed == other.prescribed && self.clashes == other.clashes && self.removed == other.removed
    }
}

/// Something that the user should know.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Warning {
    /// Index into [`Model::files`].
    pub file: u32,
    /// The line, from 1; 0 if it concerns no line.
    pub line: u32,
    /// What, in one sentence.
    pub text: String,
    /// Whether something that constrains was left out, so that the model is incomplete.
    pub leaves_out: bool,
}

/// What a deck says once for all of it, where solvers go by it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Traits {
    /// Whether some nodes have axes of their own.
    pub(super) has_local_axes: bool,
    /// Whether a step is geometrically nonlinear.
    pub(super) is_nonlinear: bool,
    /// Whether a kinematic coupling has axes of its own.
    pub(super) has_turned_couplings: bool,
}

/// The constraints of a deck.
#[derive(Clone, Debug, Default)]
pub struct Model {
    pub(super) files: Vec<PathBuf>,
    pub(super) cards: Cards,
    pub(super) dofs: Vec<Dof>,
    pub(super) cases: Vec<LoadCase>,
    pub(super) warnings: Vec<Warning>,
    pub(super) refusals: Vec<Warning>,
    /// Rotations that the solver makes for bodies: the first of three components of the reference node.
    pub(super) own_rotations: BTreeSet<Dof>,
    pub(super) traits: Traits,
    /// Whether a load case takes nothing over from those before it.
    pub(super) has_separate_cases: bool,
    /// Names of the courses after the first.
    courses: Vec<String>,
    names: NodeNames,
    /// Ascending by DOF.
    left_out_claims: Vec<(Dof, Origin)>,
    /// DOFs that cards put where no slave may be, ascending.
    claims: Vec<(Dof, Origin)>,
    /// Nodes with axes of their own: where one of their DOFs is prescribed, ccx takes slaves there as it likes.
    pub(super) turned: BTreeSet<u32>,
    /// Whether the solver does not always add up terms of an equation that name a DOF twice.
    pub(super) keeps_repeated_terms: bool,
    /// Cards whose equations the solver keeps by multipliers: none of their DOFs is a slave.
    without_slaves: BTreeSet<u32>,
    columns: Columns,
    terms: Terms,
    /// Where the terms of each equation end.
    ends: Vec<u32>,
    /// Right-hand sides up to the last that is not zero.
    rhs: Vec<f64>,
    runs: Vec<Run>,
}

/// Equations from `first` on that follow each other evenly: equation `first + k` is that of `origin`, `k stride` lines and
/// `k cards` cards further on.
#[derive(Clone, Copy, Debug)]
struct Run {
    first: u32,
    origin: Origin,
    stride: u32,
    cards: u32,
}

impl Run {
    /// Where equation `i` stands.
    fn at(&self, i: usize) -> Origin {
        let further = |from: u32, stride: u32| from.wrapping_add((i as u32 - self.first).wrapping_mul(stride));
        let Origin { card, line, lines } = self.origin;
        Origin { card: further(card, self.cards), line: further(line, self.stride), lines }
    }

    /// Takes equation `i` in, if it follows; the second one sets the strides.
    fn take(&mut self, i: usize, origin: Origin) -> bool {
        if self.first + 1 == i as u32 {
            self.stride = origin.line.wrapping_sub(self.origin.line);
            self.cards = origin.card.wrapping_sub(self.origin.card);
        }
        self.at(i) == origin
    }
}

#[derive(Clone, Debug, Default)]
struct Terms {
    columns: Vec<u32>,
    coefficients: Vec<f64>,
}

impl Model {
    /// A model without equations or load cases, of these files.
    pub(super) fn new(files: Vec<PathBuf>) -> Self {
        Self { files, ..Self::default() }
    }

    /// The files read, the main one first.
    pub fn files(&self) -> &[PathBuf] {
        &self.files
    }

    /// Cards that constrain, in the order met.
    pub fn cards(&self) -> &Cards {
        &self.cards
    }

    /// DOFs that occur in equations, by column.
    pub fn dofs(&self) -> &[Dof] {
        &self.dofs
    }

    /// Load cases; at least one.
    pub fn cases(&self) -> &[LoadCase] {
        &self.cases
    }

    /// What was not understood or not exact.
    pub fn warnings(&self) -> &[Warning] {
        &self.warnings
    }

    /// What the solver stops at when it reads the deck, whatever its equations say.
    ///
    /// ```
    /// # let place = tempfile::tempdir()?;
    /// let path = place.path().join("late.inp");
    /// std::fs::write(&path, "*STEP\n*EQUATION\n2\n1,1,1.,2,1,-1.\n*END STEP\n")?;
    /// let deck = qless_io::deck::read(&path)?;
    /// assert!(deck.model().refusals()[0].text.starts_with("ccx stops: *EQUATION stands after a step begins"));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn refusals(&self) -> &[Warning] {
        &self.refusals
    }

    /// How prescribed values run in time: 0 is the solver's standard course, which has no name; others have that of an amplitude.
    pub fn courses(&self) -> impl Iterator<Item = Option<&str>> {
        std::iter::once(None).chain(self.courses.iter().map(|name| Some(name.as_str())))
    }

    /// What constrains and was left out: while there is any, what is said of the rest need not be so of the deck.
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

    /// Equation `i`, from 0, if it is there.
    pub fn equation(&self, i: usize) -> Option<Equation<'_>> {
        (i < self.equations()).then(|| self.nth(i))
    }

    /// Equation `i`, which is there.
    pub(super) fn nth(&self, i: usize) -> Equation<'_> {
        let range = if i == 0 { 0 } else { self.ends[i - 1] as usize }..self.ends[i] as usize;
        let run = self.runs[self.runs.partition_point(|run| run.first <= i as u32) - 1];
        Equation {
            columns: &self.terms.columns[range.clone()],
            coefficients: &self.terms.coefficients[range],
            rhs: self.rhs.get(i).copied().unwrap_or(0.0),
            origin: run.at(i),
        }
    }

    /// The column of a DOF, if it occurs in an equation.
    pub fn column(&self, dof: Dof) -> Option<u32> {
        self.columns.get(dof)
    }

    /// Makes room for equations and terms to come.
    pub(super) fn reserve(&mut self, equations: usize, terms: usize) {
        self.ends.reserve_exact(equations);
        self.terms.columns.reserve_exact(terms);
        self.terms.coefficients.reserve_exact(terms);
        self.dofs.reserve_exact(terms);
    }

    /// Gives back the room made for DOFs: there can be as many as terms, but mostly there are fewer.
    pub(super) fn shrink(&mut self) {
        // To give a little back would copy all for nothing.
        if self.dofs.len() < self.dofs.capacity() / 2 {
            self.dofs.shrink_to_fit();
        }
    }

    /// Adds an equation. The terms are kept as they come: repeated DOFs and zeros included.
    pub(super) fn push(&mut self, terms: impl IntoIterator<Item = (Dof, f64)>, rhs: f64, origin: Origin) {
        let i = self.equations();
        for (turn, (dof, coefficient)) in terms.into_iter().enumerate() {
            let next = self.dofs.len() as u32;
            let column = self.columns.get_or_insert(dof, next, turn);
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
        if !self.runs.last_mut().is_some_and(|run| run.take(i, origin)) {
            self.runs.push(Run { first: i as u32, origin, stride: 0, cards: 0 });
        }
    }

    /// Adds a card and returns its number.
    pub(super) fn card(&mut self, name: impl Into<CardName>, file: u32, line: u32) -> u32 {
        self.cards.push(name.into(), file, line)
    }

    /// Adds a warning about a line.
    pub(super) fn warn(&mut self, file: u32, line: u32, text: impl Into<String>) {
        self.warnings.push(Warning { file, line, text: text.into(), leaves_out: false });
    }

    /// Says what the solver stops at.
    pub(super) fn refuse(&mut self, file: u32, line: u32, text: impl Into<String>) {
        self.refusals.push(Warning { file, line, text: text.into(), leaves_out: false });
    }

    /// Says that a card constrains, but was left out.
    pub(super) fn leave_out(&mut self, file: u32, line: u32, text: impl Into<String>) {
        self.warnings.push(Warning { file, line, text: text.into(), leaves_out: true });
    }

    /// Where a DOF is put into a set of which no slave may be, such as Nastran's `ASET`.
    pub fn claimed(&self, dof: Dof) -> Option<Origin> {
        self.claims.binary_search_by_key(&dof, |(claimed, _)| *claimed).ok().map(|at| self.claims[at].1)
    }

    /// Sets such DOFs.
    pub(super) fn claim(&mut self, mut claims: Vec<(Dof, Origin)>) {
        claims.sort_by_key(|(dof, _)| *dof);
        claims.dedup_by_key(|(dof, _)| *dof);
        self.claims = claims;
    }

    /// Whether the first term of equation `i` is a slave; not so where the solver keeps the equation by a multiplier.
    pub fn has_slave(&self, i: usize) -> bool {
        self.without_slaves.is_empty() || !self.without_slaves.contains(&self.nth(i).origin.card)
    }

    /// Says that the equations of a card are kept by multipliers.
    pub(super) fn keep_by_multipliers(&mut self, card: u32) {
        self.without_slaves.insert(card);
    }

    /// The number of the course of this name.
    pub(super) fn course(&mut self, name: &str) -> u32 {
        let known = self.courses.iter().position(|known| known == name);
        let at = known.unwrap_or_else(|| {
            self.courses.push(name.to_owned());
            self.courses.len() - 1
        });
        at as u32 + 1
    }

    /// What the deck calls a node: `Part-1-1.12`, or its number where that is its name.
    ///
    /// ```
    /// # let place = tempfile::tempdir()?;
    /// let path = place.path().join("one.inp");
    /// std::fs::write(&path, "*NODE\n7,1.,2.,3.\n")?;
    /// assert_eq!(qless_io::deck::read(&path)?.model().node_name(7), "7");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn node_name(&self, node: u32) -> String {
        self.names.get(node).unwrap_or_else(|| node.to_string())
    }

    /// What the deck calls a DOF: `Part-1-1.12:3`.
    pub fn dof_name(&self, dof: Dof) -> String {
        match self.names.get(dof.node) {
            Some(name) => format!("{name}:{}", dof.component),
            None => dof.to_string(),
        }
    }

    /// Whether nodes have names of instances, so that their numbers mean nothing in the deck's text.
    pub fn has_instances(&self) -> bool {
        self.names.has_instances()
    }

    /// Names nodes from `first` on by an instance and their numbers in it.
    pub(super) fn name_nodes(&mut self, first: u32, instance: String, own: Vec<u32>) {
        self.names.instance(first, instance, own);
    }

    /// Names a node.
    pub(super) fn name_node(&mut self, node: u32, name: String) {
        self.names.one(node, name);
    }

    /// DOFs that cards left out may claim, ascending, and where those stand: no equation written anew may have them as slaves.
    pub fn left_out_claims(&self) -> &[(Dof, Origin)] {
        &self.left_out_claims
    }

    /// Says that a card that is left out may claim DOFs.
    pub(super) fn claim_left_out(&mut self, dofs: impl IntoIterator<Item = Dof>, origin: Origin) {
        self.left_out_claims.extend(dofs.into_iter().map(|dof| (dof, origin)));
        self.left_out_claims.sort_by_key(|(dof, origin)| (*dof, origin.card, origin.line));
        self.left_out_claims.dedup();
    }

    /// Where, and which card: `line 41 *EQUATION` in the main file, `part.inc:41 *EQUATION` in others; the line alone for an origin
    /// that is none of this model.
    pub fn place(&self, origin: Origin) -> String {
        let Some(card) = self.cards.get(origin.card) else { return format!("line {}", origin.line) };
        let path = self.files.get(card.file as usize).map(PathBuf::as_path);
        let file = path.and_then(Path::file_name).unwrap_or_default().to_string_lossy();
        match card.file {
            0 => format!("line {} {}", origin.line, card.name),
            _ => format!("{file}:{} {}", origin.line, card.name),
        }
    }

    /// Where something is that the user should know: `line 41`, `part.inc:41` in files that are included.
    pub fn place_of(&self, warning: &Warning) -> String {
        let path = self.files.get(warning.file as usize).filter(|_| warning.file > 0);
        match path.and_then(|path| path.file_name()) {
            Some(file) => format!("{}:{}", file.to_string_lossy(), warning.line),
            None => format!("line {}", warning.line),
        }
    }

    /// `line 41 *EQUATION 6:3`: the place and the first DOF of equation `i`, if it is there.
    pub fn label(&self, i: usize) -> Option<String> {
        (i < self.equations()).then(|| self.label_of(i))
    }

    /// The label of equation `i`, which is there.
    pub(super) fn label_of(&self, i: usize) -> String {
        let equation = self.nth(i);
        let place = self.place(equation.origin);
        match equation.columns.first() {
            Some(&j) => format!("{place} {}", self.dof_name(self.dofs[j as usize])),
            None => place,
        }
    }

    /// The equations in force in a load case, by their number in the deck.
    pub fn in_force(&self, case: &LoadCase) -> impl Iterator<Item = usize> + '_ {
        let removed = case.removed.clone();
        (0..self.equations()).filter(move |&i| removed.binary_search(&(i as u32)).is_err())
    }

    /// An error at a line of a card.
    pub(super) fn error(&self, origin: Origin, field: Option<usize>, problem: super::Problem) -> DeckError {
        let card = self.cards.nth(origin.card);
        let path = self.files[card.file as usize].clone();
        DeckError { path, line: origin.line as usize, card: card.name.to_string(), field, problem }
    }
}

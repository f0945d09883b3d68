//! Resolves the words of a list to rows and columns.

use std::cell::OnceCell;
use std::collections::{HashMap, HashSet};

use qless::ConstraintSystem;
use qless_io::deck::{Deck, Dof, LoadCase, Model, Origin};
use strsim::normalized_damerau_levenshtein;

use super::word::{ListWord, WordList};
use crate::wording::label;

/// The names of equations and DOFs in a system and in its deck.
pub struct NameIndex<'a> {
    system: &'a ConstraintSystem,
    deck: Option<(&'a Deck, &'a LoadCase)>,
    /// Rows and columns by their labels, built on demand.
    rows: OnceCell<LabelIndex>,
    columns: OnceCell<LabelIndex>,
}

/// Places by label as written, and by label in small letters.
type LabelIndex = [HashMap<String, Vec<usize>>; 2];

/// Whether a list names equations or DOFs.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Wanted {
    Equations,
    Dofs,
}

/// A word of a list that matches nothing.
#[derive(Debug, thiserror::Error)]
pub enum WordError {
    #[error("{option}: `{word}` is {}{}", unknown(*.is_deck), did_you_mean(nearest.as_deref()))]
    Unknown { option: &'static str, word: String, is_deck: bool, nearest: Option<String> },
    #[error(
        "{option}: `{word}` of the deck gives no equation and no DOF of one{}",
        nearest.map_or(String::new(), |line| format!("; the nearest line with a constraint is {line}"))
    )]
    Line { option: &'static str, word: String, nearest: Option<u32> },
}

fn unknown(is_deck: bool) -> &'static str {
    if is_deck {
        "no label, node set, card or node:component of the equations, and no line such as `line 41`"
    } else {
        "no label"
    }
}

fn did_you_mean(nearest: Option<&str>) -> String {
    nearest.map_or(String::new(), |name| format!("; did you mean `{}`?", label(name)))
}

impl<'a> NameIndex<'a> {
    pub fn new(system: &'a ConstraintSystem, deck: Option<(&'a Deck, &'a LoadCase)>) -> Self {
        Self { system, deck, rows: OnceCell::new(), columns: OnceCell::new() }
    }

    /// Rows or columns, from 0, that the words of a list name.
    pub fn all(&self, option: &'static str, words: &WordList, wanted: Wanted) -> Result<Vec<usize>, WordError> {
        let mut all = Vec::new();
        for word in &words.0 {
            match word {
                ListWord::Numbers(range) => all.extend(range.clone()),
                ListWord::Name(name) => all.extend(self.named(option, name, wanted)?),
            }
        }
        Ok(all)
    }

    fn named(&self, option: &'static str, word: &str, wanted: Wanted) -> Result<Vec<usize>, WordError> {
        let column = |(deck, _): (&Deck, _)| deck.model().column(dof(word)?);
        if let Some(column) = self.deck.and_then(column).filter(|_| wanted == Wanted::Dofs) {
            return Ok(vec![column as usize]);
        }
        if let Some(found) = self.labelled(word, wanted) {
            return Ok(found.clone());
        }
        let unknown = || {
            let nearest = nearest(word, self.labels(wanted).chain(self.sets()));
            WordError::Unknown { option, word: word.to_owned(), is_deck: self.deck.is_some(), nearest }
        };
        let Some((deck, case)) = self.deck else { return Err(unknown()) };
        if let Some(line) = ListedDeckLine::parse(word) {
            let not_found = |nearest| WordError::Line { option, word: word.to_owned(), nearest };
            return at_line(deck.model(), case, &line, wanted).map_err(not_found);
        }
        match dof(word) {
            // A DOF that occurs in an equation is known, even if no equation begins with it.
            Some(dof) if deck.model().column(dof).is_none() => Err(unknown()),
            Some(dof) => Ok(matching(deck.model(), case, &|other| other == dof, wanted)),
            None => match deck.node_set(word) {
                Some(nodes) => {
                    let nodes: HashSet<u32> = nodes.into_iter().collect();
                    Ok(matching(deck.model(), case, &|dof| nodes.contains(&dof.node), wanted))
                }
                None if is_card(deck.model(), word) => Ok(of_cards(deck.model(), case, word, wanted)),
                None => Err(unknown()),
            },
        }
    }

    fn labels(&self, wanted: Wanted) -> Box<dyn Iterator<Item = String> + '_> {
        match wanted {
            Wanted::Equations => Box::new((0..self.system.equations()).map(|row| self.system.equation_label(row))),
            Wanted::Dofs => Box::new((0..self.system.dofs()).map(|column| self.system.dof_label(column))),
        }
    }

    fn sets(&self) -> impl Iterator<Item = String> {
        self.deck.into_iter().flat_map(|(deck, _)| deck.node_set_names())
    }

    fn labelled(&self, word: &str, wanted: Wanted) -> Option<&Vec<usize>> {
        let index = if wanted == Wanted::Equations { &self.rows } else { &self.columns };
        let labels = index.get_or_init(|| {
            let mut labels = LabelIndex::default();
            for (k, label) in self.labels(wanted).enumerate() {
                labels[1].entry(label.to_lowercase()).or_default().push(k);
                labels[0].entry(label).or_default().push(k);
            }
            labels
        });
        labels[0].get(word).or_else(|| labels[1].get(&word.to_lowercase()))
    }
}

/// The equations or DOFs on a line of the deck. If the line has none, the error is the nearest line with an equation.
fn at_line(model: &Model, case: &LoadCase, line: &ListedDeckLine, wanted: Wanted) -> Result<Vec<usize>, Option<u32>> {
    let is_on_line = |origin: Origin| line.is_in(model, origin);
    let equations = rows(model, case).filter(|(_, origin, _)| is_on_line(*origin));
    let clashes = (model.in_force(case).count()..).zip(&case.clashes).filter(|(_, clash)| is_on_line(clash.origin));
    let found: Vec<usize> = match wanted {
        Wanted::Equations => equations.map(|(row, ..)| row).chain(clashes.map(|(row, _)| row)).collect(),
        Wanted::Dofs => {
            let given = case.prescribed.iter().filter(|given| is_on_line(given.origin)).map(|given| given.dof);
            let loaded = case.loads.iter().filter(|load| is_on_line(load.origin)).map(|load| load.dof);
            let columns = given.chain(loaded).filter_map(|dof| model.column(dof));
            let of_equations = equations.flat_map(|(_, _, columns)| columns.iter().copied());
            of_equations.chain(columns).map(|j| j as usize).collect()
        }
    };
    // A line with equations is known, even if none of them is in force in this load case; then the list is empty.
    let is_known =
        !found.is_empty() || (0..model.equations()).filter_map(|i| model.equation(i)).any(|e| is_on_line(e.origin));
    if is_known { Ok(found) } else { Err(nearest_line(model, case, line, wanted)) }
}

/// Equations that begin with a matching DOF, or the columns of matching DOFs.
fn matching(model: &Model, case: &LoadCase, matches: &dyn Fn(Dof) -> bool, wanted: Wanted) -> Vec<usize> {
    match wanted {
        Wanted::Dofs => (0..).zip(model.dofs()).filter(|(_, dof)| matches(**dof)).map(|(j, _)| j).collect(),
        Wanted::Equations => rows(model, case)
            .filter(|(_, _, columns)| columns.first().is_some_and(|&j| matches(model.dofs()[j as usize])))
            .map(|(row, ..)| row)
            .collect(),
    }
}

/// Whether a card has this name, such as `RBE2 13`, `RBE2,13`, `*TIE` or `tie`.
fn is_card(model: &Model, name: &str) -> bool {
    let cards = model.cards();
    (0..cards.len() as u32).filter_map(|i| cards.get(i)).any(|card| is_named(&card.name.to_string(), name))
}

fn is_named(card: &str, name: &str) -> bool {
    let plain = |text: &str| text.trim_start_matches('*').replace(',', " ").to_ascii_uppercase();
    plain(card) == plain(name)
}

/// The equations of the cards with this name, or their DOFs and those that they prescribe or load.
fn of_cards(model: &Model, case: &LoadCase, name: &str, wanted: Wanted) -> Vec<usize> {
    let is_named =
        |origin: Origin| model.cards().get(origin.card).is_some_and(|card| is_named(&card.name.to_string(), name));
    let equations = rows(model, case).filter(|(_, origin, _)| is_named(*origin));
    match wanted {
        Wanted::Equations => equations.map(|(row, ..)| row).collect(),
        Wanted::Dofs => {
            let values = case.prescribed.iter().map(|given| (given.dof, given.origin));
            let given = values.chain(case.loads.iter().map(|load| (load.dof, load.origin)));
            let given = given.filter(|(_, origin)| is_named(*origin)).filter_map(|(dof, _)| model.column(dof));
            let own = equations.flat_map(|(_, _, columns)| columns.iter().copied());
            own.chain(given).map(|j| j as usize).collect()
        }
    }
}

/// Rows of the equations in force in a load case, with their origins and columns.
fn rows<'a>(model: &'a Model, case: &LoadCase) -> impl Iterator<Item = (usize, Origin, &'a [u32])> {
    let equations = model.in_force(case).filter_map(|i| model.equation(i));
    (0..).zip(equations).map(|(row, equation)| (row, equation.origin, equation.columns))
}

/// The nearest line with an equation; if DOFs are wanted, also with a value or a load at a DOF of an equation.
fn nearest_line(model: &Model, case: &LoadCase, line: &ListedDeckLine, wanted: Wanted) -> Option<u32> {
    let equations = (0..model.equations()).filter_map(|i| model.equation(i)).map(|equation| equation.origin);
    let values = case.prescribed.iter().map(|given| (given.dof, given.origin));
    let given = values.chain(case.loads.iter().map(|load| (load.dof, load.origin)));
    let given = given.filter(|(dof, _)| model.column(*dof).is_some()).map(|(_, origin)| origin);
    let origins = equations.chain(given.filter(|_| wanted == Wanted::Dofs));
    let lines = origins.filter(|&origin| line.file_of(model, origin)).map(|origin| origin.line);
    lines.min_by_key(|found| found.abs_diff(line.line))
}

/// Largest number of names that are compared for a suggestion, to bound the time.
const COMPARED: usize = 200_000;
/// Smallest similarity of a suggested name, from 0 to 1.
const ALIKE: f64 = 0.5;

/// The name in `known` that is most similar to `word`, ignoring case; none if no name is similar enough.
fn nearest(word: &str, known: impl Iterator<Item = String>) -> Option<String> {
    let word = word.to_lowercase();
    let alike = |name: String| (normalized_damerau_levenshtein(&word, &name.to_lowercase()), name);
    let best = known.take(COMPARED).map(alike).max_by(|a, b| a.0.total_cmp(&b.0))?;
    (best.0 >= ALIKE).then_some(best.1)
}

/// The names that ANSYS gives to components 1 to 6.
const COMPONENTS: [&str; 6] = ["UX", "UY", "UZ", "ROTX", "ROTY", "ROTZ"];

/// Parses `node:component`, with a number or a name as component, and a value as in the report: `5:3`, `5:UZ`, `5:3 = 0`.
pub fn dof(word: &str) -> Option<Dof> {
    let (node, component) = word.split_once(':')?;
    let component = component.split('=').next().unwrap_or_default().trim();
    let named = || (1..).zip(COMPONENTS).find(|(_, name)| name.eq_ignore_ascii_case(component)).map(|(k, _)| k);
    Some(Dof { node: node.trim().parse().ok()?, component: component.parse().ok().or_else(named)? })
}

/// A line of the deck as named in a list: `line 41`, or `part.inc:41` of an included file.
struct ListedDeckLine {
    /// Name of an included file; `None` for the main file.
    file: Option<String>,
    line: u32,
}

impl ListedDeckLine {
    fn parse(word: &str) -> Option<Self> {
        let number = word.get(..4).filter(|start| start.eq_ignore_ascii_case("line")).map(|start| &word[start.len()..]);
        // The report names cards `line 41 *EQUATION`.
        let number = number.and_then(|number| number.split_whitespace().next());
        if let Some(line) = number.and_then(|number| number.parse().ok()) {
            return Some(Self { file: None, line });
        }
        let (file, line) = word.rsplit_once(':')?;
        // `5:3` is a DOF, not line 3 of a file `5`.
        file.parse::<u32>().is_err().then_some(())?;
        Some(Self { file: Some(file.to_owned()), line: line.parse().ok()? })
    }

    fn is_in(&self, model: &Model, origin: Origin) -> bool {
        let lines = origin.line..origin.line.saturating_add(origin.lines.max(1));
        lines.contains(&self.line) && self.file_of(model, origin)
    }

    fn file_of(&self, model: &Model, origin: Origin) -> bool {
        let Some(card) = model.cards().get(origin.card) else { return false };
        match &self.file {
            None => card.file == 0,
            Some(file) => {
                let path = &model.files()[card.file as usize];
                path.file_name().is_some_and(|name| name.to_string_lossy() == file.as_str())
                    || path.display().to_string() == *file
            }
        }
    }
}

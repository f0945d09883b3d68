//! Reads case control: which sets each subcase selects. `MPC = 3` before the first `SUBCASE` holds for every subcase that does not select
//! an MPC set itself.

use crate::deck::Problem;
use crate::deck::nastran::syntax::lines::{DeckLine, FileLine, keyword};
use crate::fault::quote;
use crate::number::whole;

/// The number of a selected set, and the line that selects it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SetChoice {
    pub set: u32,
    pub file: u32,
    pub line: u32,
}

/// The sets that a subcase or a step selects.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CaseSelection {
    pub mpc: Option<SetChoice>,
    pub spc: Option<SetChoice>,
    pub load: Option<SetChoice>,
}

impl CaseSelection {
    /// Returns this selection. Choices that are missing in it are taken from `outer`.
    fn or(self, outer: Self) -> Self {
        Self { mpc: self.mpc.or(outer.mpc), spc: self.spc.or(outer.spc), load: self.load.or(outer.load) }
    }

    /// This selection without choices of set 0. Choosing set 0 only cancels a choice of the outer level.
    fn in_force(self) -> Self {
        let some = |choice: Option<SetChoice>| choice.filter(|choice| choice.set != 0);
        Self { mpc: some(self.mpc), spc: some(self.spc), load: some(self.load) }
    }

    fn sets(self) -> [Option<u32>; 3] {
        [self.mpc, self.spc, self.load].map(|choice| choice.map(|choice| choice.set))
    }
}

/// The level of case control to which the current line belongs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum ControlLevel {
    #[default]
    All,
    Subcase,
    Step,
    /// A combination of subcases. It superposes results and has no constraints.
    Combination,
}

/// A subcase and its steps.
#[derive(Debug)]
struct Subcase {
    id: u32,
    holder: usize,
    own: CaseSelection,
    steps: Vec<(u32, usize, CaseSelection)>,
}

/// A step, a subcase without steps, or a whole deck without subcases. It becomes a load case, in which all sets of its selection hold.
#[derive(Clone, Debug)]
pub struct SubcaseLeaf {
    name: String,
    pub selection: CaseSelection,
    /// Index of the block of lines that can select sets for this step or subcase alone. Block 0 holds the lines before the first subcase.
    /// The subcases and steps are blocks 1, 2, and so on, in the order of the deck.
    pub holder: usize,
}

/// The case control of a deck.
#[derive(Debug, Default)]
pub struct CaseControl {
    all: CaseSelection,
    subcases: Vec<Subcase>,
    level: ControlLevel,
    /// First lines of the blocks 1, 2, and so on: all subcases and steps, in the order of the deck.
    opened: Vec<FileLine>,
    /// All choices of an MPC set, each with the index of its block (see [`SubcaseLeaf::holder`]).
    pub mpc_choices: Vec<(usize, SetChoice)>,
    /// The line that makes the solver enforce rigid elements by multipliers or stiffness, if there is one.
    pub multipliers: Option<FileLine>,
    /// All choices of set 0.
    pub zeros: Vec<SetChoice>,
}

impl CaseControl {
    /// Reads a line of case control.
    pub fn line(&mut self, line: &DeckLine) -> Result<(), Problem> {
        let (word, rest) = keyword(line.text);
        match word.as_str() {
            "SUBCASE" | "SYM" => self.open(ControlLevel::Subcase, rest, line.at()),
            "STEP" if !self.subcases.is_empty() && self.level != ControlLevel::Combination => {
                self.open(ControlLevel::Step, rest, line.at());
            }
            "RIGID" => self.rigid(rest, line.at()),
            "SUBCOM" | "SYMCOM" | "REPCASE" => self.level = ControlLevel::Combination,
            "MPC" | "SPC" | "LOAD" => self.choose(&word, rest, line)?,
            _ => {}
        }
        Ok(())
    }

    /// The name and the selection of each load case. Subcases with the same sets are one load case.
    pub fn selections(&self) -> Vec<(String, CaseSelection)> {
        let name = |leaves: &[SubcaseLeaf]| {
            let names: Vec<&str> = leaves.iter().map(|leaf| leaf.name.as_str()).collect();
            match (self.subcases.is_empty(), names.len()) {
                (true, _) => "model".to_owned(),
                (false, 1) => format!("subcase {}", names[0]),
                (false, _) => format!("subcases {}", names.join(", ")),
            }
        };
        self.cases().iter().map(|leaves| (name(leaves), leaves[0].selection)).collect()
    }

    /// The steps and subcases of each load case, at least one. Those with the same sets are one load case.
    pub fn cases(&self) -> Vec<Vec<SubcaseLeaf>> {
        let mut found: Vec<Vec<SubcaseLeaf>> = Vec::new();
        for leaf in self.leaves() {
            match found.iter_mut().find(|leaves| leaves[0].selection.sets() == leaf.selection.sets()) {
                Some(leaves) => leaves.push(leaf),
                None => found.push(vec![leaf]),
            }
        }
        found
    }

    /// The first line of a subcase or step, given by the index of its block; `None` for block 0.
    pub fn opened(&self, holder: usize) -> Option<FileLine> {
        holder.checked_sub(1).and_then(|i| self.opened.get(i).copied())
    }

    /// The MPC set that is selected before the first subcase.
    pub fn common_choice(&self) -> Option<SetChoice> {
        self.all.in_force().mpc
    }

    fn leaves(&self) -> Vec<SubcaseLeaf> {
        let leaf =
            |name, selection: CaseSelection, holder| SubcaseLeaf { name, selection: selection.in_force(), holder };
        if self.subcases.is_empty() {
            return vec![leaf("model".into(), self.all, 0)];
        }
        let mut found = Vec::new();
        for Subcase { id, holder, own, steps } in &self.subcases {
            let outer = own.or(self.all);
            if steps.is_empty() {
                found.push(leaf(id.to_string(), outer, *holder));
            }
            let step = |&(step, holder, own): &(u32, usize, CaseSelection)| {
                leaf(format!("{id} step {step}"), own.or(outer), holder)
            };
            found.extend(steps.iter().map(step));
        }
        found
    }

    fn open(&mut self, level: ControlLevel, rest: &[u8], at: FileLine) {
        self.opened.push(at);
        let (number, holder, own) = (number(rest).unwrap_or(0), self.opened.len(), CaseSelection::default());
        match (level, self.subcases.last_mut()) {
            (ControlLevel::Step, Some(subcase)) => subcase.steps.push((number, holder, own)),
            _ => self.subcases.push(Subcase { id: number, holder, own, steps: Vec::new() }),
        }
        self.level = level;
    }

    /// Reads `RIGID`. With `LAGRAN` or `STIFF`, the solver eliminates no components; with `LINEAR` or `LGELIM`, it does.
    fn rigid(&mut self, rest: &[u8], at: FileLine) {
        let rest = rest.trim_ascii();
        let word = rest.strip_prefix(b"=").unwrap_or(rest).trim_ascii().to_ascii_uppercase();
        let eliminates = !(word.starts_with(b"LAGR") || word.starts_with(b"STIFF"));
        self.multipliers = if eliminates { None } else { Some(at) };
    }

    fn choose(&mut self, word: &str, rest: &[u8], line: &DeckLine) -> Result<(), Problem> {
        let Some(set) = only_number(rest) else {
            let expected = "the number of a set, as in `SPC = 3`";
            return Err(Problem::Expected { expected, found: quote(line.text.trim_ascii()) });
        };
        let choice = SetChoice { set, file: line.file, line: line.number };
        if set == 0 {
            self.zeros.push(choice);
        }
        let holder = if self.level == ControlLevel::All { 0 } else { self.opened.len() };
        let Some(selection) = self.current() else { return Ok(()) };
        match word {
            "MPC" => {
                selection.mpc = Some(choice);
                self.mpc_choices.push((holder, choice));
            }
            "SPC" => selection.spc = Some(choice),
            _ => selection.load = Some(choice),
        }
        Ok(())
    }

    fn current(&mut self) -> Option<&mut CaseSelection> {
        match (self.level, self.subcases.last_mut()) {
            (ControlLevel::Combination, _) => None,
            (ControlLevel::Step, Some(subcase)) => subcase.steps.last_mut().map(|(.., selection)| selection),
            (ControlLevel::Subcase, Some(subcase)) => Some(&mut subcase.own),
            _ => Some(&mut self.all),
        }
    }
}

/// The number that follows `=` or blanks.
fn number(rest: &[u8]) -> Option<u32> {
    leading(rest).map(|(value, _)| value)
}

/// The number that follows `=` or blanks, if only a blank or a comment follows it: `0PO` is not the number of a set.
fn only_number(rest: &[u8]) -> Option<u32> {
    let (value, after) = leading(rest)?;
    after.first().is_none_or(|&byte| byte == b'$' || byte.is_ascii_whitespace()).then_some(value)
}

/// The number that follows `=` or blanks, and the text after the number.
fn leading(rest: &[u8]) -> Option<(u32, &[u8])> {
    let rest = rest.trim_ascii();
    let rest = rest.strip_prefix(b"=").unwrap_or(rest).trim_ascii();
    let (digits, after) = rest.split_at(rest.iter().position(|byte| !byte.is_ascii_digit()).unwrap_or(rest.len()));
    Some((whole(digits).and_then(|value| u32::try_from(value).ok())?, after))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Vec<(String, Option<u32>, Option<u32>)> {
        let mut control = CaseControl::default();
        for (text, number) in text.lines().zip(1..) {
            control.line(&DeckLine { file: 0, number, text: text.as_bytes() }).expect("case control");
        }
        let set = |choice: Option<SetChoice>| choice.map(|choice| choice.set);
        control.selections().into_iter().map(|(name, s)| (name, set(s.mpc), set(s.spc))).collect()
    }

    #[test]
    fn a_set_is_a_whole_number_and_nothing_else() {
        let refused = |text: &[u8]| CaseControl::default().line(&DeckLine { file: 0, number: 1, text }).is_err();
        assert!([&b"MPC = 0PO"[..], b"SPC = 2x", b"SPC = 1.5", b"SPC = ALL"].into_iter().all(refused));
        assert!(![&b"MPC = 2 $ ties"[..], b"SPC 3", b"LOAD=4$"].into_iter().any(refused));
    }

    #[test]
    fn without_subcases_the_deck_is_one_case() {
        assert_eq!(read("TITLE = SPC = 7\nSPC=101\n  mpc = 200\nSPCF = ALL"), [("model".into(), Some(200), Some(101))]);
        assert_eq!(read("ECHO=NONE"), [("model".into(), None, None)]);
    }

    #[test]
    fn subcases_inherit_and_replace() {
        let found =
            read("SPC = 1\nSUBCASE 1\n MPC = 5\nSUBCASE 20\n SPC = 2\nSUBCASE 3\nSUBCOM 4\n SPC = 9\nSUBCASE 5\n");
        let expected =
            [("subcase 1", Some(5), Some(1)), ("subcase 20", None, Some(2)), ("subcases 3, 5", None, Some(1))];
        assert_eq!(found, expected.map(|(name, mpc, spc)| (name.to_owned(), mpc, spc)));
    }

    #[test]
    fn steps_are_cases_of_their_own() {
        let found = read("SUBCASE 1\nSPC = 1\nSTEP 1\nSTEP 2\nSPC = 2\n");
        assert_eq!(found, [("subcase 1 step 1".into(), None, Some(1)), ("subcase 1 step 2".into(), None, Some(2))]);
    }

    #[test]
    fn rigid_elements_may_be_enforced_by_multipliers() {
        let multiplied = |text: &str| {
            let mut control = CaseControl::default();
            control.line(&DeckLine { file: 0, number: 3, text: text.as_bytes() }).expect("case control");
            control.multipliers
        };
        for text in ["RIGID=LAGRAN", "  rigid = Lagrange", "RIGID STIFF"] {
            assert_eq!(multiplied(text), Some((0, 3)), "{text}");
        }
        assert!(
            ["RIGID = LINEAR", "RIGID=LGELIM", "TITLE = RIGID = LAGRAN"].into_iter().all(|t| multiplied(t).is_none())
        );
    }
}

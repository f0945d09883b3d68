//! Reads named relations `sum a_j u_j = b`, each on a line, with names for the DOFs u_j and a label for the relation. Codes whose decks are
//! programs, such as `code_aster` or scripts of Abaqus, can print their assembled relations in this form.
//!
//! ```text
//! # relations
//! tie_1: 1.0 N12.DX - 1.0 N13.DX = 0.5     a relation with a label
//! 2 N13.DX + N14.DX = 0                    without one: its label is `line 3`
//! N12.DY = 0                               a single DOF without a coefficient: its value is prescribed
//! ```
//!
//! | part | form |
//! | --- | --- |
//! | label | all words up to the first that ends with a colon; may be left out |
//! | term | a sign, a coefficient (1 if it is left out) and a name; `*` may stand between the last two |
//! | name | any word without `*` and `=` that is no number and starts with no sign |
//! | right-hand side | `=` and a number |
//! | comment | from a word that starts with `#` or `%` to the end of the line |
//!
//! Blanks separate words, because names may contain most characters: `a - b` is a difference, `a-b` a name. A sign may also be
//! part of a number. A DOF may have several prescribed values; those that contradict the first become relations, so that they are
//! reported as conflicts.
//!
//! A file holds relations if its name ends with `.rel`, or if its first line is `# relations`.
//!
//! ```
//! # let place = tempfile::tempdir()?;
//! let path = place.path().join("ties.rel");
//! std::fs::write(&path, "tie_1: 1.0 N12.DX - 1.0 N13.DX = 0.5\nN12.DX = 0\n")?;
//! let system = qless_io::read_case(&path, None, None)?;
//! assert_eq!((system.equation_label(0), system.dof_label(1)), ("tie_1".to_owned(), "N13.DX".to_owned()));
//! assert_eq!((system.rhs(), system.prescribed()), (&[0.5][..], &[(0, 0.0)][..]));
//!
//! std::fs::write(&path, "N12.DX - N13.DX 0.5\n")?;
//! let error = qless_io::read_case(&path, None, None).unwrap_err().to_string();
//! assert!(error.contains("ties.rel:1:17: expected `+`, `-` or `=`, with blanks around it, found `0.5`"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use std::path::Path;

use qless::{ConstraintSystem, SystemBuilder};
use rustc_hash::FxHashMap;

use crate::fault::{NumberFault, TextFault, quote};
use crate::lines::{TextLine, TextLines};
use crate::number::real;
use crate::{ReadError, without_gz};

const TERM: &str = "`+`, `-`, `*`, a number or the name of a DOF";
const NEXT: &str = "`+`, `-` or `=`, with blanks around it";
const NAME: &str = "the name of a DOF";
const END: &str = "the end of the relation";

/// Whether a file holds relations. Its name or its first line decides.
pub(crate) fn is_relations(path: &Path, text: &[u8]) -> bool {
    let text = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text);
    let first = text.split(|&byte| byte == b'\n').next().unwrap_or_default();
    let is_named = |path: &Path| path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("rel"));
    is_named(without_gz(path).unwrap_or(path)) || first.trim_ascii() == b"# relations"
}

/// Reads relations from the text of a file. DOFs are numbered in the order in which they occur.
///
/// # Errors
/// [`ReadError::Malformed`] with file, line and column; [`ReadError::System`] if coefficients of one DOF overflow when summed.
pub(crate) fn parse(path: &Path, text: &[u8]) -> Result<ConstraintSystem, ReadError> {
    let mut lines = TextLines::new(path, text);
    let mut all = AllRelations::default();
    while let Some(line) = lines.content() {
        let relation = Relation::parse(&line).map_err(|fault| line.fault(fault))?;
        all.push(line.number, relation);
    }
    if all.names.is_empty() {
        return Err(ReadError::malformed(path, None, TextFault::NoRelations));
    }
    all.build().map_err(|source| ReadError::System { path: path.to_path_buf(), source })
}

/// The terms of a relation, each with its column and coefficient, and the right-hand side.
type ColumnTerms = (Vec<(usize, f64)>, f64);

/// The relations that were read so far.
#[derive(Default)]
struct AllRelations {
    columns: FxHashMap<String, usize>,
    names: Vec<String>,
    /// The relations that do not prescribe a DOF, each with its label, terms and right-hand side. A relation that prescribes a DOF again
    /// with another value is also here.
    equations: Vec<(String, ColumnTerms)>,
    /// For each prescribed DOF, by column: the label and the value of the first relation that prescribes it.
    prescribed: FxHashMap<usize, (String, f64)>,
}

impl AllRelations {
    fn push(&mut self, line: usize, relation: Relation) {
        let label = relation.label.unwrap_or_else(|| format!("line {line}"));
        let terms: Vec<(usize, f64)> = relation.terms.iter().map(|(name, a)| (self.column(name), *a)).collect();
        if relation.is_prescribed && !self.prescribed.contains_key(&terms[0].0) {
            self.prescribed.insert(terms[0].0, (label, relation.rhs));
        } else if !relation.is_prescribed || self.prescribed[&terms[0].0].1 != relation.rhs {
            self.equations.push((label, (terms, relation.rhs)));
        }
    }

    fn column(&mut self, name: &str) -> usize {
        if let Some(&column) = self.columns.get(name) {
            return column;
        }
        self.names.push(name.to_owned());
        self.columns.insert(name.to_owned(), self.names.len() - 1);
        self.names.len() - 1
    }

    fn build(self) -> Result<ConstraintSystem, qless::SystemError> {
        let mut builder = SystemBuilder::new(self.names.len());
        for (label, (terms, rhs)) in self.equations {
            builder.labelled_equation(label, terms, rhs);
        }
        for (column, (label, value)) in self.prescribed {
            builder.prescribe_at(label, column, value);
        }
        builder.dof_labels(self.names);
        builder.build()
    }
}

/// The relation on one line.
#[derive(Debug, PartialEq)]
struct Relation {
    label: Option<String>,
    terms: Vec<(String, f64)>,
    rhs: f64,
    /// Whether the relation prescribes a DOF. It does if its left-hand side is a single DOF without sign and coefficient.
    is_prescribed: bool,
}

impl Relation {
    fn parse(line: &TextLine) -> Result<Self, TextFault> {
        let words: Vec<&[u8]> = line.words().collect();
        let colon = words.iter().position(|word| word.ends_with(b":"));
        let label =
            colon.map(|at| words[..=at].iter().map(|word| String::from_utf8_lossy(word)).collect::<Vec<_>>().join(" "));
        let label = label.map(|text| text[..text.len() - 1].trim_end().to_owned()).filter(|text| !text.is_empty());
        let mut rest = Words { line: line.text, words: &words[colon.map_or(0, |at| at + 1)..] };
        let is_prescribed = rest.words.get(1) == Some(&&b"="[..]);
        let mut terms = vec![rest.term(true)?];
        while rest.words.first() != Some(&&b"="[..]) {
            terms.push(rest.term(false)?);
        }
        rest.words = &rest.words[1..];
        let rhs = rest.number()?.ok_or_else(|| rest.fault("a number"))?;
        if rest.words.is_empty() { Ok(Self { label, terms, rhs, is_prescribed }) } else { Err(rest.fault(END)) }
    }
}

/// Whether a word can name a DOF. A word such as `2*a` or `-a` is refused, because it probably means a product or a sign.
fn is_name(word: &[u8]) -> bool {
    !matches!(word[0], b'+' | b'-')
        && !word.iter().any(|byte| matches!(byte, b'*' | b'='))
        && real(word) == Err(NumberFault::NotANumber)
}

/// The words of a line that were not yet read.
struct Words<'a> {
    line: &'a [u8],
    words: &'a [&'a [u8]],
}

impl Words<'_> {
    /// Reads a term: a sign, a coefficient and a name. Only the first term may leave out the sign.
    fn term(&mut self, is_first: bool) -> Result<(String, f64), TextFault> {
        let sign = match self.words.first() {
            Some(&b"-") => Some(-1.0),
            Some(&b"+") => Some(1.0),
            _ => None,
        };
        self.words = &self.words[usize::from(sign.is_some())..];
        let has_sign =
            is_first || sign.is_some() || self.words.first().is_some_and(|word| matches!(word[0], b'+' | b'-'));
        if !has_sign {
            return Err(self.fault(NEXT));
        }
        let coefficient = self.number()?;
        if coefficient.is_some() && self.words.first() == Some(&&b"*"[..]) {
            self.words = &self.words[1..];
        }
        let expected = if is_first && coefficient.is_none() { TERM } else { NAME };
        let name = self.words.first().filter(|word| is_name(word)).ok_or_else(|| self.fault(expected))?;
        self.words = &self.words[1..];
        Ok((String::from_utf8_lossy(name).into_owned(), sign.unwrap_or(1.0) * coefficient.unwrap_or(1.0)))
    }

    /// Reads the next word if it is a number; otherwise returns `None` and does not read it.
    fn number(&mut self) -> Result<Option<f64>, TextFault> {
        let Some(word) = self.words.first() else { return Ok(None) };
        match real(word) {
            Err(NumberFault::NotANumber) => Ok(None),
            Err(problem) => Err(TextFault::RelationNumber { column: self.column(), found: quote(word), problem }),
            Ok(value) => {
                self.words = &self.words[1..];
                Ok(Some(value))
            }
        }
    }

    /// Where the next word starts in its line, in bytes from 1. If no word is left, returns the place after the last one.
    fn column(&self) -> usize {
        let next = self.words.first().map(|word| word.as_ptr() as usize - self.line.as_ptr() as usize);
        next.unwrap_or(self.line.trim_ascii_end().len()) + 1
    }

    fn fault(&self, expected: &'static str) -> TextFault {
        let found = self.words.first().copied().unwrap_or_default();
        TextFault::Relation { column: self.column(), expected, found: quote(found) }
    }
}

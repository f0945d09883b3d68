//! Collects the cards of a deck and of its included files, and the parameters. A card is a keyword line `*NAME_OPTION` and the lines below
//! it, without comments (`$`).

use std::sync::Arc;

use rustc_hash::FxHashSet;

use crate::bytes::LINE;
use crate::deck::expression::{self, NameLookup, NoValue, Operand};
use crate::deck::keyword::line::{FieldLayout, FieldWidth, KeywordLine, Parameters};
use crate::deck::{DeckError, Problem, Sources};
use crate::fault::quote;
use crate::number::real;

/// A card. `data` is the range of its lines in the text of the file.
#[derive(Clone)]
pub struct DynaCard {
    /// The keyword in capitals, without the star, such as `BOUNDARY_SPC_SET`.
    pub keyword: String,
    pub file: u32,
    /// The line of the keyword, from 1.
    pub line: u32,
    width: FieldWidth,
    text: Arc<Vec<u8>>,
    data: std::ops::Range<usize>,
}

impl DynaCard {
    /// The data lines, without comments. Blank lines are included, because a blank line stands for zeros.
    pub fn lines<'a>(&'a self, parameters: &'a Parameters) -> impl Iterator<Item = KeywordLine<'a>> + Clone {
        let Self { width, line, .. } = *self;
        let numbered = raw_lines(&self.text[self.data.clone()]).zip(line + 1..);
        let data = numbered.filter(|(text, _)| !text.starts_with(b"$"));
        data.map(move |(text, number)| KeywordLine { number, text, width, layout: FieldLayout::Common, parameters })
    }

    /// The data lines that are not blank.
    pub fn filled<'a>(&'a self, parameters: &'a Parameters) -> impl Iterator<Item = KeywordLine<'a>> + Clone {
        self.lines(parameters).filter(|line| !line.is_blank())
    }

    /// The keyword without these options, which may stand in any order at its end; and for each option, whether the keyword has it.
    pub fn without<const N: usize>(&self, options: [&str; N]) -> (&str, [bool; N]) {
        let (mut name, mut has) = (self.keyword.as_str(), [false; N]);
        while let Some(at) = (0..N).find(|&at| name.ends_with(options[at])) {
            name = &name[..name.len() - options[at].len()];
            has[at] = true;
        }
        (name, has)
    }
}

/// The lines of a text, without their line ends.
fn raw_lines(text: &[u8]) -> impl Iterator<Item = &[u8]> + Clone {
    let text = text.strip_suffix(b"\n").unwrap_or(text);
    text.split(|&byte| byte == b'\n').map(|line| line.strip_suffix(b"\r").unwrap_or(line))
}

/// The cards of a deck in order, up to `*END`, and its parameters.
#[derive(Default)]
pub struct DynaCards {
    pub all: Vec<DynaCard>,
    pub parameters: Parameters,
    /// Names of parameters that a later definition may change.
    changing: FxHashSet<Vec<u8>>,
    /// Whether later definitions of parameters replace earlier ones. By default, LS-DYNA ignores them.
    replaces: bool,
    /// Warnings about parameters: file, line and text.
    pub remarks: Vec<(u32, u32, String)>,
    /// The `*CASE_BEGIN` cards, with the places in `of_cases` of the cards up to `*CASE_END`.
    pub cases: Vec<(DynaCard, std::ops::Range<usize>)>,
    /// The cards of single cases. They are not in `all`.
    pub of_cases: Vec<DynaCard>,
    /// Places in `cases` of those that are open.
    open_cases: Vec<usize>,
    /// The folders that `*INCLUDE_PATH` names.
    folders: Vec<String>,
}

impl DynaCards {
    /// Reads the cards of the main file and of all included files.
    pub fn read(sources: &mut Sources) -> Result<Self, DeckError> {
        let mut cards = Self::default();
        cards.file(sources, (0, 0), FieldWidth::Standard)?;
        Ok(cards)
    }

    /// Reads a file, where `depth` counts the nested includes. `width` is the width of fields, unless a keyword line sets another one for
    /// its card. `*KEYWORD` changes `width` for the rest of the file and for the files that it includes.
    fn file(
        &mut self,
        sources: &mut Sources,
        (file, depth): (usize, usize),
        mut width: FieldWidth,
    ) -> Result<(), DeckError> {
        let text = sources.text(file);
        let (mut at, mut line) = (next_keyword(&text, 0), 1);
        line += memchr::memchr_iter(b'\n', &text[..at]).count();
        while at < text.len() {
            let end = memchr::memchr(b'\n', &text[at..]).map_or(text.len(), |k| at + k + 1);
            let next = next_keyword(&text, end);
            if end - at > LINE {
                let problem = Problem::Limit { what: "the length of a line", limit: LINE, advice: "break it" };
                let path = sources.path(file).to_path_buf();
                return Err(DeckError { path, line, card: "keyword".into(), field: None, problem });
            }
            let (keyword, own) = keyword(&text[at + 1..end], width);
            let words = text[at..end].to_ascii_uppercase();
            let card = DynaCard {
                keyword,
                file: file as u32,
                line: line as u32,
                width: own,
                text: Arc::clone(&text),
                data: end..next,
            };
            match card.keyword.as_str() {
                "END" => return Ok(()),
                "KEYWORD" => width = deck_width(&words, width),
                "INCLUDE" => {
                    for (name, line) in file_names(&card) {
                        let mut find = |name: &str| sources.include(name, file, line as usize, depth);
                        let inner = match find(&name) {
                            Ok(inner) => inner,
                            Err(error) => {
                                let below = self.folders.iter().map(|folder| format!("{folder}/{name}"));
                                below.into_iter().find_map(|name| find(&name).ok()).ok_or(error)?
                            }
                        };
                        self.file(sources, (inner, depth + 1), width)?;
                    }
                }
                "INCLUDE_PATH" | "INCLUDE_PATH_RELATIVE" => {
                    self.folders.extend(file_names(&card).into_iter().map(|(name, _)| name));
                }
                "PARAMETER_DUPLICATION" => {
                    let none = Parameters::default();
                    self.replaces = card.filled(&none).next().is_some_and(|line| matches!(line.field(0), b"2" | b"4"));
                }
                name if name == "PARAMETER" || name.starts_with("PARAMETER_") => self.parameters(&card),
                name if name.starts_with("CASE_BEGIN") => {
                    self.open_cases.push(self.cases.len());
                    self.cases.push((card, self.of_cases.len()..self.of_cases.len()));
                }
                name if name.starts_with("CASE_END") => drop(self.open_cases.pop()),
                _ if self.open_cases.is_empty() => self.all.push(card),
                _ => {
                    self.of_cases.push(card);
                    self.open_cases.iter().for_each(|&case| self.cases[case].1.end = self.of_cases.len());
                }
            }
            line += memchr::memchr_iter(b'\n', &text[at..next]).count();
            at = next;
        }
        Ok(())
    }

    /// Reads `*PARAMETER`: pairs of a name and a value, and `*PARAMETER_EXPRESSION`, which has one name on a line.
    fn parameters(&mut self, card: &DynaCard) {
        let none = Parameters::default();
        if card.keyword.contains("_EXPRESSION") {
            for (line, field, text) in expressions(card, &none) {
                self.define(card, &line, field, text.trim_ascii());
            }
            return;
        }
        // In `*PARAMETER_TYPE`, a third field says what the value names.
        let pairs = if card.keyword.contains("_TYPE") { 1 } else { 4 };
        for (line, pair) in card.filled(&none).flat_map(|line| (0..pairs).map(move |pair| (line, pair))) {
            let (field, value) = (line.field(2 * pair), line.field(2 * pair + 1));
            if !(field.is_empty() && value.is_empty()) {
                self.define(card, &line, field, value);
            }
        }
    }

    /// Defines a parameter; the first letter of the field gives its type. Without it, or without a value, nothing is defined. Of two
    /// definitions the first counts. The value is not known if the second may count, or not for all cards.
    fn define(&mut self, card: &DynaCard, line: &KeywordLine, field: &[u8], text: &[u8]) {
        let Some((kind, name)) = typed_name(field).filter(|_| !text.is_empty()) else {
            let shown = quote(field);
            let why = "has no value, or no type R, I or C before its name: it is not defined, as in LS-DYNA";
            return self.remarks.push((card.file, line.number, format!("the parameter {shown} {why}")));
        };
        let value = if self.open_cases.is_empty() { self.known_text(card, kind, text) } else { None };
        if self.replaces || ["_LOCAL", "_MUTABLE"].iter().any(|option| card.keyword.contains(option)) {
            self.changing.insert(name.clone());
        }
        match self.parameters.get_mut(&name) {
            Some(first) if *first == value => {}
            Some(first) if self.changing.contains(&name) => *first = None,
            Some(_) => {
                let shown = String::from_utf8_lossy(&name);
                let text =
                    format!("the parameter {shown} is defined again: its first definition counts, as in LS-DYNA");
                self.remarks.push((card.file, line.number, text));
            }
            None => drop(self.parameters.insert(name, value)),
        }
    }

    /// The text of a parameter of this type: the text itself, or the value of an expression; `None` if the value is not known. Numbers of
    /// type R have a decimal point, because expressions distinguish them from whole numbers.
    fn known_text(&self, card: &DynaCard, kind: u8, text: &[u8]) -> Option<Vec<u8>> {
        let is_expression = card.keyword.contains("_EXPRESSION") && real(text).is_err();
        let number = if is_expression { Some(self.value_of(text)?) } else { real(text).ok() };
        match number {
            Some(number) if kind == b'R' => Some(format!("{number:?}").into_bytes()),
            Some(number) if is_expression => (number.fract() == 0.0).then(|| format!("{number}").into_bytes()),
            _ => Some(text.to_vec()),
        }
    }

    /// The value of an expression. Names in it may have an ampersand.
    fn value_of(&self, text: &[u8]) -> Option<f64> {
        let text: Vec<u8> = text.iter().copied().filter(|byte| *byte != b'&').collect();
        expression::value(&text, self).ok()
    }
}

impl NameLookup for DynaCards {
    const IS_STRICT: bool = true;

    fn scalar(&self, name: &str) -> Result<Operand, NoValue> {
        let text = match self.parameters.get(name.as_bytes()) {
            None if name == "PI" => return Ok(Operand::real(std::f64::consts::PI)),
            None => return Err(NoValue::NotAnExpression),
            Some(text) => text.as_ref().filter(|_| !self.changing.contains(name.as_bytes())).ok_or(NoValue::Unknown)?,
        };
        let value = real(text).map_err(|_| NoValue::Unknown)?;
        Ok(Operand { value, is_whole: !text.contains(&b'.') })
    }

    fn call(&self, name: &str, arguments: &[Operand]) -> Result<Operand, NoValue> {
        expression::function(name, arguments)
    }
}

/// The type and the name, in capitals, of a parameter: `R thick` or `Rthick`. `None` if the field has no type or no name.
fn typed_name(field: &[u8]) -> Option<(u8, Vec<u8>)> {
    let (kind, name) = field.split_first()?;
    let (kind, name) = (kind.to_ascii_uppercase(), name.trim_ascii());
    (matches!(kind, b'R' | b'I' | b'C') && !name.is_empty()).then(|| (kind, name.to_ascii_uppercase()))
}

/// The expressions of `*PARAMETER_EXPRESSION`: the line and the field of each name, and its text. A line without a name continues the text.
fn expressions<'a>(card: &'a DynaCard, none: &'a Parameters) -> Vec<(KeywordLine<'a>, &'a [u8], Vec<u8>)> {
    let mut found: Vec<(KeywordLine, &[u8], Vec<u8>)> = Vec::new();
    for line in card.filled(none) {
        match (line.split_first(), found.last_mut()) {
            ((b"", text), Some((_, _, open))) => open.extend(text),
            ((field, text), _) => found.push((line, field, text.to_vec())),
        }
    }
    found
}

/// The byte at which the next line that begins with a star starts, at or after `from`. `from` must be the start of a line.
fn next_keyword(text: &[u8], from: usize) -> usize {
    let stars = memchr::memchr_iter(b'*', &text[from..]).map(|k| from + k);
    let is_start = |at: &usize| *at == from || text[at - 1] == b'\n' || (*at == 3 && text.starts_with(b"\xef\xbb\xbf"));
    stars.into_iter().find(is_start).unwrap_or(text.len())
}

/// The name on a keyword line after its star, and the width of the card's fields. A mark after the name sets this width: `NODE +`, `NODE%`,
/// `NODE -`.
fn keyword(text: &[u8], width: FieldWidth) -> (String, FieldWidth) {
    let word = text.split(|byte| byte.is_ascii_whitespace() || *byte == b',').next().unwrap_or_default();
    let rest = text[word.len()..].trim_ascii();
    let (name, mark) = match word.split_last() {
        Some((mark @ (b'+' | b'-' | b'%'), name)) => (name, Some(*mark)),
        _ => (word, rest.first().copied().filter(|_| rest.len() == 1)),
    };
    let width = match mark {
        Some(b'+') => FieldWidth::Long,
        Some(b'%') => FieldWidth::Ten,
        Some(b'-') => FieldWidth::Standard,
        _ => width,
    };
    (String::from_utf8_lossy(name).to_ascii_uppercase(), width)
}

/// The width of fields that the options of `*KEYWORD` set for the deck; `width` if they set none.
fn deck_width(words: &[u8], width: FieldWidth) -> FieldWidth {
    let has = |word: &[u8]| memchr::memmem::find(words, word).is_some();
    match width {
        _ if has(b"LONG=Y") || has(b"LONG=K") => FieldWidth::Long,
        _ if has(b"I10=Y") => FieldWidth::Ten,
        _ => width,
    }
}

/// The files that `*INCLUDE` names, each with its line. A line holds one name. If it ends with ` +`, the name continues on the next line.
fn file_names(card: &DynaCard) -> Vec<(String, u32)> {
    let none = Parameters::default();
    let (mut names, mut open) = (Vec::new(), None::<(String, u32)>);
    for line in card.filled(&none) {
        let text = String::from_utf8_lossy(line.text.trim_ascii()).into_owned();
        let (part, goes_on) = text.strip_suffix(" +").map_or((text.as_str(), false), |part| (part.trim_end(), true));
        let (name, number) = open.take().unwrap_or((String::new(), line.number));
        let whole = (name + part, number);
        if goes_on { open = Some(whole) } else { names.push(whole) }
    }
    names.extend(open);
    names
}

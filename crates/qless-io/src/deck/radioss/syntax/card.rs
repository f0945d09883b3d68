//! Collects the cards of a deck and of its included files. A card is a keyword line `/NAME/OPTION/NUMBER` and the lines below it, without
//! comments (`#`, `$`). Its first line is a title, unless it defines nodes or elements.

use std::ops::Range;
use std::sync::Arc;

use crate::bytes::LINE;
use crate::deck::keyword::line::{FieldLayout, FieldWidth, KeywordLine, Parameters};
use crate::deck::{DeckError, Sources};
use crate::number::whole;

/// The oldest format version whose fields have 10 and 20 columns.
const OLDEST: i64 = 51;

/// A card. `data` is the range of its lines in the text of the file.
#[derive(Clone)]
pub struct RadiossCard {
    /// The words on the keyword line in capitals, such as `GRNOD/NODE`.
    pub keyword: String,
    /// The first number on the keyword line; 0 if it has none.
    pub id: u32,
    /// The second number, which names a system of units; 0 if there is none.
    pub units: u32,
    pub file: u32,
    /// The line of the keyword, from 1. If an included file continues the card, the line before the first one there.
    pub line: u32,
    /// Whether the card began in another file, or before an included file.
    pub is_continued: bool,
    text: Arc<Vec<u8>>,
    data: Range<usize>,
}

impl RadiossCard {
    /// The name of the card in messages and labels, such as `/RBODY/7`.
    pub fn name(&self) -> String {
        let Self { keyword, id, .. } = self;
        if *id == 0 { format!("/{keyword}") } else { format!("/{keyword}/{id}") }
    }

    /// The lines, without comments. Blank lines are included, because a title may be blank.
    pub fn lines<'a>(&'a self, parameters: &'a Parameters) -> impl Iterator<Item = KeywordLine<'a>> + Clone {
        let (width, layout) = (FieldWidth::Columns, FieldLayout::Common);
        let data = self.text[self.data.clone()].split(|&byte| byte == b'\n').zip(self.line + 1..);
        let data = data.filter(|(text, _)| !matches!(text.first(), Some(b'#' | b'$')));
        let line = move |(text, number): (&'a [u8], u32)| {
            let text = text.strip_suffix(b"\r").unwrap_or(text);
            KeywordLine { number, text, width, layout, parameters }
        };
        data.map(line)
    }

    /// The lines after the title that are not blank.
    pub fn data<'a>(&'a self, parameters: &'a Parameters) -> impl Iterator<Item = KeywordLine<'a>> + Clone {
        self.lines(parameters).skip(usize::from(!self.is_continued)).filter(|line| !line.is_blank())
    }
}

/// The cards of a deck in order, up to `/END`, and its parameters.
#[derive(Default)]
pub struct RadiossCards {
    pub all: Vec<RadiossCard>,
    pub parameters: Parameters,
    /// The `//SUBMODEL` cards whose numbers have offsets. The cards of such submodels are not in `all`.
    pub submodels: Vec<RadiossCard>,
    /// Whether the next cards belong to such a submodel.
    is_inside: bool,
}

impl RadiossCards {
    /// Reads the cards of the main file and of all included files.
    pub fn read(sources: &mut Sources) -> Result<Self, DeckError> {
        let mut cards = Self::default();
        let start = RadiossCard {
            keyword: String::new(),
            id: 0,
            units: 0,
            file: 0,
            line: 0,
            is_continued: false,
            text: sources.text(0),
            data: 0..0,
        };
        cards.file(sources, 0, 0, &start)?;
        cards.check_version(sources)?;
        Ok(cards)
    }

    /// Reads a file, where `depth` counts the nested includes, and `open` is the card before it. Returns the card that is open at its end.
    fn file(
        &mut self,
        sources: &mut Sources,
        file: usize,
        depth: usize,
        open: &RadiossCard,
    ) -> Result<RadiossCard, DeckError> {
        let text = sources.text(file);
        let (mut at, mut line) = (if text.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 }, 0);
        let mut open = continued(open, file, line, &text, at);
        while at < text.len() {
            let end = memchr::memchr(b'\n', &text[at..]).map_or(text.len(), |k| at + k + 1);
            line += 1;
            if text[at] == b'/' {
                self.close(open, at);
                open = keyword(&text[at..end.min(at + LINE)], file, line, &text, end);
                if open.keyword == "END" {
                    return Ok(open);
                }
            } else if let Some(name) = included(&text[at..end]) {
                self.close(open.clone(), at);
                let inner = sources.include(&name, file, line as usize, depth)?;
                let last = self.file(sources, inner, depth + 1, &open)?;
                open = continued(&last, file, line, &text, end);
            }
            at = end;
        }
        self.close(open.clone(), at);
        Ok(open)
    }

    /// Adds a card that ends before byte `end`. Cards of a submodel whose numbers have offsets are left out.
    fn close(&mut self, mut card: RadiossCard, end: usize) {
        card.data.end = end.max(card.data.start);
        match card.keyword.as_str() {
            "/ENDSUB" => self.is_inside = false,
            "/SUBMODEL" if has_offsets(&card) => {
                self.is_inside = true;
                self.submodels.push(card);
            }
            "PARAMETER/GLOBAL/REAL" | "PARAMETER/GLOBAL/INT" => self.parameter(&card),
            _ if card.is_continued && !has_numbers(&card) => {}
            _ if self.is_inside || card.keyword.is_empty() => {}
            _ => self.all.push(card),
        }
    }

    fn parameter(&mut self, card: &RadiossCard) {
        let none = Parameters::default();
        let named = card.data(&none).map(|line| {
            let value = line.laid_out(FieldLayout::Wide).field(1);
            (line.field(0).to_ascii_uppercase(), Some(value.to_vec()))
        });
        self.parameters.extend(named);
    }

    /// Refuses decks of format versions whose fields have other columns.
    fn check_version(&self, sources: &Sources) -> Result<(), DeckError> {
        let Some(begin) = self.all.iter().find(|card| card.keyword == "BEGIN") else { return Ok(()) };
        let none = Parameters::default();
        let Some(line) = begin.lines(&none).nth(1) else { return Ok(()) };
        if matches!(line.whole(0), Ok(0 | OLDEST..)) {
            return Ok(());
        }
        let fault = line.expected(0, "a format version from 51 on");
        let (path, line) = (sources.path(begin.file as usize).to_path_buf(), fault.line as usize);
        Err(DeckError { path, line, card: begin.name(), field: fault.field, problem: fault.problem })
    }
}

/// The rest of a card after line `line` of another file.
fn continued(card: &RadiossCard, file: usize, line: u32, text: &Arc<Vec<u8>>, from: usize) -> RadiossCard {
    let keyword = card.keyword.clone();
    let (text, data) = (Arc::clone(text), from..from);
    RadiossCard { keyword, file: file as u32, line, is_continued: true, text, data, ..*card }
}

/// The card that a keyword line opens, such as `/GRNOD/NODE/12` or `//SUBMODEL/3`.
fn keyword(line: &[u8], file: usize, number: u32, text: &Arc<Vec<u8>>, end: usize) -> RadiossCard {
    let is_double = line.starts_with(b"//");
    let fields: Vec<&[u8]> = line.split(|&byte| byte == b'/').skip(1 + usize::from(is_double)).collect();
    let fields: Vec<&[u8]> = fields.into_iter().map(<[u8]>::trim_ascii).collect();
    let count = fields.iter().take_while(|field| whole(field).is_none() && !field.is_empty()).count();
    let words: Vec<String> = fields[..count].iter().map(|word| String::from_utf8_lossy(word).to_uppercase()).collect();
    let number_at = |k: usize| fields.get(k).and_then(|field| whole(field)).unwrap_or(0);
    let id = |k: usize| u32::try_from(number_at(k)).unwrap_or(u32::MAX);
    RadiossCard {
        keyword: if is_double { format!("/{}", words.join("/")) } else { words.join("/") },
        id: id(count),
        units: id(count + 1),
        file: file as u32,
        line: number,
        is_continued: false,
        text: Arc::clone(text),
        data: end..end,
    }
}

/// Whether a card has lines that begin with a number or a blank field. Text before the first keyword of an included file is a remark.
fn has_numbers(card: &RadiossCard) -> bool {
    let none = Parameters::default();
    let first = card.data(&none).next().and_then(|line| line.text.first().copied());
    first.is_some_and(|byte| byte.is_ascii_digit() || matches!(byte, b' ' | b'\t' | b'+' | b'-' | b'&'))
}

/// The name on a line `#include NAME`.
fn included(line: &[u8]) -> Option<String> {
    const WORD: &[u8] = b"#include";
    let (word, name) = line.split_at_checked(WORD.len())?;
    let is_include = word.eq_ignore_ascii_case(WORD) && name.first().is_some_and(u8::is_ascii_whitespace);
    is_include.then(|| String::from_utf8_lossy(name.trim_ascii()).into_owned())
}

/// Whether a submodel shifts the numbers of its nodes, elements and options. Its second line has the offsets.
fn has_offsets(card: &RadiossCard) -> bool {
    let none = Parameters::default();
    let is_shift = |line: KeywordLine| (0..7).any(|field| !matches!(line.whole(field), Ok(0)));
    card.lines(&none).nth(1).is_some_and(is_shift)
}

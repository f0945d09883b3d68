//! Visits the cards of a deck and of the files that it includes.

use std::sync::Arc;

use crate::bytes::LINE;
use crate::deck::calculix::syntax::DataPiece;
use crate::deck::calculix::syntax::assembly::AssemblyExpansion;
use crate::deck::calculix::syntax::card::{KeywordCard, Visit};
use crate::deck::{DeckError, Problem, Sources};

/// Cards whose data may be in another file.
const WITH_INPUT: [&str; 7] = ["*NODE", "*ELEMENT", "*NSET", "*ELSET", "*SURFACE", "*EQUATION", "*BOUNDARY"];

/// Visits every card in order. Cards of an Abaqus part are visited once for each of its instances.
pub fn walk(sources: &mut Sources, visit: Visit) -> Result<(), DeckError> {
    let paths = sources.paths().to_vec();
    let mut parts = AssemblyExpansion::default();
    let mut expand = |card: &KeywordCard| {
        let path = || paths.get(card.file as usize).cloned().unwrap_or_default();
        parts.card(card, visit).map_err(|stop| stop.at(card, path))
    };
    let mut card = KeywordCard::default();
    let mut walk = Walk { sources };
    walk.file(0, 0, &mut card, &mut expand)?;
    finish(&mut card, &mut expand)
}

struct Walk<'s, 'o> {
    sources: &'s mut Sources<'o>,
}

/// Passes on a complete card.
fn finish(card: &mut KeywordCard, visit: Visit) -> Result<(), DeckError> {
    if card.keyword.is_empty() {
        return Ok(());
    }
    visit(card)?;
    card.keyword.clear();
    Ok(())
}

impl Walk<'_, '_> {
    /// Reads one file: keyword lines, each with its data.
    fn file(&mut self, file: usize, depth: usize, card: &mut KeywordCard, visit: Visit) -> Result<(), DeckError> {
        let text = self.sources.text(file);
        let mut at = if text.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
        let mut line = 1;
        while at < text.len() {
            let end = next_keyword(&text, at);
            if end > at {
                let lines = memchr::memchr_iter(b'\n', &text[at..end]).count();
                card.data.push(DataPiece {
                    file: file as u32,
                    line: line as u32,
                    range: at..end,
                    text: Arc::clone(&text),
                });
                (at, line) = (end, line + lines);
                continue;
            }
            let (end, lines) = keyword_end(&text, at);
            let keyword = &text[at..end];
            if keyword.len() > LINE {
                return Err(self.too_long(file, line));
            }
            if is_include(keyword) {
                card_input(keyword).map_or(Ok(()), |name| self.include(&name, (file, line), depth, card, visit))?;
            } else {
                finish(card, visit)?;
                card.begin(keyword, file, line);
                let name = card.parameter("INPUT").filter(|_| WITH_INPUT.iter().any(|with| card.is(with)));
                if let Some(name) = name.map(str::to_owned) {
                    self.include(&name, (file, line), depth, card, visit)?;
                }
            }
            (at, line) = (end, line + lines);
        }
        Ok(())
    }

    /// Continues in another file; its first lines may be data of the open card.
    fn include(
        &mut self,
        name: &str,
        (file, line): (usize, usize),
        depth: usize,
        card: &mut KeywordCard,
        visit: Visit,
    ) -> Result<(), DeckError> {
        let inner = self.sources.include(name, file, line, depth)?;
        self.file(inner, depth + 1, card, visit)
    }

    fn too_long(&self, file: usize, line: usize) -> DeckError {
        let problem = Problem::Limit { what: "the length of a line", limit: LINE, advice: "break it" };
        DeckError { path: self.sources.path(file).to_path_buf(), line, card: "keyword".into(), field: None, problem }
    }
}

/// Start of the next keyword line at or after `from`, which must be the start of a line.
pub fn next_keyword(text: &[u8], from: usize) -> usize {
    memchr::memchr_iter(b'*', &text[from..])
        .map(|k| from + k)
        .find(|&k| (k == from || text[k - 1] == b'\n') && text.get(k + 1) != Some(&b'*'))
        .unwrap_or(text.len())
}

/// End of a keyword line with its continuation lines after trailing commas, and the number of these lines.
pub fn keyword_end(text: &[u8], from: usize) -> (usize, usize) {
    let mut end = from;
    for lines in 1.. {
        let line = &text[end..];
        let length = memchr::memchr(b'\n', line).map_or(line.len(), |k| k + 1);
        end += length;
        let goes_on = line[..length].trim_ascii_end().ends_with(b",") && !matches!(text.get(end), None | Some(b'*'));
        if !goes_on {
            return (end, lines);
        }
    }
    (end, 1)
}

pub fn is_include(keyword: &[u8]) -> bool {
    let word = keyword.split(|&byte| byte == b',').next().unwrap_or_default();
    word.trim_ascii().eq_ignore_ascii_case(b"*INCLUDE")
}

pub fn card_input(keyword: &[u8]) -> Option<String> {
    let mut card = KeywordCard::default();
    card.begin(keyword, 0, 0);
    card.parameter("INPUT").map(str::to_owned)
}

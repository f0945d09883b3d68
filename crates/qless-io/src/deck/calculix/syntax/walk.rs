//! Visits the cards of a deck and of the files that it includes.

use std::sync::Arc;

use crate::bytes::LINE;
use crate::deck::calculix::syntax::assembly::AssemblyExpansion;
use crate::deck::calculix::syntax::parameters::DeckParameters;
use crate::deck::calculix::syntax::{DataPiece, KeywordCard, card::Visit};
use crate::deck::{DeckError, Problem, Sources};

/// Cards whose data may be in another file, which `INPUT=` names.
const WITH_INPUT: [&str; 7] = ["*NODE", "*ELEMENT", "*NSET", "*ELSET", "*SURFACE", "*EQUATION", "*BOUNDARY"];

/// Visits every card in order, with the values of parameters. Cards of an Abaqus part are visited once for each of its instances.
pub fn walk(sources: &mut Sources, parameters: &DeckParameters, visit: Visit) -> Result<(), DeckError> {
    let paths = sources.paths().to_vec();
    let mut parts = AssemblyExpansion::default();
    let mut expand = |card: &KeywordCard| {
        let path = || paths.get(card.file as usize).cloned().unwrap_or_default();
        parts.card(card, visit).map_err(|stop| stop.at(card, path))
    };
    let mut card = KeywordCard::default();
    walk_file(sources, parameters, (0, 0), &mut card, &mut expand)?;
    finish(&mut card, &mut expand)
}

/// Passes a complete card to `visit`; does nothing if no card has begun.
fn finish(card: &mut KeywordCard, visit: Visit) -> Result<(), DeckError> {
    if card.keyword.is_empty() {
        return Ok(());
    }
    visit(card)?;
    card.keyword.clear();
    Ok(())
}

/// Visits the cards of one file: keyword lines, each with its data. `depth` counts the nested includes. The last card stays in `card`,
/// because its data may continue in the including file.
fn walk_file(
    sources: &mut Sources,
    parameters: &DeckParameters,
    (file, depth): (usize, usize),
    card: &mut KeywordCard,
    visit: Visit,
) -> Result<(), DeckError> {
    let text = sources.text(file);
    let mut at = if text.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
    let mut line = 1;
    while at < text.len() {
        let end = next_keyword(&text, at);
        if end > at {
            let lines = memchr::memchr_iter(b'\n', &text[at..end]).count();
            let (range, text) = match parameters.replaced(&text[at..end]) {
                Some(new) => (0..new.len(), Arc::new(new)),
                None => (at..end, Arc::clone(&text)),
            };
            card.data.push(DataPiece { file: file as u32, line: line as u32, range, text });
            (at, line) = (end, line + lines);
            continue;
        }
        let (end, lines) = keyword_end(&text, at);
        let keyword = &text[at..end];
        if keyword.len() > LINE {
            let problem = Problem::Limit { what: "the length of a line", limit: LINE, advice: "break it" };
            let path = sources.path(file).to_path_buf();
            return Err(DeckError { path, line, card: "keyword".into(), field: None, problem });
        }
        let included = if is_include(keyword) {
            card_input(keyword)
        } else {
            finish(card, visit)?;
            let replaced = parameters.replaced(keyword);
            card.begin(replaced.as_deref().unwrap_or(keyword), file, line);
            let input = card.parameter("INPUT").filter(|_| WITH_INPUT.iter().any(|with| card.is(with)));
            input.map(str::to_owned)
        };
        if let Some(name) = included {
            let inner = sources.include(&name, file, line, depth)?;
            walk_file(sources, parameters, (inner, depth + 1), card, visit)?;
        }
        (at, line) = (end, line + lines);
    }
    Ok(())
}

/// Where the next keyword line starts, at or after `from`. `from` must be the start of a line. The first byte of a keyword line that is not
/// blank is a star.
pub fn next_keyword(text: &[u8], from: usize) -> usize {
    let keyword = |star: usize| {
        let blanks = from + text[from..star].trim_ascii_end().len();
        let start = memchr::memrchr(b'\n', &text[blanks..star]).map_or(blanks, |end| blanks + end + 1);
        let is_first = start == from || text[start - 1] == b'\n';
        (is_first && text.get(star + 1) != Some(&b'*')).then_some(start)
    };
    memchr::memchr_iter(b'*', &text[from..]).find_map(|k| keyword(from + k)).unwrap_or(text.len())
}

/// Where a keyword line ends, and the number of lines that it takes. A line that ends with a comma continues on the next line.
pub fn keyword_end(text: &[u8], from: usize) -> (usize, usize) {
    let mut end = from;
    for lines in 1.. {
        let line = &text[end..];
        let length = memchr::memchr(b'\n', line).map_or(line.len(), |k| k + 1);
        end += length;
        let goes_on = line[..length].trim_ascii_end().ends_with(b",")
            && !matches!(text[end..].trim_ascii_start().first(), None | Some(b'*'));
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

//! Detects the format of a deck by its first cards. If a card is valid in several formats, the expected format decides.

mod unrecognized;
mod words;

pub use unrecognized::UnrecognizedText;

use super::Format;

/// Largest number of lines that are examined; blank lines and comments do not count.
const LINES: usize = 1000;

/// How strongly a line points to a format.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Evidence {
    /// The line does not point to the format.
    None,
    /// The line may be a card of the format.
    Possible,
    /// The line is a card of this format, and also of another format that is more common.
    Shared,
    /// The line is a card of the format.
    Certain,
}

/// Returns the format of a text. `expected` is the format that belongs to the file's ending or to the requested solver.
pub fn format_of(text: &[u8], expected: Option<Format>) -> Result<Format, UnrecognizedText> {
    if let Some(foreign) = UnrecognizedText::foreign(text) {
        return Err(foreign);
    }
    let mut is_possible = false;
    for line in lines(text).take(LINES) {
        let says = |format: Format| evidence(format, line);
        if expected.is_some_and(|format| says(format) == Evidence::Shared) {
            is_possible = true;
            continue;
        }
        let certain: Vec<Format> = Format::ALL.into_iter().filter(|&f| says(f) == Evidence::Certain).collect();
        match (certain.as_slice(), expected) {
            (&[format], _) => return Ok(format),
            (several, Some(format)) if several.contains(&format) => return Ok(format),
            _ => is_possible |= expected.is_some_and(|format| says(format) == Evidence::Possible),
        }
    }
    expected.filter(|_| is_possible).ok_or_else(|| UnrecognizedText::from_text(text))
}

/// The lines, trimmed, without blank lines and without comments of any format.
fn lines(text: &[u8]) -> impl Iterator<Item = &[u8]> {
    let text = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text);
    let lines = text.split(|&byte| byte == b'\n').map(<[u8]>::trim_ascii);
    let is_comment = |line: &[u8]| line.starts_with(b"**") || matches!(line.first(), None | Some(b'$' | b'!'));
    lines.filter(move |line| !is_comment(line))
}

fn evidence(format: Format, line: &[u8]) -> Evidence {
    if line.iter().any(|byte| byte.is_ascii_control() && *byte != b'\t') {
        return Evidence::None;
    }
    match format {
        Format::Calculix => calculix(line),
        Format::Nastran => nastran(line),
        Format::Ansys => ansys(line),
        Format::LsDyna => lsdyna(line),
        Format::Radioss => radioss(line),
    }
}

/// How strongly a line points to CalculiX or Abaqus, such as `*NODE` or `*RIGID BODY, ...`.
fn calculix(line: &[u8]) -> Evidence {
    let Some(rest) = line.strip_prefix(b"*") else { return Evidence::None };
    let keyword = rest.split(|&byte| byte == b',').next().unwrap_or_default();
    let first = keyword.split(|byte| !byte.is_ascii_alphanumeric()).next().unwrap_or_default();
    let is_keyword = keyword.first().is_some_and(u8::is_ascii_alphabetic)
        && keyword.iter().all(|&byte| byte.is_ascii_alphanumeric() || matches!(byte, b' ' | b'-' | b'\t'));
    // `*END` alone is no keyword here, because it ends a macro of APDL. `*END STEP` is one.
    match is_keyword && !words::is_in(words::APDL_STARRED, keyword.trim_ascii()) {
        true if words::is_in(words::CALCULIX, first) => Evidence::Certain,
        true => Evidence::Possible,
        false => Evidence::None,
    }
}

/// How strongly a line points to LS-DYNA, such as `*KEYWORD`, `*SET_NODE_LIST` or `*NODE`.
fn lsdyna(line: &[u8]) -> Evidence {
    let Some(rest) = line.strip_prefix(b"*") else { return Evidence::None };
    let keyword = rest.split(u8::is_ascii_whitespace).next().unwrap_or_default();
    let mut words = keyword.split(|&byte| byte == b'_');
    let is_known = words.next().is_some_and(|first| words::is_in(words::LSDYNA, first.trim_ascii_end()));
    match is_known {
        true if words.next().is_some() || keyword.eq_ignore_ascii_case(b"KEYWORD") => Evidence::Certain,
        true => Evidence::Shared,
        false => Evidence::None,
    }
}

/// How strongly a line points to Radioss: `#RADIOSS STARTER`, or the first card `/BEGIN`. All other cards start as commands of ANSYS do.
fn radioss(line: &[u8]) -> Evidence {
    const START: &[u8] = b"#RADIOSS";
    let is_start = line.get(..START.len()).is_some_and(|start| start.eq_ignore_ascii_case(START));
    match is_start || line.strip_suffix(b"/").unwrap_or(line).eq_ignore_ascii_case(b"/BEGIN") {
        true => Evidence::Certain,
        false if line.starts_with(b"/") => Evidence::Shared,
        false => Evidence::None,
    }
}

/// How strongly a line points to Nastran, such as `SOL 101`, `SPC = 1`, `GRID,1,...` or `GRID* 1`.
fn nastran(line: &[u8]) -> Evidence {
    let end = line.iter().position(|byte| !byte.is_ascii_alphanumeric()).unwrap_or(line.len());
    let (name, rest) = line.split_at(end);
    let rest = rest.strip_prefix(b"*").unwrap_or(rest);
    let next = rest.iter().copied().find(|byte| !matches!(byte, b' ' | b'\t' | b','));
    let is_card = name.first().is_some_and(u8::is_ascii_alphabetic) && name.len() <= 8;
    let is_field = matches!(rest.first(), Some(b',' | b' ' | b'\t'));
    let is_number = next.is_some_and(|byte| byte.is_ascii_digit() || matches!(byte, b'+' | b'-' | b'.'));
    let is_set = next == Some(b'=') || rest.contains(&b'=');
    if words::is_in(words::NASTRAN_ALONE, line) || is_card && is_control(name, rest, is_set) {
        return Evidence::Certain;
    }
    match is_card && is_field {
        true if words::is_in(words::NASTRAN_BULK, name) && (is_number || rest.starts_with(b",")) => Evidence::Certain,
        true if is_number => Evidence::Possible,
        _ => Evidence::None,
    }
}

/// Whether a line belongs to the executive control or the case control of Nastran.
fn is_control(name: &[u8], rest: &[u8], is_set: bool) -> bool {
    let word = rest.trim_ascii().split(|byte| !byte.is_ascii_alphanumeric()).next().unwrap_or_default();
    let of_two = [("SOL", ""), ("BEGIN", "BULK"), ("BEGIN", "SUPER"), ("BEGIN", "AUXMODEL"), ("SUBCASE", "")];
    let is_pair = |(first, second): (&str, &str)| {
        name.eq_ignore_ascii_case(first.as_bytes())
            && (second.is_empty() && !word.is_empty() && rest.starts_with(b" ")
                || word.eq_ignore_ascii_case(second.as_bytes()))
    };
    of_two.into_iter().any(is_pair) || is_set && words::is_in(words::NASTRAN_CONTROL, name)
}

/// How strongly a line points to ANSYS, such as `/PREP7`, `*DIM,...`, `CE,...` or `NBLOCK,...`.
fn ansys(line: &[u8]) -> Evidence {
    let (mark, rest) = match line.first() {
        Some(mark @ (b'/' | b'*')) => (Some(*mark), &line[1..]),
        _ => (None, line),
    };
    let end = rest.iter().position(|byte| !byte.is_ascii_alphanumeric()).unwrap_or(rest.len());
    let (name, tail) = rest.split_at(end);
    let ends = matches!(tail.first(), None | Some(b',' | b' ' | b'\t'));
    let tail = tail.trim_ascii_start();
    let is_command = name.first().is_some_and(u8::is_ascii_alphabetic) && ends && name.len() <= 8;
    match mark {
        _ if !is_command || radioss(line) == Evidence::Certain => Evidence::None,
        Some(b'/') => Evidence::Certain,
        Some(_) if words::is_in(words::APDL_STARRED, name) && is_end(tail) => Evidence::Certain,
        None if words::is_in(words::APDL, name) && tail.starts_with(b",") => Evidence::Certain,
        None if words::is_in(words::APDL_ALONE, name) && tail.is_empty() => Evidence::Certain,
        None if tail.starts_with(b",") => Evidence::Possible,
        Some(_) | None => Evidence::None,
    }
}

/// Whether nothing but fields or a comment follows the name of a command.
fn is_end(tail: &[u8]) -> bool {
    matches!(tail.first(), None | Some(b',' | b'!'))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn detect(text: &str) -> Option<Format> {
        format_of(text.as_bytes(), None).ok()
    }

    #[test]
    fn the_first_card_decides() {
        for (format, texts) in [
            (
                Format::Calculix,
                &["*NODE\n", "\u{feff}** a\n\n  *Heading\nSOL 101\n", "*END PART\n", "*Rigid Body, x\n"][..],
            ),
            (
                Format::Nastran,
                &["SOL 101\n", "$ a\nID a,b\nCEND\n", "grid,1,,0.,0.,0.\n", "GRID*   1\n", "SPC = 4\n", "BEGIN BULK\n"],
            ),
            (
                Format::Nastran,
                &[
                    "TITLE = *NODE\n",
                    "RBE2    1       2       123     3\n",
                    "PARAM,POST,-1\n",
                    "subcase 1\n",
                    "ENDDATA\n",
                ],
            ),
            (
                Format::Ansys,
                &[
                    "/COM, *NODE\n",
                    "! a\n/PREP7\n",
                    "CE,1,0,1,UX,1\n",
                    " ce , 1 , 0 , 1 , ux , 1\n",
                    "*DIM,a,,2\n",
                    "a=1\nD,1,UX\n",
                    "FINISH\n",
                ],
            ),
            (
                Format::LsDyna,
                &["*KEYWORD\n*NODE\n", "$ comment\n*Keyword LONG=Y\n*NODE\n", "*NODE_SCALAR\n", "*SET_NODE_LIST\n 1\n"],
            ),
            (
                Format::Radioss,
                &["#RADIOSS STARTER\n/BEGIN\n", "#--1--|\n\n#Radioss Starter\n", "# a\n/BEGIN/\nrun\n", "/begin\n"],
            ),
        ] {
            texts.iter().for_each(|text| assert_eq!(detect(text), Some(format), "{text}"));
        }
    }

    #[test]
    fn the_expected_format_only_breaks_ties() {
        // RBE3 is a card of Nastran and a command of APDL.
        let both = b"RBE3,1,ALL,2\n";
        for format in [Format::Nastran, Format::Ansys] {
            assert_eq!(format_of(both, Some(format)), Ok(format));
            assert_eq!(format_of(b"*NODE\n1,0.,0.,0.\n", Some(format)), Ok(Format::Calculix));
        }
        assert!(format_of(both, None).is_err());
        // *NODE is a card of CalculiX and of LS-DYNA.
        assert_eq!(format_of(b"*NODE\n1,0.,0.,0.\n", Some(Format::LsDyna)), Ok(Format::LsDyna));
        for certain in ["*NODE, NSET=A\n1,0.,0.,0.\n", "*NODE\n1,0.,0.,0.\n*EQUATION\n2\n"] {
            assert_eq!(format_of(certain.as_bytes(), Some(Format::LsDyna)), Ok(Format::Calculix), "{certain}");
        }
        // `*NOVELTY` is a keyword that is in none of the lists.
        assert_eq!(format_of(b"*NOVELTY\n", Some(Format::Calculix)), Ok(Format::Calculix));
        assert!(format_of(b"*NOVELTY\n", None).is_err());
    }

    #[test]
    fn unknown_texts_are_described() {
        for (text, message) in [
            (&b""[..], "it is empty"),
            (b" \n\n", "it is empty"),
            (b"** a\n$ b\n! c\n", "line 1 is `** a`"),
            (b"<!DOCTYPE html>\n<p>", "it starts as an HTML page"),
            (b"\n\n  hello world, this is a letter\n", "line 3 is `hello world, this is a letter`"),
            (b"*NODAL_SCALAR\n", "line 1 is `*NODAL_SCALAR`"),
            (b"PK\x03\x04abc", "it starts as a zip archive"),
            (b"*\0N\0O\0D\0E\0\n\0", "zero bytes, as in UTF-16 without a byte order mark"),
            (b"\x01\x02\xfe*NODE\n", "it starts with the bytes 01 02 fe 2a 4e 4f 44 45"),
        ] {
            for expected in [None, Some(Format::Calculix), Some(Format::Nastran), Some(Format::Ansys)] {
                let seen = format_of(text, expected).expect_err(message).to_string();
                assert!(seen.contains(message), "{seen}");
            }
        }
    }
}

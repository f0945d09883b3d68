//! The lines before the numbers of a Matrix Market file, of which there may be many.

use std::io::BufRead;

use super::File;
use crate::ReadError;
use crate::lines::{Line, Lines};
use crate::matrix_market::header::is_banner;

/// Header and sizes, with blank lines in place of comments, so that they take no memory and lines keep their numbers.
pub(super) struct Head {
    pub text: Vec<u8>,
    /// Bytes of the file that it stands for.
    pub end: u64,
}

/// Reads the head; None if the first line with anything in it is no Matrix Market header, unless `any` will do.
pub(super) fn read(file: &File, any: bool) -> Result<Option<Head>, ReadError> {
    let mut reader = file.reader()?;
    let mut head = Head { text: Vec::new(), end: 0 };
    let (mut line, mut found) = (Vec::new(), 0);
    while found < 2 {
        line.clear();
        if reader.read_until(b'\n', &mut line).map_err(ReadError::io(file.path()))? == 0 {
            break;
        }
        let mut lines = if head.end == 0 { Lines::new(&line) } else { Lines::after(&line, 0) };
        let only = lines.any();
        head.end += line.len() as u64;
        let counts =
            |line: &Line| if found == 0 { !line.text.trim_ascii().is_empty() } else { line.words().next().is_some() };
        if !only.as_ref().is_some_and(counts) {
            head.text.push(b'\n');
            continue;
        }
        if found == 0 && !any && !only.as_ref().is_some_and(is_banner) {
            return Ok(None);
        }
        found += 1;
        head.text.extend_from_slice(&line);
    }
    Ok((any || found > 0).then_some(head))
}

//! Reads the two most frequent lines of archives by a fast path. They have plain numbers and nothing else on the line:
//!
//! ```text
//! CE,R5.0,DEFI, terms, NEQN, CONST
//! CE,R5.0,NODE, NODE1, Lab1, C1, NODE2, Lab2, C2
//! ```
//!
//! Every other line takes the general path, which also reports errors.

use super::label;
use crate::deck::Dof;
use crate::number::leading;

/// Limit on the bytes of a line that the fast path reads.
const LINE: usize = 200;

/// A DOF and its coefficient.
pub type DofCoefficient = (Dof, f64);

/// A line that the fast path has read.
#[derive(Debug, PartialEq)]
pub struct ArchiveLine {
    /// The tag of the archive.
    pub tag: &'static str,
    /// The bytes of the line, line ending included.
    pub length: usize,
    pub statement: ArchiveStatement,
}

/// The content of a line that the fast path has read.
#[derive(Debug, PartialEq)]
pub enum ArchiveStatement {
    /// A `DEFI` line, which begins an equation: number of terms, number of the equation, constant.
    Define(u32, u32, f64),
    /// A `NODE` line, which holds one or two terms.
    Terms(DofCoefficient, Option<DofCoefficient>),
}

/// Reads the first line of the text. Returns `None` if the general path must read it.
pub fn read(text: &[u8]) -> Option<ArchiveLine> {
    let (tag, rest) = match text.first_chunk()? {
        b"CE,R5.0," => ("R5.0", &text[8..]),
        b"CE,UNBL," => ("UNBL", &text[8..]),
        _ => return None,
    };
    let (word, rest) = rest.split_first_chunk()?;
    let mut rest = ArchiveCursor(&rest[..rest.len().min(LINE)]);
    let statement = match word {
        b"DEFI," => ArchiveStatement::Define(
            rest.whole()?,
            rest.next()?.whole().filter(|&number| number > 0)?,
            rest.next()?.real()?,
        ),
        b"NODE," => {
            let first = rest.term()?;
            let second = match rest.next() {
                Some(rest) => Some(rest.term()?),
                None => None,
            };
            ArchiveStatement::Terms(first, second)
        }
        _ => return None,
    };
    let rest = rest.end()?;
    Some(ArchiveLine { tag, length: text.len().min(8 + 5 + LINE) - rest, statement })
}

/// The bytes that are still to read.
struct ArchiveCursor<'a>(&'a [u8]);

impl<'a> ArchiveCursor<'a> {
    /// Reads a term, `node, label, coefficient`.
    fn term(&mut self) -> Option<DofCoefficient> {
        let node = self.whole().filter(|&node| node > 0)?;
        let component = label::component(self.next()?.word())?;
        Some((Dof { node, component }, self.next()?.real()?))
    }

    /// Skips the comma after a field.
    fn next(&mut self) -> Option<&mut Self> {
        self.blanks();
        self.0 = self.0.strip_prefix(b",")?;
        Some(self)
    }

    fn blanks(&mut self) {
        let mut rest = self.0;
        while let [b' ', after @ ..] = rest {
            rest = after;
        }
        self.0 = rest;
    }

    /// Reads a whole number of at most nine digits.
    fn whole(&mut self) -> Option<u32> {
        self.blanks();
        let (mut value, mut rest) = (0_u32, self.0);
        while let [digit @ b'0'..=b'9', after @ ..] = rest {
            (value, rest) = (value.wrapping_mul(10).wrapping_add(u32::from(digit - b'0')), after);
        }
        let count = self.0.len() - rest.len();
        self.0 = rest;
        (1..=9).contains(&count).then_some(value)
    }

    fn real(&mut self) -> Option<f64> {
        self.blanks();
        let (value, length) = leading(self.0)?;
        self.0 = &self.0[length..];
        Some(value)
    }

    fn word(&mut self) -> &'a [u8] {
        self.blanks();
        let end = self.0.iter().position(|byte| matches!(byte, b' ' | b',')).unwrap_or(self.0.len());
        let (word, rest) = self.0.split_at(end);
        self.0 = rest;
        word
    }

    /// Number of bytes in the text after this line; `None` if other characters follow on the line.
    fn end(mut self) -> Option<usize> {
        self.blanks();
        let rest = self.0.strip_prefix(b"\r").unwrap_or(self.0);
        rest.strip_prefix(b"\n").map(<[u8]>::len)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dof(node: u32, component: u8) -> Dof {
        Dof { node, component }
    }

    #[test]
    fn lines_of_archives() {
        let text = b"CE,R5.0,DEFI,       2,      12, -0.50000000    \r\nCE,R5.0,NODE";
        let statement = ArchiveStatement::Define(2, 12, -0.5);
        assert_eq!(read(text), Some(ArchiveLine { tag: "R5.0", length: 49, statement }));
        let text = b"CE,UNBL,NODE,      77,UX  ,  1.00000000    ,       9,ROTZ, -0.25000000E+01\n";
        let statement = ArchiveStatement::Terms((dof(77, 1), 1.0), Some((dof(9, 6), -2.5)));
        assert_eq!(read(text), Some(ArchiveLine { tag: "UNBL", length: text.len(), statement }));
        let statement = ArchiveStatement::Terms((dof(1, 11), 0.0), None);
        assert_eq!(read(b"CE,R5.0,NODE,1,temp,0\nD"), Some(ArchiveLine { tag: "R5.0", length: 22, statement }));
    }

    #[test]
    fn all_other_lines_are_left_to_the_general_path() {
        for text in [
            "CE,1,0.,2,UX,1.\n",
            "CE,R5.1,DEFI,2,1,0.\n",
            "CE,R5.0,DEFI,2,1,0.",
            "CE,R5.0,DEFI,2,0,0.\n",
            "CE,R5.0,DEFI,2,1\n",
            "CE,R5.0,DEFI,2,1,\n",
            "CE,R5.0,DEFI,2,1,0.,\n",
            "CE,R5.0,DEFI,2,1,0. ! a gap\n",
            "CE,R5.0,DEFI,2,1,0. $ CE,2\n",
            "CE,R5.0,DEFI,2,1234567890,0.\n",
            "CE,R5.0,NODE,-1,UX,1.\n",
            "CE,R5.0,NODE,1,U,1.\n",
            "CE,R5.0,NODE,1,UX,1.x\n",
            "CE,R5.0,NODE,1,UX,1.,\n",
            "CE,R5.0,NODE,1,UX,1.,2,UX\n",
            "CE,R5.0,NODE,1,UX,1.,2,UX,1.,3,UX,1.\n",
            "ce,r5.0,defi,2,1,0.\n",
            "CE,R5.0,",
        ] {
            assert_eq!(read(text.as_bytes()), None, "{text}");
        }
        let long = format!("CE,R5.0,DEFI,2,1,0.{}\n", " ".repeat(LINE));
        assert_eq!(read(long.as_bytes()), None);
    }
}

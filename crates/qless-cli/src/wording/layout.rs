//! Lays out text in limited space: breaks and fills lines, and shows sections with a heading and items.
//!
//! A character beyond Latin, Greek and Cyrillic counts as two columns.

/// Width of a text in columns.
pub fn width(text: &str) -> usize {
    text.chars().map(columns).sum()
}

fn columns(c: char) -> usize {
    if c < '\u{1100}' { 1 } else { 2 }
}

/// Shortens a text to `most` columns. Leaves out the middle, since names differ at their ends.
pub fn shorten(text: &str, most: usize) -> String {
    if width(text) <= most {
        return text.to_owned();
    }
    let room = most.saturating_sub(3);
    let head: String = take(text.chars(), room.div_ceil(2));
    let tail: String = take(text.chars().rev(), room / 2);
    head + "..." + &tail.chars().rev().collect::<String>()
}

fn take(text: impl Iterator<Item = char>, most: usize) -> String {
    let mut used = 0;
    let fits = |c: &char| {
        used += columns(*c);
        used <= most
    };
    text.take_while(fits).collect()
}

/// Breaks the lines of a text at spaces, so that none has more than `most` columns unless it holds a single longer word. Continuations
/// are indented by two more columns than their line.
pub fn wrap(text: &str, most: usize) -> String {
    text.split_inclusive('\n').map(|line| wrap_line(line, most)).collect()
}

fn wrap_line(line: &str, most: usize) -> String {
    if width(line.trim_end()) <= most {
        return line.to_owned();
    }
    let indent = line.len() - line.trim_start_matches(' ').len();
    let hanging = format!("\n{}", " ".repeat((indent + 2).min(most / 2)));
    let mut out = " ".repeat(indent);
    let mut used = indent;
    for (k, word) in line[indent..].split_inclusive(' ').enumerate() {
        if k > 0 && used + width(word.trim_end()) > most {
            out.truncate(out.trim_end_matches(' ').len());
            out.push_str(&hanging);
            used = hanging.len() - 1;
        }
        out.push_str(word);
        used += width(word);
    }
    out
}

/// Fills at most `lines` lines of at most `most` columns with pieces, and counts the pieces that fit.
///
/// The first line starts with `first`, the others with `indent`. If not all pieces fit, `reserve` columns of the last line stay
/// free.
pub fn flow(first: &str, indent: &str, pieces: &[String], (lines, most): (usize, usize), reserve: usize) -> Flow {
    let whole = fill(first, indent, pieces, (lines, most), 0);
    if whole.used == pieces.len() { whole } else { fill(first, indent, pieces, (lines, most), reserve) }
}

fn fill(first: &str, indent: &str, pieces: &[String], (lines, most): (usize, usize), reserve: usize) -> Flow {
    let mut flow = Flow { lines: vec![first.to_owned()], used: 0 };
    for (k, piece) in pieces.iter().enumerate() {
        let is_last_line = flow.lines.len() == lines;
        let keep = if is_last_line { reserve } else { 0 };
        let line = flow.lines.last_mut().expect("starts with one line");
        if width(line) + width(piece) + keep <= most {
            line.push_str(piece);
        } else if is_last_line {
            break;
        } else {
            flow.lines.push(format!("{indent}{}", piece.trim_start()));
        }
        flow.used = k + 1;
    }
    flow
}

/// Lines, and the number of pieces in them.
pub struct Flow {
    pub lines: Vec<String>,
    pub used: usize,
}

impl Flow {
    /// Adds a text to the last line.
    pub fn finish(mut self, tail: &str) -> Vec<String> {
        self.lines.last_mut().expect("starts with one line").push_str(tail);
        self.lines
    }
}

/// Largest number of items shown; JSON has all of them.
const ITEMS_SHOWN: usize = 4;

/// A heading with items, for findings other than equations.
pub struct LayoutSection {
    heading: String,
    items: Vec<String>,
}

impl LayoutSection {
    /// A section with these items; `None` if there are no items.
    pub fn new(heading: impl Into<String>, items: Vec<String>) -> Option<Self> {
        let heading = heading.into();
        (!items.is_empty()).then_some(Self { heading, items })
    }

    /// Number of lines that the section wants: heading, items, and one line for the items that are not shown.
    fn wanted(&self) -> usize {
        1 + self.items.len().min(ITEMS_SHOWN + 1)
    }

    /// The section in at most `most` lines, but at least one.
    fn lines(&self, most: usize) -> Vec<String> {
        let all = self.items.len();
        if most <= 1 {
            return vec![format!("{} {all} (all of them: --format json)", self.heading)];
        }
        let room = most - 1;
        let shown = if all <= room && all <= ITEMS_SHOWN + 1 { all } else { (room - 1).min(ITEMS_SHOWN) };
        let mut lines = vec![self.heading.clone()];
        lines.extend(self.items.iter().take(shown).map(|item| format!("  {item}")));
        if shown < all {
            let more = if shown == 0 { "" } else { " more" };
            lines.push(format!("  and {}{more} (all of them: --format json)", all - shown));
        }
        lines
    }
}

/// The fewest lines that the sections need, and the lines that they want.
pub fn section_needs(sections: &[LayoutSection]) -> (usize, usize) {
    (sections.len(), sections.iter().map(LayoutSection::wanted).sum())
}

/// The sections in at most `most` lines, but at least one line each. The first sections get more lines.
pub fn section_lines(sections: &[LayoutSection], most: usize) -> Vec<String> {
    let mut spare = most.saturating_sub(sections.len());
    let mut lines = Vec::new();
    for section in sections {
        let more = spare.min(section.wanted() - 1);
        // A single line under the heading would show no item, only how many there are. The heading alone, without that line, has the same
        // number.
        let more = if more == 1 && section.items.len() > 1 { 0 } else { more };
        spare -= more;
        lines.extend(section.lines(1 + more));
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_is_left_out() {
        assert_eq!(shorten("tie A/B, node 4711, x", 30), "tie A/B, node 4711, x");
        assert_eq!(shorten("tie A/B, node 4711, x", 14), "tie A/...11, x");
        assert_eq!(width(&shorten(&"\u{8282}".repeat(40), 15)), 15);
    }

    #[test]
    fn long_lines_break_at_spaces() {
        let text = "short\n  Next: change 4:1 from 0.5 to 0: cures row 3.\nabcdefghijklmnopqrstuvwxyz\n";
        let wrapped = "short\n  Next: change 4:1\n    from 0.5 to 0:\n    cures row 3.\nabcdefghijklmnopqrstuvwxyz\n";
        assert_eq!(wrap(text, 19), wrapped);
        assert_eq!(wrap(text, 80), text);
    }

    #[test]
    fn pieces_fill_the_lines_and_leave_the_reserve() {
        let pieces: Vec<String> = (0..9).map(|k| format!(" piece{k}")).collect();
        let flowed = flow("first:", "    ", &pieces, (2, 30), 10);
        assert_eq!(flowed.lines, ["first: piece0 piece1 piece2", "    piece3 piece4"]);
        assert_eq!(flowed.used, 5);
        assert_eq!(flow("first:", "    ", &pieces[..2], (1, 20), 10).used, 2);
    }

    #[test]
    fn sections_keep_to_their_lines() {
        let items = |count: usize| (0..count).map(|k| k.to_string()).collect();
        let make = |counts: [usize; 3]| -> Vec<LayoutSection> {
            counts.into_iter().filter_map(|count| LayoutSection::new("Heading:", items(count))).collect()
        };
        for counts in [[1, 1, 1], [9, 0, 2], [5, 6, 100], [0, 0, 0], [4, 5, 6]] {
            let sections = make(counts);
            let (least, wanted) = section_needs(&sections);
            for most in least..=wanted + 3 {
                let found = section_lines(&sections, most);
                assert!(found.len() <= most && found.len() <= wanted, "{counts:?} {most}: {found:?}");
                assert_eq!(found.iter().filter(|line| line.starts_with("Heading:")).count(), sections.len());
            }
        }
        assert_eq!(section_lines(&make([0, 3, 0]), 9), ["Heading:", "  0", "  1", "  2"]);
        assert_eq!(
            section_lines(&make([0, 7, 0]), 3),
            ["Heading:", "  0", "  and 6 more (all of them: --format json)"]
        );
        assert_eq!(section_lines(&make([0, 7, 0]), 2), ["Heading: 7 (all of them: --format json)"]);
    }
}

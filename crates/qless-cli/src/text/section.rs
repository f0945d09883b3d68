//! A heading with items below it, in as many lines as are left.

/// Items shown at most; JSON has all of them.
const SHOWN: usize = 4;

/// What a report says beside the equations.
pub struct Section {
    heading: String,
    items: Vec<String>,
}

impl Section {
    /// Nothing where there are no items.
    pub fn new(heading: impl Into<String>, items: Vec<String>) -> Option<Self> {
        let heading = heading.into();
        (!items.is_empty()).then_some(Self { heading, items })
    }

    /// Lines that it would like to have.
    fn wanted(&self) -> usize {
        1 + self.items.len().min(SHOWN + 1)
    }

    /// At most so many lines, at least one.
    fn lines(&self, most: usize) -> Vec<String> {
        let all = self.items.len();
        if most <= 1 {
            return vec![format!("{} {all} (all of them: --format json)", self.heading)];
        }
        let room = most - 1;
        let shown = if all <= room && all <= SHOWN + 1 { all } else { (room - 1).min(SHOWN) };
        let mut lines = vec![self.heading.clone()];
        lines.extend(self.items.iter().take(shown).map(|item| format!("  {item}")));
        if shown < all {
            let more = if shown == 0 { "" } else { " more" };
            lines.push(format!("  and {}{more} (all of them: --format json)", all - shown));
        }
        lines
    }
}

/// Lines that the sections need at least, and those that they would like to have.
pub fn needs(sections: &[Section]) -> (usize, usize) {
    (sections.len(), sections.iter().map(Section::wanted).sum())
}

/// The sections in at most so many lines, if that is one for each; the first ones get more where they do not all fit.
pub fn lines(sections: &[Section], most: usize) -> Vec<String> {
    let mut spare = most.saturating_sub(sections.len());
    let mut lines = Vec::new();
    for section in sections {
        let more = spare.min(section.wanted() - 1);
        // A heading and how many there are tell as much as a heading and "and 7".
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
    fn sections_keep_to_their_lines() {
        let items = |count: usize| (0..count).map(|k| k.to_string()).collect();
        let make = |counts: [usize; 3]| -> Vec<Section> {
            counts.into_iter().filter_map(|count| Section::new("Heading:", items(count))).collect()
        };
        for counts in [[1, 1, 1], [9, 0, 2], [5, 6, 100], [0, 0, 0], [4, 5, 6]] {
            let sections = make(counts);
            let (least, wanted) = needs(&sections);
            for most in least..=wanted + 3 {
                let found = lines(&sections, most);
                assert!(found.len() <= most && found.len() <= wanted, "{counts:?} {most}: {found:?}");
                assert_eq!(found.iter().filter(|line| line.starts_with("Heading:")).count(), sections.len());
            }
        }
        assert_eq!(lines(&make([0, 3, 0]), 9), ["Heading:", "  0", "  1", "  2"]);
        assert_eq!(lines(&make([0, 7, 0]), 3), ["Heading:", "  0", "  and 6 more (all of them: --format json)"]);
        assert_eq!(lines(&make([0, 7, 0]), 2), ["Heading: 7 (all of them: --format json)"]);
    }
}

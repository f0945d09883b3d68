//! Preferences that the equations do not allow.

use qless::Report;

/// A line for each kind of preference with exceptions.
pub fn lines(report: &Report) -> Vec<String> {
    let unmet = &report.unmet_preferences;
    let said = [
        (
            &unmet.equations,
            "equation",
            "to keep is dependent on others to keep",
            "to keep are dependent on others to keep",
        ),
        (
            &unmet.masters,
            "column",
            "is a slave all the same: no choice avoids that",
            "are slaves all the same: no choice avoids that",
        ),
        (
            &unmet.slaves,
            "column",
            "is no slave: prescribed, in no equation, or with more growth only",
            "are no slaves: prescribed, in no equation, or with more growth only",
        ),
    ];
    let lines = said.iter().filter(|(numbers, ..)| !numbers.is_empty());
    lines.map(|(numbers, what, one, many)| line(numbers, what, if numbers.len() == 1 { one } else { many })).collect()
}

fn line(numbers: &[usize], what: &str, rest: &str) -> String {
    const SHOWN: usize = 5;
    let first: Vec<_> = numbers.iter().take(SHOWN).map(usize::to_string).collect();
    let more = numbers.len().saturating_sub(SHOWN);
    let and = if more > 0 { format!(" and {more} more") } else { String::new() };
    let plural = if numbers.len() == 1 { "" } else { "s" };
    format!("Not met: {what}{plural} {}{and} {rest}.", first.join(", "))
}

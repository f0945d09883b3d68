//! The first two lines: what was found, and in what.

use qless::Report;

use super::name::count;

/// `3 of 16 equations are redundant; 1 conflicts; the rest (12) are independent.`, and first of all what was left out.
pub fn line(report: &Report, is_deck: bool) -> String {
    let left_out = report.incomplete.len();
    if left_out == 0 {
        return of_equations(report, is_deck);
    }
    let constrain = if left_out == 1 { "thing that constrains was" } else { "things that constrain were" };
    let rest = if report.input.rows == 0 { "No equation was read.".to_owned() } else { of_equations(report, is_deck) };
    format!("INCOMPLETE: {left_out} {constrain} left out. {rest}")
}

fn of_equations(report: &Report, is_deck: bool) -> String {
    let (m, counts) = (report.input.rows, report.counts);
    match (m, m - counts.independent) {
        (0, _) if is_deck => return "The deck has no equations between DOFs, so there is nothing to find.".to_owned(),
        (0, _) => return "There are no equations, so there is nothing to find.".to_owned(),
        (1, 0) => return format!("The only equation is independent{}.", doubt(report)),
        (_, 0) => return format!("All {m} equations are independent{}.", doubt(report)),
        _ => {}
    }
    let of = format!(" of {}", count(m, "equation"));
    let redundant = some(counts.redundant, &of, "is redundant", "are redundant");
    let of = if counts.redundant == 0 { of.as_str() } else { "" };
    let conflicting = some(counts.conflicting, of, "conflicts", "conflict");
    let rest = match counts.independent {
        0 => Some("none is independent".to_owned()),
        1 => Some("the other one is independent".to_owned()),
        n => Some(format!("the rest ({n}) are independent")),
    };
    let parts: Vec<String> = [redundant, conflicting, rest].into_iter().flatten().collect();
    format!("{}{}.", parts.join("; "), doubt(report))
}

fn doubt(report: &Report) -> &'static str {
    if report.confidence.ambiguous { " (ambiguous, see below)" } else { "" }
}

fn some(n: usize, of: &str, one: &str, many: &str) -> Option<String> {
    let verb = if n == 1 { one } else { many };
    (n > 0).then(|| format!("{n}{of} {verb}"))
}

/// `Input: 16 equations with 32 coefficients on 28 DOFs, 2 prescribed.`, or that there are none
pub fn input(report: &Report) -> String {
    let input = report.input;
    if input.rows == 0 {
        return "Input: no equations.".to_owned();
    }
    let prescribed = match input.prescribed {
        0 => "none prescribed".to_owned(),
        n => format!("{n} prescribed"),
    };
    let (rows, coefficients) = (count(input.rows, "equation"), count(input.nnz, "coefficient"));
    format!("Input: {rows} with {coefficients} on {}, {prescribed}.", count(input.dofs, "DOF"))
}

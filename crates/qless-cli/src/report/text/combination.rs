//! Explanations as text: `row 14 = 1 * row 3 - 2 * row 9 + 1 * [4:1 = 0.5, line 17 *BOUNDARY]`.

use qless::ConstraintSystem;
use qless::explanation::Member;

use super::COLUMNS;
use crate::wording;
use crate::wording::layout::flow;
use crate::wording::{EquationFacts, EquationLookup};
use crate::wording::{label, number};

/// Columns reserved for `+ ... and 1000000 more`.
const TAIL: usize = 26;

/// The equation and its explanation in at most `most` lines.
pub fn lines(
    (equations, system): (&dyn EquationLookup, Option<&ConstraintSystem>),
    row: usize,
    members: &[Member],
    most: usize,
) -> Vec<String> {
    let head = format!("  {}", wording::equation(equations, row));
    if !members.iter().any(|member| matches!(member, Member::Equation { .. })) {
        let alone = CombinationAlone::classify(equations, row);
        if alone != CombinationAlone::No {
            return vec![format!("{head} {}", alone.one())];
        }
    }
    let piece = |(k, member): (usize, &Member)| piece((equations, system), *member, k == 0);
    let fill = |members: &[Member]| {
        // No line holds more than ten members, so that further ones are not needed.
        let pieces: Vec<String> = members.iter().take(10 * most).enumerate().map(piece).collect();
        flow(&head, "      ", &pieces, (most, COLUMNS), TAIL)
    };
    let flowed = fill(members);
    if flowed.used == members.len() {
        return flowed.lines;
    }
    // If not all members fit, prescribed values come first, then the largest equations.
    let flowed = fill(&largest(equations, members));
    let more = members.len() - flowed.used;
    flowed.finish(&format!(" + ... and {more} more"))
}

/// Prescribed values, equations with a right-hand side, then the others; each kind in descending order of size.
fn largest(equations: &dyn EquationLookup, members: &[Member]) -> Vec<Member> {
    let key = |member: &Member| match *member {
        Member::Equation { row, coefficient } => {
            let facts = equations.facts(row);
            (if facts.rhs == 0.0 { 2 } else { 1 }, coefficient.abs() * facts.largest)
        }
        _ => (0, member.coefficient().abs()),
    };
    let mut keyed: Vec<_> = members.iter().map(|member| (key(member), *member)).collect();
    keyed.sort_by(|a, b| a.0.0.cmp(&b.0.0).then(b.0.1.total_cmp(&a.0.1)));
    keyed.into_iter().map(|(_, member)| member).collect()
}

/// A member with its sign and coefficient: ` + 2 * row 3 "tie A/B"`.
fn piece(lookup: (&dyn EquationLookup, Option<&ConstraintSystem>), member: Member, is_first: bool) -> String {
    let name = name(lookup, member);
    let coefficient = member.coefficient();
    let sign = match (is_first, coefficient < 0.0) {
        (true, _) => return format!(" = {} * {name}", number(coefficient)),
        (false, true) => "-",
        (false, false) => "+",
    };
    format!(" {sign} {} * {name}", number(coefficient.abs()))
}

/// The name of a member: `row 3 "tie A/B"`, or `[4:1 = 0.5, line 17 *BOUNDARY]`.
pub fn name((equations, system): (&dyn EquationLookup, Option<&ConstraintSystem>), member: Member) -> String {
    match (member, system) {
        (Member::Equation { row, .. }, _) => wording::equation(equations, row),
        (Member::Prescribed { dof, value, .. }, Some(system)) => {
            let place = system.prescribed_place(dof).map_or_else(String::new, |place| format!(", {}", label(place)));
            format!("[{} = {}{place}]", label(&system.dof_label(dof)), number(value))
        }
        (Member::Prescribed { dof, value, .. }, None) => format!("[DOF {} = {}]", dof + 1, number(value)),
        _ => String::new(),
    }
}

/// Whether an equation is dependent without any other equation, and why.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum CombinationAlone {
    /// The equation has no coefficients.
    Empty,
    /// All DOFs of the equation are prescribed.
    Prescribed,
    /// The equation has free DOFs, and depends on other equations.
    No,
}

impl CombinationAlone {
    pub fn classify(equations: &dyn EquationLookup, row: usize) -> Self {
        let EquationFacts { dofs, prescribed, .. } = equations.facts(row);
        match dofs {
            0 => Self::Empty,
            _ if dofs == prescribed => Self::Prescribed,
            _ => Self::No,
        }
    }

    /// The predicate of a sentence about one equation that is dependent alone.
    pub fn one(self) -> &'static str {
        if self == Self::Empty { "has no coefficients" } else { "has no free DOF: all are prescribed" }
    }

    /// The name for several equations that are dependent alone.
    pub fn several(self) -> &'static str {
        if self == Self::Empty { "rows without coefficients" } else { "rows whose DOFs are all prescribed" }
    }
}

//! The text of equations and of comments on those that are gone.

use crate::deck::ansys::syntax::label;
use crate::deck::clean::{Plan, Reason, Removed, Written};
use crate::deck::{Dof, Model};

/// Equations of a certificate that a comment names at most.
const NAMED: usize = 8;

/// Why an equation is gone, in a line.
pub fn comment(model: &Model, removed: &Removed) -> String {
    let name = |i: usize| model.cards.nth(model.nth(i).origin.card).name;
    let what = format!("! qless: {}", name(removed.equation));
    match &removed.reason {
        Reason::Redundant(because) if because.is_empty() => format!("{what} removed: all of its DOFs are prescribed\n"),
        Reason::Redundant(because) => {
            let terms: Vec<String> = because.iter().take(NAMED).map(|&(i, c)| format!("{c:?} * {}", name(i))).collect();
            let more = because.len().saturating_sub(NAMED);
            let more = if more > 0 { format!(" + {more} more") } else { String::new() };
            format!("{what} removed, redundant: it is {}{more}\n", terms.join(" + "))
        }
        Reason::Fault(fault) => format!("{what} written anew below: {}\n", fault.describe(model)),
        Reason::Connected => format!("{what} written anew below: it shares DOFs with others that are\n"),
    }
}

/// The new equations, numbered from `highest + 1` on, with the tag of an archive or as commands; `None` if there are no numbers
/// left.
pub fn equations(plan: &Plan, highest: u32, archive: Option<&str>) -> Option<String> {
    if plan.written.is_empty() {
        return Some(String::new());
    }
    let mut text =
        String::from("! qless: independent equations; each slave, the first term, occurs once and is not prescribed\n");
    let mut number = highest;
    for written in &plan.written {
        number = number.checked_add(1)?;
        text.push_str(&match archive {
            Some(tag) => in_archive(written, number, tag),
            None => as_command(written, number),
        });
    }
    Some(text)
}

fn in_archive(written: &Written, number: u32, tag: &str) -> String {
    let terms = terms(written);
    let term = |(dof, value): &(Dof, f64)| format!(",{:>10},{:<4},{value:?}", dof.node, label::name(dof.component));
    let line = |terms: &[(Dof, f64)]| format!("CE,{tag},NODE{}\n", terms.iter().map(term).collect::<String>());
    let head = format!("CE,{tag},DEFI,{:>8},{number:>8},{:?}\n", terms.len(), written.rhs + 0.0);
    std::iter::once(head).chain(terms.chunks(2).map(line)).collect()
}

fn as_command(written: &Written, number: u32) -> String {
    let term = |(dof, value): &(Dof, f64)| format!(",{},{},{value:?}", dof.node, label::name(dof.component));
    let rhs = written.rhs + 0.0;
    let line = |terms: &[(Dof, f64)]| format!("CE,{number},{rhs:?}{}\n", terms.iter().map(term).collect::<String>());
    terms(written).chunks(3).map(line).collect()
}

/// The terms with the slave first.
fn terms(written: &Written) -> Vec<(Dof, f64)> {
    std::iter::once((written.slave, 1.0)).chain(written.terms.iter().copied()).collect()
}

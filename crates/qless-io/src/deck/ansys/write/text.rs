//! The text of equations and of comments on those that are gone.

use crate::deck::ansys::commands::equations::Region;
use crate::deck::ansys::reader::Owner;
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

/// How new equations are numbered, so that no number is taken.
#[derive(Clone, Copy, Debug)]
pub enum Numbering {
    /// From one above the highest on, in the form of an archive with its tag.
    Archive(u32, &'static str),
    /// The same as commands.
    From(u32),
    /// By the program, since nobody else knows which are taken.
    Next,
}

/// The new equations; `None` if there are no numbers left.
pub fn equations(plan: &Plan, numbering: Numbering) -> Option<String> {
    if plan.written.is_empty() {
        return Some(String::new());
    }
    let mut text =
        String::from("! qless: independent equations; each slave, the first term, occurs once and is not prescribed\n");
    for (written, k) in plan.written.iter().zip(1..) {
        text.push_str(&match numbering {
            Numbering::Archive(highest, tag) => in_archive(written, highest.checked_add(k)?, tag),
            Numbering::From(highest) => {
                let number = highest.checked_add(k)?.to_string();
                as_commands(written, &number, &number)
            }
            Numbering::Next => as_commands(written, "NEXT", "HIGH"),
        });
    }
    Some(text)
}

/// The command that deletes equations or a set.
pub fn deletion(owner: &Owner, regions: &[Region]) -> String {
    match *owner {
        Owner::Equation(number) => format!("CEDELE,{number}\n"),
        Owner::Coupled(number) => format!("CPDELE,{number}\n"),
        Owner::Region(at) => format!("CEDELE,{},{}\n", regions[at].first, regions[at].last),
        Owner::Other => String::new(),
    }
}

fn in_archive(written: &Written, number: u32, tag: &str) -> String {
    let terms = terms(written);
    let term = |(dof, value): &(Dof, f64)| format!(",{:>10},{:<4},{value:?}", dof.node, label::name(dof.component));
    let line = |terms: &[(Dof, f64)]| format!("CE,{tag},NODE{}\n", terms.iter().map(term).collect::<String>());
    let head = format!("CE,{tag},DEFI,{:>8},{number:>8},{:?}\n", terms.len(), written.rhs + 0.0);
    std::iter::once(head).chain(terms.chunks(2).map(line)).collect()
}

/// Commands of three terms each, the first of which has another word for the number.
fn as_commands(written: &Written, first: &str, others: &str) -> String {
    let term = |(dof, value): &(Dof, f64)| format!(",{},{},{value:?}", dof.node, label::name(dof.component));
    let rhs = written.rhs + 0.0;
    let line = |(k, terms): (usize, &[(Dof, f64)])| {
        let number = if k == 0 { first } else { others };
        format!("CE,{number},{rhs:?}{}\n", terms.iter().map(term).collect::<String>())
    };
    terms(written).chunks(3).enumerate().map(line).collect()
}

/// The terms with the slave first.
fn terms(written: &Written) -> Vec<(Dof, f64)> {
    std::iter::once((written.slave, 1.0)).chain(written.terms.iter().copied()).collect()
}

//! Reads `*EQUATION`: a line with the number of terms, then `node, component, coefficient` for each term, several to a line.

use std::rc::Rc;

use crate::deck::calculix::cards::boundary::range;
use crate::deck::calculix::cards::or_line_left_out;
use crate::deck::calculix::model::DeckDefinitions;
use crate::deck::calculix::syntax::{
    DataFields, DataLine, DataLines, FieldFault, KeywordCard, Scope, component, float, number,
};
use crate::deck::{DeckError, Dof, Model, Origin, Problem};
use crate::fault::quote;

/// Largest number of terms of an equation.
const TERMS: u32 = 50_000_000;

/// The nodes of a term: one node, or a set. With sets, the card gives one equation for each of their members.
enum TermNodes {
    One(u32),
    Set(Rc<Vec<u32>>),
}

struct EquationTerm {
    nodes: TermNodes,
    component: u8,
    coefficient: f64,
}

impl EquationTerm {
    /// The DOFs of the term, one for each node.
    fn dofs(&self) -> Vec<Dof> {
        let nodes = match &self.nodes {
            TermNodes::One(node) => std::slice::from_ref(node),
            TermNodes::Set(set) => set.as_slice(),
        };
        nodes.iter().map(|&node| Dof { node, component: self.component }).collect()
    }
}

/// Adds the equations of an `*EQUATION` card. An equation that needs what this reader does not follow is left out.
pub fn read(card: &KeywordCard, model: &mut Model, definitions: &DeckDefinitions) -> Result<(), DeckError> {
    let mut lines = card.lines();
    let mut terms: Vec<EquationTerm> = Vec::new();
    while let Some(head) = lines.next() {
        let origin = Origin { card: number_for(head.file, head.number, model), line: head.number, lines: 1 };
        let Some(promised) = promised(&head, origin, model)? else { return Ok(()) };
        terms.clear();
        let gathered = gather(&mut lines, (&head, origin), promised, (card.scope, definitions), &mut terms, model)?;
        let origin = Origin { lines: gathered.lines, ..origin };
        if gathered.is_left_out {
            // Other equations must not have its DOFs as slaves.
            model.claim_left_out(terms.iter().flat_map(EquationTerm::dofs), origin);
        } else {
            push(&terms, origin, model).map_err(|problem| model.error(Origin { lines: 1, ..origin }, None, problem))?;
        }
    }
    Ok(())
}

/// The number of terms that the first line of an equation promises. If this reader does not know it, leaves out the rest of the card and
/// returns `None`.
fn promised(head: &DataLine, origin: Origin, model: &mut Model) -> Result<Option<usize>, DeckError> {
    match count(head) {
        Err((_, problem @ Problem::NotFollowed { .. })) => {
            let text = format!("*EQUATION constrains, but {problem}: left out, with the rest of the card");
            model.leave_out(head.file, head.number, text);
            Ok(None)
        }
        other => other.map(Some).map_err(|(field, problem)| model.error(origin, field, problem)),
    }
}

/// What the lines of an equation gave beside its terms: their number in the file of the first one, and whether a line was left out.
struct GatheredLines {
    lines: u32,
    is_left_out: bool,
}

/// Reads the lines of an equation until it has all promised terms. Terms of a line that is left out count, and are not in `terms`.
fn gather(
    lines: &mut DataLines,
    (head, origin): (&DataLine, Origin),
    promised: usize,
    names: (Scope, &DeckDefinitions),
    terms: &mut Vec<EquationTerm>,
    model: &mut Model,
) -> Result<GatheredLines, DeckError> {
    let (mut found, mut gathered) = (0, GatheredLines { lines: 1, is_left_out: false });
    while found < promised {
        let Some(line) = lines.next() else {
            return Err(model.error(origin, None, Problem::TooFew { what: "terms", promised, found }));
        };
        let known = terms.len();
        let added = add_terms(&line, promised - found, names, terms).map(|()| Some(terms.len() - known));
        let at = Origin { line: line.number, ..origin };
        let added = added.map_err(|(field, problem)| model.error(at, field, problem));
        let added = or_line_left_out(added, line.file, model)?;
        gathered.is_left_out |= added.is_none();
        found += added.unwrap_or_else(|| line.fields().count().div_ceil(3));
        // The lines of an equation that continues in another file are counted in the first file only.
        if line.file == head.file {
            gathered.lines = (line.number + 1).saturating_sub(head.number);
        }
    }
    Ok(gathered)
}

/// The number of the card for the equations of this line. Consecutive `*EQUATION` cards of a file share one number, to save memory.
fn number_for(file: u32, line: u32, model: &mut Model) -> u32 {
    match model.cards.last() {
        Some(last) if last.name == "*EQUATION" && last.file == file => model.cards.len() as u32 - 1,
        _ => model.card("*EQUATION", file, line),
    }
}

fn count(head: &DataLine) -> Result<usize, FieldFault> {
    const EXPECTED: &str = "the number of terms of an equation, at least 1";
    let mut fields = head.fields();
    let field = fields.next().unwrap_or_default();
    let terms = number(field, EXPECTED).map_err(|problem| (Some(1), problem))?;
    if terms == 0 || fields.any(|field| !field.is_empty()) {
        return Err((Some(1), Problem::Expected { expected: EXPECTED, found: quote(head.text.trim_ascii()) }));
    }
    if terms > TERMS {
        let limit = TERMS as usize;
        return Err((Some(1), Problem::Limit { what: "the number of terms", limit, advice: "correct it" }));
    }
    Ok(terms as usize)
}

/// Reads the terms on a line. An error if there are more than `most`.
fn add_terms(
    line: &DataLine,
    most: usize,
    names: (Scope, &DeckDefinitions),
    terms: &mut Vec<EquationTerm>,
) -> Result<(), FieldFault> {
    let mut fields = line.fields().enumerate().map(|(k, field)| (k + 1, field));
    let most = terms.len() + most;
    while let Some((at, field)) = fields.next() {
        if terms.len() == most {
            let expected = "no more terms than promised";
            return Err((Some(at), Problem::Expected { expected, found: quote(field) }));
        }
        let nodes = nodes(field, names).map_err(|problem| (Some(at), problem))?;
        let (at, field) = fields.next().unwrap_or((at + 1, b""));
        let dof = number(field, "a degree of freedom").map_err(|problem| (Some(at), problem))?;
        let component = component(dof, at)?;
        let (at, field) = fields.next().unwrap_or((at + 1, b""));
        let coefficient = if field.is_empty() { Ok(0.0) } else { float(field) };
        terms.push(EquationTerm { nodes, component, coefficient: coefficient.map_err(|problem| (Some(at), problem))? });
    }
    Ok(())
}

fn nodes(field: &[u8], (scope, definitions): (Scope, &DeckDefinitions)) -> Result<TermNodes, Problem> {
    match definitions.by_number(scope, field) {
        Some(node) => node.map(TermNodes::One),
        None if field.is_empty() || field[0].is_ascii_digit() => {
            number(field, "a node or a node set").map(TermNodes::One)
        }
        None => definitions.nodes(scope, &String::from_utf8_lossy(field)).map(TermNodes::Set),
    }
}

/// Adds one equation. If terms name sets, which must have the same size, adds one equation for each of their members.
fn push(terms: &[EquationTerm], origin: Origin, model: &mut Model) -> Result<(), Problem> {
    let mut sizes =
        terms.iter().filter_map(|term| if let TermNodes::Set(set) = &term.nodes { Some(set.len()) } else { None });
    let size = sizes.next().unwrap_or(1);
    if let Some(other) = sizes.find(|&other| other != size) {
        let found = quote(format!("sets of {size} and {other} nodes").as_bytes());
        return Err(Problem::Expected { expected: "node sets of the same size in one equation", found });
    }
    for k in 0..size {
        let term = |term: &EquationTerm| {
            let node = match &term.nodes {
                TermNodes::One(node) => *node,
                TermNodes::Set(set) => set[k],
            };
            (Dof { node, component: term.component }, term.coefficient)
        };
        model.push(terms.iter().map(term), 0.0, origin);
    }
    Ok(())
}

/// Reads `*EQUATION, REMOVE`. Returns the equations whose slaves the card lists as `node or set, first, last`; with `REMOVE ALL`, all
/// equations.
pub fn removed(card: &KeywordCard, model: &mut Model, definitions: &DeckDefinitions) -> Result<Vec<u32>, DeckError> {
    let all = 0..model.equations() as u32;
    if card.parameter("REMOVEALL").is_some() {
        return Ok(all.collect());
    }
    let origin = Origin { card: number_for(card.file, card.line, model), line: card.line, lines: 1 };
    let mut slaves = rustc_hash::FxHashSet::default();
    for line in card.lines() {
        let fail = |(field, problem): FieldFault| model.error(Origin { line: line.number, ..origin }, field, problem);
        for dof in range(card.scope, &mut DataFields::new(&line), definitions).map_err(fail)? {
            slaves.insert(dof);
        }
    }
    let slave = |i: u32| model.nth(i as usize).columns.first().map(|&j| model.dofs[j as usize]);
    Ok(all.filter(|&i| slave(i).is_some_and(|dof| slaves.contains(&dof))).collect())
}

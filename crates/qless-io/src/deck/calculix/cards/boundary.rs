//! Reads `*BOUNDARY`, with lines `node or set, first component, last component, value` or with a named support, and `*CLOAD`, with lines
//! `node or set, component, value`.

use crate::deck::calculix::cards::or_line_left_out;
use crate::deck::calculix::model::{DeckDefinitions, folded};
use crate::deck::calculix::syntax::parameters::undefined;
use crate::deck::calculix::syntax::{DataFields, FieldFault, KeywordCard, Scope, component, number};
use crate::deck::{DeckError, Dof, Load, Model, Origin, Prescribed, Problem};
use crate::fault::quote;

/// Names of supports, and the components that each of them fixes.
const SUPPORTS: [(&str, &[u8]); 8] = [
    ("ENCASTRE", &[1, 2, 3, 4, 5, 6]),
    ("PINNED", &[1, 2, 3]),
    ("XSYMM", &[1, 5, 6]),
    ("YSYMM", &[2, 4, 6]),
    ("ZSYMM", &[3, 4, 5]),
    ("XASYMM", &[2, 3, 4]),
    ("YASYMM", &[1, 3, 5]),
    ("ZASYMM", &[1, 2, 6]),
];

/// Reads the prescribed values of a `*BOUNDARY` card, in the order of its lines. A `rate` is a velocity or an acceleration: such a value is
/// one of a time history of its own.
pub fn read(
    card: &KeywordCard,
    model: &mut Model,
    definitions: &DeckDefinitions,
    rate: Option<&str>,
) -> Result<Vec<Prescribed>, DeckError> {
    let number = model.card("*BOUNDARY", card.file, card.line);
    let history = history(card, model, definitions, rate)
        .map_err(|problem| model.error(Origin { card: number, line: card.line, lines: 1 }, None, problem))?;
    let mut prescribed = Vec::new();
    for line in card.lines() {
        let origin = Origin { card: number, line: line.number, lines: 1 };
        let mut fields = DataFields::new(&line);
        let fail = |(field, problem): FieldFault| model.error(origin, field, problem);
        let dofs = range(card.scope, &mut fields, definitions).map_err(fail);
        let value = fields.real().map(|value| Some(value.unwrap_or(0.0))).map_err(fail);
        let dofs = or_line_left_out(dofs, line.file, model)?;
        let Some(value) = or_line_left_out(value, line.file, model)? else {
            model.claim_left_out(dofs, origin);
            continue;
        };
        // A value of zero is the same in every time history.
        let history = if value == 0.0 { 0 } else { history };
        prescribed.extend(dofs.into_iter().map(|dof| Prescribed { dof, value, history, origin }));
    }
    Ok(prescribed)
}

/// The time history of a card's values. It is 0, the default of the step, or a named amplitude, possibly delayed, or that of a rate.
fn history(
    card: &KeywordCard,
    model: &mut Model,
    definitions: &DeckDefinitions,
    rate: Option<&str>,
) -> Result<u32, Problem> {
    let mut words: Vec<String> = rate.map(str::to_owned).into_iter().collect();
    if let Some(amplitude) = card.word("AMPLITUDE") {
        if !definitions.amplitudes.contains(&amplitude) {
            return Err(undefined("amplitude", amplitude));
        }
        words.push(amplitude);
        words.extend(card.parameter("TIMEDELAY").map(|delay| format!("{delay} later")));
    }
    Ok(if words.is_empty() { 0 } else { model.history(&words.join(" ")) })
}

/// Reads the DOFs that a `*CLOAD` card loads.
pub fn loads(card: &KeywordCard, model: &mut Model, definitions: &DeckDefinitions) -> Result<Vec<Load>, DeckError> {
    let number = model.card("*CLOAD", card.file, card.line);
    let mut loads = Vec::new();
    for line in card.lines() {
        let origin = Origin { card: number, line: line.number, lines: 1 };
        let mut fields = DataFields::new(&line);
        let fail = |(field, problem): FieldFault| model.error(origin, field, problem);
        let nodes = nodes(card.scope, &mut fields, definitions).map_err(fail)?;
        let Some(dof) = fields.whole("a degree of freedom").map_err(fail)? else { continue };
        let component = component(dof, 2).map_err(fail)?;
        loads.extend(nodes.into_iter().map(|node| Load { dof: Dof { node, component }, origin }));
    }
    Ok(loads)
}

/// Reads the DOFs in `node or set, first, last`, where `last` defaults to `first`, or in `node or set, support`.
pub fn range(scope: Scope, fields: &mut DataFields, definitions: &DeckDefinitions) -> Result<Vec<Dof>, FieldFault> {
    let nodes = nodes(scope, fields, definitions)?;
    let components = components(fields)?;
    let dofs = |node| components.iter().map(move |&component| Dof { node, component });
    Ok(nodes.into_iter().flat_map(dofs).collect())
}

fn nodes(scope: Scope, fields: &mut DataFields, definitions: &DeckDefinitions) -> Result<Vec<u32>, FieldFault> {
    let field = fields.next().unwrap_or_default();
    if field.is_empty() {
        let problem = Problem::Expected { expected: "a node or a node set", found: quote(field) };
        return Err((Some(fields.number), problem));
    }
    definitions.node_or_set(scope, field).map_err(|problem| (Some(fields.number), problem))
}

fn components(fields: &mut DataFields) -> Result<Vec<u8>, FieldFault> {
    const EXPECTED: &str = "a degree of freedom or a support such as ENCASTRE";
    let field = fields.next().unwrap_or_default();
    let word = folded(field);
    if let Some((_, held)) = SUPPORTS.iter().find(|(support, _)| *support == word) {
        return Ok(held.to_vec());
    }
    let first = number(field, EXPECTED).map_err(|problem| (Some(fields.number), problem))?;
    let first = component(first, fields.number)?;
    let last = match fields.whole("the last degree of freedom")? {
        Some(last) => component(last, fields.number)?,
        None => first,
    };
    Ok((first..=last.max(first)).collect())
}

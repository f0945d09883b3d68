//! Writes new equations, and the cards of steps that remove equations.

use rustc_hash::FxHashSet;

use super::new_nodes::{NewNodes, RotationNodes};
use crate::deck::calculix::syntax::walk::{keyword_end, next_keyword};
use crate::deck::plan::{Cases, CleanError, Plan, Written};
use crate::deck::{Deck, Dof, Model};

/// Largest number of characters of a number that CalculiX reads.
const NUMBER: usize = 20;

/// The text of the new equations, with the new nodes that they need.
pub fn new_text(deck: &Deck, plan: &Plan, new: &NewNodes) -> Result<Vec<u8>, CleanError> {
    if plan.written.is_empty() {
        return Ok(Vec::new());
    }
    if plan.written.iter().any(|written| written.rhs != 0.0) {
        let why = "an equation has a right-hand side, which *EQUATION cannot have; change it by hand";
        return Err(CleanError::Place { path: deck.model.files[0].clone(), line: 1, why });
    }
    let nodes = new.nodes(deck);
    let head =
        "** qless: independent equations; each slave, the first DOF, occurs once and is not prescribed\n*EQUATION\n";
    let mut text = nodes + head;
    let stood_for: Vec<Written> = new.proxies.equations().collect();
    plan.written.iter().chain(&stood_for).for_each(|written| add_equation(&mut text, written, &deck.model, new));
    Ok(text.into_bytes())
}

fn add_equation(text: &mut String, written: &Written, model: &Model, new: &NewNodes) {
    let others = new.proxies.in_place_of(model, written);
    let term = |dof: Dof, v: f64| {
        let Dof { node, component } = new.rotations.name(*others.get(&dof).unwrap_or(&dof));
        format!("{},{component},{}", model.node_name(node), number(v))
    };
    let first = std::iter::once(term(written.slave, 1.0));
    let terms: Vec<String> = first.chain(written.terms.iter().map(|&(dof, v)| term(dof, v))).collect();
    text.push_str(&terms.len().to_string());
    text.push('\n');
    for line in terms.chunks(4) {
        *text += &line.join(",");
        text.push('\n');
    }
}

/// Writes the number with all its digits, or with as many as CalculiX reads.
fn number(value: f64) -> String {
    let shortest = [format!("{value:?}"), format!("{value:e}")];
    if let Some(text) = shortest.into_iter().filter(|text| text.len() <= NUMBER).min_by_key(String::len) {
        return if text.contains(['.', 'e']) { text } else { text + "." };
    }
    (0..=NUMBER)
        .rev()
        .flat_map(|digits| [format!("{value:.digits$}"), format!("{value:.digits$e}")])
        .filter(|text| text.len() <= NUMBER)
        .min_by(|a, b| error(a, value).total_cmp(&error(b, value)))
        .unwrap_or_else(|| format!("{value:e}"))
}

fn error(text: &str, value: f64) -> f64 {
    text.parse::<f64>().map_or(f64::INFINITY, |read| (read - value).abs())
}

/// For each step, the card that removes the equations which end before it. `None` if the deck's own removal cards stay valid. CalculiX
/// accepts one `*EQUATION, REMOVE` in each step, with any number of lines.
pub fn ends(deck: &Deck, plan: &Plan, rotations: &RotationNodes) -> Option<Vec<String>> {
    let cases = &deck.model.cases;
    let ends_sooner = !plan.ended.is_empty() || plan.written.iter().any(|written| written.cases != Cases::All);
    // A removal card of the deck names slaves. It may remove a new equation that has one of them as its slave.
    let may_meet_new = !plan.written.is_empty() && deck.texts.iter().any(|text| removes(text));
    if !ends_sooner && !may_meet_new && cases.iter().all(|case| case.removed.is_empty()) {
        return None;
    }
    let mut slaves: Vec<Vec<Dof>> = vec![Vec::new(); cases.len()];
    for written in &plan.written {
        (1..cases.len()).filter(|&k| written.cases == Cases::UpTo(k - 1)).for_each(|k| slaves[k].push(written.slave));
    }
    let slave = |i: usize| deck.model.nth(i).columns.first().map(|&j| deck.model.dofs[j as usize]);
    plan.ended.iter().for_each(|ended| slaves[ended.last + 1].extend(slave(ended.equation)));
    let mut done: FxHashSet<usize> = plan.removed.iter().map(|removed| removed.equation).collect();
    done.extend(plan.ended.iter().map(|ended| ended.equation));
    for (k, case) in cases.iter().enumerate() {
        let own = case.removed.iter().map(|&i| i as usize);
        own.filter(|&i| done.insert(i)).for_each(|i| slaves[k].extend(slave(i)));
    }
    let card = |slaves: Vec<Dof>| removal_card(slaves.into_iter().map(|dof| rotations.name(dof)));
    Some(slaves.into_iter().map(card).collect())
}

/// Whether a file has an `*EQUATION` card with `REMOVE` or `REMOVE ALL`.
fn removes(text: &[u8]) -> bool {
    let mut at = next_keyword(text, 0);
    while at < text.len() {
        let end = keyword_end(text, at).0;
        if is_removal(&text[at..end]) {
            return true;
        }
        at = next_keyword(text, end);
    }
    false
}

/// Whether a keyword line is `*EQUATION` with `REMOVE` or `REMOVE ALL` among its parameters.
pub fn is_removal(keyword: &[u8]) -> bool {
    let word: Vec<u8> = keyword.iter().filter(|b| !b.is_ascii_whitespace()).map(u8::to_ascii_uppercase).collect();
    let mut words = word.split(|&b| b == b',');
    words.next() == Some(b"*EQUATION") && words.any(|word| word.starts_with(b"REMOVE"))
}

fn removal_card(slaves: impl Iterator<Item = Dof>) -> String {
    let line = |Dof { node, component }: Dof| format!("{node},{component},{component}\n");
    let lines = slaves.fold(String::new(), |lines, dof| lines + &line(dof));
    if lines.is_empty() { lines } else { "*EQUATION, REMOVE\n".to_owned() + &lines }
}

#[cfg(test)]
mod tests {
    use super::number;

    #[test]
    fn numbers_are_short_enough_to_be_read_whole() {
        for (value, text) in [(1.0, "1.0"), (-1.0, "-1.0"), (1e-30, "1e-30"), (-1.0 / 3.0, "-0.3333333333333333")] {
            assert_eq!(number(value), text);
        }
        for value in [-1.234_567_890_123_456_7e-105, -12_345.678_901_234_567, std::f64::consts::PI * 1e-7] {
            let text = number(value);
            assert!(
                text.len() <= 20 && ((text.parse::<f64>().expect("a number") - value) / value).abs() < 1e-12,
                "{text}"
            );
        }
    }
}

//! Writes a `*TIE` or `*RIGID BODY` without some of its slave nodes: the card names a new set of the nodes that are left.

use crate::deck::Deck;
use crate::deck::calculix::syntax::fold_name;
use crate::deck::calculix::syntax::walk::keyword_end;

/// Number of nodes on a line of `*NSET`.
const NODES: usize = 8;

/// The text of a card with only the slave nodes in `left`. `None` if the slave surface or set is not found in the card. `number` is part of
/// the name of the new set.
pub fn with_nodes(deck: &Deck, card: &str, left: &[u32], number: usize) -> Option<String> {
    let name = new_name(deck, number);
    let (keyword, data) = card.split_at(keyword_end(card.as_bytes(), 0).0);
    let is_tie = fold_name(keyword).starts_with("*TIE");
    let nodes: String = left.chunks(NODES).map(|line| names(deck, line).join(",") + "\n").collect();
    let set = format!("*NSET, NSET={name}\n{nodes}");
    Some(if is_tie {
        let (before, slave) = slave_of(data)?;
        let rest = &data[before.len() + slave.len()..];
        format!("{set}*SURFACE, NAME={name}, TYPE=NODE\n{name}\n{keyword}{before}{name}{rest}")
    } else {
        format!("{set}{}{data}", with_set(keyword, &name)?)
    })
}

/// A name that occurs nowhere in the deck, neither in capitals nor in small letters: CalculiX does not tell them apart.
fn new_name(deck: &Deck, number: usize) -> String {
    let occurs = |text: &[u8], name: &[u8]| text.windows(name.len()).any(|part| part.eq_ignore_ascii_case(name));
    let is_known = |name: &String| deck.texts.iter().any(|text| occurs(text, name.as_bytes()));
    let mut stems = (0..).map(|k: u32| "QLESS".to_owned() + &"X".repeat(k as usize));
    stems.find(|stem| !is_known(stem)).unwrap_or_default() + &number.to_string()
}

fn names(deck: &Deck, nodes: &[u32]) -> Vec<String> {
    nodes.iter().map(|&node| deck.model.node_name(node)).collect()
}

/// The text before the name of the slave surface, and the name itself: the first field of the first data line.
fn slave_of(data: &str) -> Option<(&str, &str)> {
    let mut at = 0;
    for line in data.split_inclusive('\n') {
        if !line.starts_with("**") && !line.trim().is_empty() {
            return Some((&data[..at], &line[..line.find(',')?]));
        }
        at += line.len();
    }
    None
}

/// The keyword line with `name` as the value of its parameter NSET.
fn with_set(keyword: &str, name: &str) -> Option<String> {
    let mut parts: Vec<String> = keyword.split(',').map(str::to_owned).collect();
    let part = parts.iter_mut().find(|part| part.split_once('=').is_some_and(|(key, _)| fold_name(key) == "NSET"))?;
    let end = part.trim_end().len();
    let value = part.find('=')? + 1;
    part.replace_range(value..end, name);
    Some(parts.join(","))
}

//! Connected parts: equations that share a free DOF or the text that they are written in.

use rustc_hash::FxHashMap;

use crate::deck::{Model, Origin};

/// For each equation the number of its part, from 0 in the order of the first equation of each.
pub fn parts(model: &Model, is_prescribed: impl Fn(u32) -> bool) -> Vec<usize> {
    let mut sets = Sets::new(model.equations());
    let mut by_column: FxHashMap<u32, usize> = FxHashMap::default();
    let mut by_text: FxHashMap<(u32, u32), usize> = FxHashMap::default();
    for i in 0..model.equations() {
        let equation = model.nth(i);
        let free =
            equation.columns.iter().zip(equation.coefficients).filter(|(j, a)| **a != 0.0 && !is_prescribed(**j));
        free.for_each(|(&j, _)| sets.join(*by_column.entry(j).or_insert(i), i));
        sets.join(*by_text.entry(text_of(model, equation.origin)).or_insert(i), i);
    }
    let mut numbers: FxHashMap<usize, usize> = FxHashMap::default();
    (0..model.equations())
        .map(|i| {
            let next = numbers.len();
            *numbers.entry(sets.root(i)).or_insert(next)
        })
        .collect()
}

/// Equations with the same key are written in the same lines. A card of a part is read once for each of its instances.
pub fn text_of(model: &Model, origin: Origin) -> (u32, u32) {
    let card = if model.has_instances() { model.cards.nth(origin.card).file } else { origin.card };
    (card, origin.line)
}

/// Disjoint sets; the root of a set is its smallest member.
struct Sets(Vec<usize>);

impl Sets {
    fn new(count: usize) -> Self {
        Self((0..count).collect())
    }

    fn root(&mut self, mut i: usize) -> usize {
        while self.0[i] != i {
            self.0[i] = self.0[self.0[i]];
            i = self.0[i];
        }
        i
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        self.0[a.max(b)] = a.min(b);
    }
}

//! Which parts make the model fail: it says no more than that it does, so that parts are tried without the others, by halves.

use std::error::Error;

use super::super::{Failure, Model};
use super::Corrector;

type Refusal = Box<dyn Error + Send + Sync>;

impl<M: Model> Corrector<'_, M> {
    /// The parts at which the model fails alone, the others being where they were before; its refusal again if that is none of them.
    ///
    /// One evaluation for each halving on the way to each of them, and none where only one part moves.
    pub(super) fn blame(
        &mut self,
        before: &[f64],
        now: &[f64],
        moved: &[usize],
        refusal: Refusal,
    ) -> Result<Vec<(usize, Failure)>, Refusal> {
        if let [part] = *moved {
            return Ok(vec![(part, Failure::Model(refusal))]);
        }
        let (first, second) = moved.split_at(moved.len() / 2);
        let mut found = Vec::new();
        for half in [first, second] {
            if let Err(refusal) = self.alone(before, now, half) {
                found.extend(self.blame(before, now, half, refusal)?);
            }
        }
        if found.is_empty() { Err(refusal) } else { Ok(found) }
    }

    /// Evaluates where only these parts have moved, and the prescribed DOFs that they feel.
    fn alone(&mut self, before: &[f64], now: &[f64], moved: &[usize]) -> Result<(), Refusal> {
        let mut u = before.to_vec();
        let moved = moved.iter().map(|&part| &self.parts.list[part]);
        moved.for_each(|part| part.free.iter().chain(&part.held).for_each(|&j| u[j] = now[j]));
        self.state.assembly.clear(false);
        self.model.assemble(&u, &mut self.state.assembly)
    }
}

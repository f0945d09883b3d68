//! The reflections of a front, copied to memory of their exact size.

use super::Workspace;
use crate::Error;
use crate::analyse::{Shape, reflection_bytes};
use crate::q::Reflections;

impl Workspace<'_> {
    /// Makes room for as many reflections as the front can have.
    pub(super) fn reserve_q(&mut self, shape: &Shape) -> Result<(), Error> {
        let Some(kept) = &mut self.work.kept else { return Ok(()) };
        let most = shape.rows * shape.rows.min(shape.cols);
        if kept.v.capacity() < most {
            kept.v = Vec::new();
            kept.v = self.ledger.reserve(most)?;
        }
        Ok(())
    }

    /// What the front keeps of Q; nothing if it is not asked for.
    pub(super) fn reflections(&self) -> Result<Option<Box<Reflections>>, Error> {
        let Some(kept) = &self.work.kept else { return Ok(None) };
        self.ledger.take(reflection_bytes(self.names.len(), kept.tau.len(), kept.v.len()))?;
        let mut v = self.ledger.reserve(kept.v.len())?;
        v.extend_from_slice(&kept.v);
        let (first, end, tau) = (kept.first.clone(), kept.end.clone(), kept.tau.clone());
        Ok(Some(Box::new(Reflections { rows: self.names.clone(), first, end, tau, v })))
    }
}

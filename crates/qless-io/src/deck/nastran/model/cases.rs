//! Builds the prescribed DOFs and the loads of a load case.

use std::collections::BTreeMap;

use super::NastranModel;
use super::points::{PointKind, Points, limited};
use super::stops::refuse_second_values;
use crate::deck::nastran::cards::sets::PointSupport;
use crate::deck::nastran::control::selected::CaseSets;
use crate::deck::nastran::syntax::card::CardLocation;
use crate::deck::{DeckError, Dof, Load, LoadCase, Model, Prescribed, Problem};

impl NastranModel<'_> {
    /// The load case in which these `sets` hold.
    pub fn case(&mut self, name: &str, sets: &CaseSets, sets_of: &[(u32, u32)]) -> Result<LoadCase, DeckError> {
        let mut all = self.prescribed_by_grids();
        for (_, support, place) in self.bulk.supports.iter().filter(|(set, ..)| sets.spc.contains(set)) {
            all.extend(self.prescribed(support, 1.0, place)?);
            limited(all.len()).map_err(|problem| place.error(problem, self.model))?;
        }
        all.sort_by_key(|prescribed| prescribed.dof);
        if self.bulk.is_mystran {
            refuse_second_values(&all, self.model);
        }
        let (mut prescribed, mut clashes) = split_clashes(all);
        let enforced = self.enforced(sets)?;
        self.refuse_unsupported(&enforced, &prescribed);
        enforce(enforced, &mut prescribed, &mut clashes);
        let removed =
            sets_of.iter().filter(|(_, set)| !sets.mpc.contains(set)).map(|&(equation, _)| equation).collect();
        Ok(LoadCase { name: name.to_owned(), prescribed, clashes, loads: self.loads(sets), removed })
    }

    /// Components that `GRID` cards prescribe.
    fn prescribed_by_grids(&mut self) -> Vec<Prescribed> {
        let mut all = Vec::new();
        for (grid, set) in self.points.prescribed() {
            let origin = self.points.place(grid).origin(self.model);
            let dofs = set.iter().map(|component| Dof { node: grid.id, component });
            all.extend(dofs.map(|dof| Prescribed { dof, history: 0, value: 0.0, origin }));
        }
        all
    }

    /// The values of a card, times a factor.
    fn prescribed(
        &mut self,
        support: &PointSupport,
        factor: f64,
        place: &CardLocation,
    ) -> Result<Vec<Prescribed>, DeckError> {
        let Self { bulk, points, model } = self;
        let nodes = points.expand(&support.points).map_err(|problem| place.error(problem, model))?;
        points.warn_of_unknown(nodes.iter().copied(), place, model);
        if bulk.is_mystran {
            refuse_unknown(support, place, points, model);
        }
        let mut all = Vec::with_capacity(nodes.len() * support.components.len());
        let (origin, value) = (place.origin(model), factor * support.value);
        for node in nodes {
            if bulk.is_mystran && support.components.is_empty() && points.kind(node) == PointKind::Grid {
                let text = format!("{} names no component of grid point {node}: MYSTRAN prescribes none", place.name);
                model.warn(place.file, place.line, text);
                continue;
            }
            let dofs = points.dofs(node, support.components).map_err(|fault| place.error(fault.into(), model))?;
            all.extend(dofs.into_iter().map(|dof| Prescribed { dof, value, history: 0, origin }));
        }
        Ok(all)
    }

    /// The values of `SPCD` cards in the load sets of the case. Values of one DOF add up.
    fn enforced(&mut self, sets: &CaseSets) -> Result<Vec<Prescribed>, DeckError> {
        let mut all = Vec::new();
        for (set, support, place) in &self.bulk.enforced {
            if let Some(&factor) = sets.loads.get(set) {
                all.extend(self.prescribed(support, factor, place)?);
            }
        }
        all.sort_by_key(|enforced: &Prescribed| enforced.dof);
        all.dedup_by(|next, first| {
            let same = next.dof == first.dof;
            first.value += if same { next.value } else { 0.0 };
            same
        });
        if let Some(infinite) = all.iter().find(|enforced| !enforced.value.is_finite()) {
            let what = "the enforced displacement is too large for a 64-bit number".into();
            return Err(self.model.error(infinite.origin, None, Problem::Degenerate { what }));
        }
        Ok(all)
    }

    /// Refuses enforced values of components that nothing prescribes in the case: by the manuals, a selected `SPC` or `SPC1` must name them.
    fn refuse_unsupported(&mut self, enforced: &[Prescribed], prescribed: &[Prescribed]) {
        let is_free = |given: &&Prescribed| prescribed.binary_search_by_key(&given.dof, |given| given.dof).is_err();
        let free = enforced.iter().filter(is_free).rev().map(|free| ((free.origin.card, free.origin.line), free.dof));
        for ((card, line), dof) in free.collect::<BTreeMap<_, Dof>>() {
            let card = self.model.cards.nth(card);
            let text = format!("{} enforces {dof}, which no selected SPC or SPC1 card names: name it there", card.name);
            self.model.refuse(card.file, line, text);
        }
    }

    fn loads(&mut self, sets: &CaseSets) -> Vec<Load> {
        let mut loads = Vec::new();
        for loaded in self.bulk.loads.iter().filter(|loaded| sets.loads.contains_key(&loaded.set)) {
            let origin = loaded.place.origin(self.model);
            // A load on an undefined point acts on no constrained DOF.
            let dofs = self.points.dofs(loaded.node, loaded.components).unwrap_or_default();
            loads.extend(dofs.into_iter().map(|dof| Load { dof, origin }));
        }
        loads
    }
}

/// Refuses a card that prescribes undefined points, because MYSTRAN stops there. If the card names a range, both of its ends must be
/// defined.
fn refuse_unknown(support: &PointSupport, place: &CardLocation, points: &Points, model: &mut Model) {
    let mut ends = support.points.iter().flat_map(|span| [span.first, span.last]);
    if let Some(node) = ends.find(|&node| points.kind(node) == PointKind::Unknown) {
        let text = format!("{} prescribes point {node}, which is not defined: MYSTRAN stops", place.name);
        model.refuse(place.file, place.line, text);
    }
}

/// Splits values, ascending by DOF, into the first value of each DOF and the later values that contradict it.
fn split_clashes(all: Vec<Prescribed>) -> (Vec<Prescribed>, Vec<Prescribed>) {
    let mut first: Vec<Prescribed> = Vec::with_capacity(all.len());
    let mut clashes = Vec::new();
    for next in all {
        match first.last() {
            Some(before) if before.dof == next.dof => {
                if before.value != next.value {
                    clashes.push(next);
                }
            }
            _ => first.push(next),
        }
    }
    (first, clashes)
}

/// Replaces the values that `SPC` prescribes by enforced values of the same DOFs.
fn enforce(enforced: Vec<Prescribed>, prescribed: &mut Vec<Prescribed>, clashes: &mut Vec<Prescribed>) {
    if enforced.is_empty() {
        return;
    }
    let is_enforced = |p: &Prescribed| enforced.binary_search_by_key(&p.dof, |enforced| enforced.dof).is_ok();
    prescribed.retain(|p| !is_enforced(p));
    clashes.retain(|p| !is_enforced(p));
    prescribed.extend(enforced);
    prescribed.sort_by_key(|p| p.dof);
}

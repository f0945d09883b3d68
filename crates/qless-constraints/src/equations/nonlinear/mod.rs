//! The nonlinear equations of all types, in batches.
//!
//! An item is the nonlinear equations of one type that one constraint has. Batches are sorted by type, in the order of first use; the items
//! of a type are sorted by constraint.

pub mod batch;
mod dispatch;
mod evaluation;
mod pairs;
pub mod typed;

use std::any::TypeId;
use std::collections::HashMap;
use std::ops::Range;

use crate::equations::nonlinear::batch::{NonlinearBatch, StagedNonlinear};
use crate::equations::nonlinear::typed::TypedBatch;
use crate::equations::{EquationNames, EquationOwner, RowOffsets};
use crate::nonlinear::Nonlinear;

/// Index of a batch, and of an item in it.
pub type ItemPlace = (usize, usize);

/// All batches of a set.
#[derive(Default)]
pub struct NonlinearEquations {
    pub batches: Vec<Box<dyn NonlinearBatch>>,
    /// The type number of each batch.
    kinds: Vec<u32>,
    of_type: HashMap<TypeId, u32>,
    /// The type and batch of the last inserted item, since many items of a type often follow each other.
    recent: Option<(TypeId, usize)>,
    /// Reserve memory for full batches from the start.
    many: bool,
    pub offsets: RowOffsets,
}

impl NonlinearEquations {
    /// Empty, but expects many items of each type.
    pub fn for_many_items() -> Self {
        Self { many: true, ..Self::default() }
    }

    pub fn rows(&self) -> usize {
        self.offsets.rows()
    }

    /// Each batch with its type number.
    pub fn with_kinds(&self) -> impl Iterator<Item = (&dyn NonlinearBatch, u32)> {
        self.batches.iter().map(AsRef::as_ref).zip(self.kinds.iter().copied())
    }

    /// Evaluates parameters that are functions of time. The error is a nonlinear row whose value is not finite, and that value.
    pub fn set_time(&mut self, time: f64) -> Result<(), (usize, f64)> {
        let Self { batches, offsets, .. } = self;
        let mut batches = batches.iter_mut().enumerate();
        batches.try_for_each(|(b, batch)| batch.set_time(time).map_err(|(row, value)| (offsets.first(b) + row, value)))
    }

    pub fn kind<Q: Nonlinear>(&self) -> Option<u32> {
        self.of_type.get(&TypeId::of::<Q>()).copied()
    }

    pub fn typed<Q: Nonlinear>(&self, batch: usize) -> Option<&TypedBatch<Q>> {
        self.batches.get(batch)?.as_any().downcast_ref()
    }

    pub fn typed_mut<Q: Nonlinear>(&mut self, batch: usize) -> Option<&mut TypedBatch<Q>> {
        self.batches.get_mut(batch)?.as_any_mut().downcast_mut()
    }

    fn batches_of_kind(&self, kind: u32) -> Range<usize> {
        self.kinds.partition_point(|&k| k < kind)..self.kinds.partition_point(|&k| k <= kind)
    }

    /// Inserts an item after those of its constraint and of earlier ones.
    pub fn insert<Q: Nonlinear>(&mut self, owner: EquationOwner, dofs: &[u32], parameters: Q) {
        if let Some((place, batch)) = self.recent_room::<Q>(owner.constraint) {
            batch.insert(owner, dofs, parameters);
            return self.offsets.grow(place, Q::EQUATION_NAMES.len() as i32);
        }
        let kind = self.meet(TypeId::of::<Q>());
        let place = self.room_at::<Q>(kind, owner.constraint);
        self.recent = Some((TypeId::of::<Q>(), place));
        if let Some(batch) = self.typed_mut::<Q>(place) {
            batch.insert(owner, dofs, parameters);
        }
        self.offsets.grow(place, Q::EQUATION_NAMES.len() as i32);
    }

    /// The batch of the last inserted item, if the next item can be appended to it.
    fn recent_room<Q: Nonlinear>(&mut self, constraint: u32) -> Option<(usize, &mut TypedBatch<Q>)> {
        let (_, place) = self.recent.filter(|&(of, _)| of == TypeId::of::<Q>())?;
        let last_of_type = self.kinds.get(place + 1) != self.kinds.get(place);
        let batch = self.typed_mut::<Q>(place)?;
        let fits =
            last_of_type && !batch.is_full() && batch.owners.last().is_none_or(|last| last.constraint <= constraint);
        fits.then_some((place, batch))
    }

    /// The number of a type; it is added if it is new.
    fn meet(&mut self, of: TypeId) -> u32 {
        let next = self.of_type.len() as u32;
        *self.of_type.entry(of).or_insert(next)
    }

    /// The batch into which an item of this constraint can be inserted. A full batch is split first.
    fn room_at<Q: Nonlinear>(&mut self, kind: u32, constraint: u32) -> usize {
        let of = self.batches_of_kind(kind);
        let at = of.start + self.batches[of.clone()].partition_point(|batch| last(batch.as_ref()) <= constraint);
        if at == of.end {
            if of.is_empty() || self.batches[at - 1].is_full() {
                self.offsets.insert(at);
                let few = of.is_empty() && !self.many;
                let batch = if few { TypedBatch::<Q>::default() } else { TypedBatch::with_room() };
                self.put(at, kind, Box::new(batch));
                return at;
            }
            return at - 1;
        }
        if !self.batches[at].is_full() {
            return at;
        }
        let half = self.batches[at].items() / 2;
        let second = self.batches[at].split_off(half);
        self.offsets.split(at, self.batches[at].rows());
        self.put(at + 1, kind, second);
        if last(self.batches[at].as_ref()) <= constraint { at + 1 } else { at }
    }

    /// Appends the items of later constraints, whose names are renumbered by `names`.
    pub fn join(&mut self, others: Self, names: Option<&[u32]>) {
        let mut types: Vec<_> = others.of_type.into_iter().collect();
        types.sort_unstable_by_key(|&(_, kind)| kind);
        let kinds: Vec<u32> = types.into_iter().map(|(of, _)| self.meet(of)).collect();
        for (mut batch, kind) in others.batches.into_iter().zip(others.kinds) {
            let kind = kinds[kind as usize];
            let at = self.batches_of_kind(kind).end;
            batch.renumber_names(names);
            self.offsets.insert(at);
            self.offsets.grow(at, batch.rows() as i32);
            self.put(at, kind, batch);
        }
    }

    fn put(&mut self, at: usize, kind: u32, batch: Box<dyn NonlinearBatch>) {
        self.recent = None;
        self.batches.insert(at, batch);
        self.kinds.insert(at, kind);
    }

    /// The items of a constraint with their type numbers, type by type.
    pub fn items_of(&self, constraint: u32) -> Vec<(u32, ItemPlace)> {
        let mut places = Vec::new();
        for kind in 0..self.of_type.len() as u32 {
            let of = self.batches_of_kind(kind);
            let first = of.start + self.batches[of.clone()].partition_point(|batch| last(batch.as_ref()) < constraint);
            for batch in first..of.end {
                let own = items(self.batches[batch].as_ref(), constraint);
                if own.is_empty() {
                    break;
                }
                places.extend(own.map(|item| (kind, (batch, item))));
            }
        }
        places
    }

    /// Removes and returns the items of a constraint, and their DOFs.
    pub fn take(&mut self, constraint: u32, names: &EquationNames) -> (Vec<Box<dyn StagedNonlinear>>, Vec<u32>) {
        let (places, mut dofs) = (self.items_of(constraint), Vec::new());
        // Backwards, so that the places of the others stay valid.
        let mut pieces: Vec<_> =
            places.iter().rev().map(|&(_, place)| self.take_item(place, names, &mut dofs)).collect();
        pieces.reverse();
        (pieces, dofs)
    }

    fn take_item(
        &mut self,
        (batch, item): ItemPlace,
        names: &EquationNames,
        dofs: &mut Vec<u32>,
    ) -> Box<dyn StagedNonlinear> {
        let rows = self.batches[batch].equations_per_item() as i32;
        let piece = self.batches[batch].take(item, names, dofs);
        self.offsets.grow(batch, -rows);
        if self.batches[batch].items() == 0 {
            self.batches.remove(batch);
            self.kinds.remove(batch);
            self.offsets.remove(batch);
            self.recent = None;
        }
        piece
    }
}

/// The constraint of the last item.
fn last(batch: &dyn NonlinearBatch) -> u32 {
    batch.items().checked_sub(1).map_or(0, |i| batch.constraint(i))
}

/// The items of a constraint in a batch.
fn items(batch: &dyn NonlinearBatch, constraint: u32) -> Range<usize> {
    let first_from = |constraint: u32| {
        let (mut low, mut high) = (0, batch.items());
        while low < high {
            let middle = low.midpoint(high);
            (low, high) = if batch.constraint(middle) < constraint { (middle + 1, high) } else { (low, middle) };
        }
        low
    };
    first_from(constraint)..first_from(constraint + 1)
}

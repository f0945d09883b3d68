//! Constraints by number, who an equation belongs to, and its label "constraint, part".

use std::borrow::Cow;
use std::collections::{BTreeMap, HashMap};

use qless::common::Identity;

use super::contents::Contents;
use super::error::EditError;
use super::names::Names;

/// A constraint of a set, which no other set takes; it stays valid until the constraint is removed, and is not given again.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ConstraintId {
    pub(super) set: Identity,
    pub(super) number: u32,
}

impl ConstraintId {
    /// How many constraints were added before it.
    pub fn place(self) -> usize {
        self.number as usize
    }
}

/// Constraints that were added at once, by [`crate::ConstraintSet::add_all`]; as many as were asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ConstraintIds {
    pub(super) set: Identity,
    pub(super) first: u32,
    pub(super) count: u32,
}

impl ConstraintIds {
    /// The i-th of them, from 0; nothing beyond the last.
    pub fn get(self, i: usize) -> Option<ConstraintId> {
        (i < self.count as usize).then(|| ConstraintId { set: self.set, number: self.first + i as u32 })
    }

    /// All, in their order.
    pub fn iter(self) -> impl ExactSizeIterator<Item = ConstraintId> + DoubleEndedIterator {
        // As `usize`, whose ranges know their length.
        (0..self.count as usize).map(move |i| ConstraintId { set: self.set, number: self.first + i as u32 })
    }
}

/// The constraint that equations belong to, and which part of it they are.
#[derive(Clone, Copy)]
pub(super) struct Owner {
    pub constraint: u32,
    /// Its place among [`Parts`].
    pub part: u32,
}

/// Gives parts the numbers that stand at theirs.
pub(super) fn renumber(owners: &mut [Owner], parts: Option<&[u32]>) {
    if let Some(parts) = parts {
        owners.iter_mut().for_each(|owner| owner.part = parts[owner.part as usize]);
    }
}

/// The names of parts, each once: there are few, and many equations.
pub(super) struct Parts {
    names: Vec<Cow<'static, str>>,
    places: HashMap<Cow<'static, str>, u32>,
}

impl Default for Parts {
    fn default() -> Self {
        Self { names: vec!["".into()], places: HashMap::new() }
    }
}

impl Parts {
    /// The place of a name, which is 0 for the empty one.
    pub fn place(&mut self, name: Cow<'static, str>) -> u32 {
        if name.is_empty() {
            return 0;
        }
        if let Some(&place) = self.places.get(&name) {
            return place;
        }
        let place = self.names.len() as u32;
        self.names.push(name.clone());
        self.places.insert(name, place);
        place
    }

    /// The places here of all names there, unless they are the same.
    pub fn places_of(&mut self, others: &Self) -> Option<Vec<u32>> {
        let places: Vec<u32> = others.names.iter().map(|name| self.place(name.clone())).collect();
        (0..).zip(&places).any(|(there, &here)| there != here).then_some(places)
    }

    pub fn name(&self, place: u32) -> Cow<'static, str> {
        self.names[place as usize].clone()
    }
}

/// All constraints that were ever added: their labels, and what those consist of that are not active.
#[derive(Default)]
pub(super) struct Register {
    pub identity: Identity,
    pub parts: Parts,
    names: Names,
    alive: usize,
    inactive: BTreeMap<u32, Box<Contents>>,
}

impl Register {
    pub fn new() -> Self {
        Self { identity: Identity::new(), ..Self::default() }
    }

    /// Number of constraints that were ever added.
    pub fn ever(&self) -> usize {
        self.names.count() as usize
    }

    pub fn alive(&self) -> usize {
        self.alive
    }

    pub fn add(&mut self, label: String) -> ConstraintId {
        let id = ConstraintId { set: self.identity, number: self.names.count() };
        self.names.push(label);
        self.alive += 1;
        id
    }

    /// So many at once.
    pub fn add_all(&mut self, label: String, count: u32) -> ConstraintIds {
        let ids = ConstraintIds { set: self.identity, first: self.names.count(), count };
        self.names.push_numbered(label, count);
        self.alive += count as usize;
        ids
    }

    /// The number of a constraint that is there.
    pub fn number(&self, id: ConstraintId) -> Result<u32, EditError> {
        if id.set != self.identity {
            return Err(EditError::Foreign);
        }
        let there = self.names.is_there(id.number);
        there.then_some(id.number).ok_or(EditError::Gone { place: id.place() })
    }

    pub fn remove(&mut self, number: u32) {
        self.names.remove(number);
        self.alive -= 1;
    }

    pub fn is_active(&self, number: u32) -> bool {
        !self.inactive.contains_key(&number)
    }

    /// Keeps what an inactive constraint consists of.
    pub fn park(&mut self, number: u32, contents: Box<Contents>) {
        self.inactive.insert(number, contents);
    }

    pub fn parked(&self, number: u32) -> Option<&Contents> {
        self.inactive.get(&number).map(AsRef::as_ref)
    }

    pub fn parked_mut(&mut self, number: u32) -> Option<&mut Contents> {
        self.inactive.get_mut(&number).map(AsMut::as_mut)
    }

    /// What an inactive constraint consists of, which it is no more.
    pub fn take(&mut self, number: u32) -> Option<Box<Contents>> {
        self.inactive.remove(&number)
    }

    pub fn name(&self, number: u32) -> Cow<'_, str> {
        self.names.get(number).unwrap_or_default()
    }

    /// The name of the constraint and of the parts that have one, with commas.
    pub fn label(&self, owner: Owner, part: &str) -> String {
        let mut label = self.name(owner.constraint).into_owned();
        for part in [self.parts.name(owner.part).as_ref(), part].into_iter().filter(|part| !part.is_empty()) {
            if !label.is_empty() {
                label.push_str(", ");
            }
            label.push_str(part);
        }
        label
    }
}

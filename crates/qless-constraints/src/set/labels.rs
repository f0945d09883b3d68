//! Constraints by number, who an equation belongs to, and its label "constraint, part".

use std::borrow::Cow;
use std::collections::{BTreeMap, HashMap};

use qless::Identity;

use super::error::EditError;
use super::store::Contents;

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

/// The constraint that equations belong to, and which part of it they are.
#[derive(Clone, Copy)]
pub(super) struct Owner {
    pub constraint: u32,
    /// Its place among [`Parts`].
    pub part: u32,
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

    pub fn name(&self, place: u32) -> Cow<'static, str> {
        self.names[place as usize].clone()
    }
}

/// All constraints that were ever added: their labels, and what those consist of that are not active.
#[derive(Default)]
pub(super) struct Register {
    pub identity: Identity,
    pub parts: Parts,
    /// None for those that were removed.
    names: Vec<Option<Box<str>>>,
    alive: usize,
    inactive: BTreeMap<u32, Box<Contents>>,
}

impl Register {
    pub fn new() -> Self {
        Self { identity: Identity::new(), ..Self::default() }
    }

    /// Number of constraints that were ever added.
    pub fn ever(&self) -> usize {
        self.names.len()
    }

    pub fn alive(&self) -> usize {
        self.alive
    }

    pub fn add(&mut self, label: String) -> ConstraintId {
        let id = ConstraintId { set: self.identity, number: self.names.len() as u32 };
        self.names.push(Some(label.into_boxed_str()));
        self.alive += 1;
        id
    }

    /// The number of a constraint that is there.
    pub fn number(&self, id: ConstraintId) -> Result<u32, EditError> {
        if id.set != self.identity {
            return Err(EditError::Foreign);
        }
        self.names[id.number as usize].as_ref().map(|_| id.number).ok_or(EditError::Gone { place: id.place() })
    }

    pub fn remove(&mut self, number: u32) {
        self.names[number as usize] = None;
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

    pub fn name(&self, number: u32) -> &str {
        self.names[number as usize].as_deref().unwrap_or_default()
    }

    /// The name of the constraint and of the parts that have one, with commas.
    pub fn label(&self, owner: Owner, part: &str) -> String {
        let mut label = self.name(owner.constraint).to_string();
        for part in [self.parts.name(owner.part).as_ref(), part].into_iter().filter(|part| !part.is_empty()) {
            if !label.is_empty() {
                label.push_str(", ");
            }
            label.push_str(part);
        }
        label
    }
}

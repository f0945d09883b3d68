//! Who an equation belongs to, and its label "constraint, part".

use std::borrow::Cow;

use qless::Identity;

/// A constraint of a set, which no other set takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ConstraintId {
    pub(super) set: Identity,
    pub(super) number: usize,
}

impl ConstraintId {
    /// How many constraints were added before it.
    pub fn place(self) -> usize {
        self.number
    }
}

/// The constraint that equations belong to, and which part of it they are.
pub(super) struct Owner {
    pub constraint: u32,
    pub part: Cow<'static, str>,
}

impl Owner {
    pub fn constraint(&self, set: Identity) -> ConstraintId {
        ConstraintId { set, number: self.constraint as usize }
    }

    /// The name of the constraint and of the parts that have one, with commas.
    pub fn label(&self, names: &[String], part: &str) -> String {
        let mut label = names[self.constraint as usize].clone();
        for part in [self.part.as_ref(), part].into_iter().filter(|part| !part.is_empty()) {
            if !label.is_empty() {
                label.push_str(", ");
            }
            label.push_str(part);
        }
        label
    }
}

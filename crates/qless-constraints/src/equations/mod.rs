//! Storage of the equations of a set: linear ones and nonlinear ones, and the plan by which their Hessians are summed.
//!
//! | word | meaning |
//! | --- | --- |
//! | item | the nonlinear equations of one type that one constraint has: parameters and a list of DOFs |
//! | batch | equations of c and G that are stored together and evaluated by one task: [`linear::batch`], [`nonlinear::batch`] |
//! | chunk | rows of H that one task writes: [`hessian::chunk`] |
//! | stamp | identity of one state of a batch or chunk; a new one after each change |
//!
//! Modules, lowest first: this one and [`layout`], [`dof_uses`], [`linear`] and [`nonlinear`], [`contents`] and [`hessian`], [`tasks`].

pub mod contents;
pub mod dof_uses;
pub mod hessian;
pub mod layout;
pub mod linear;
pub mod nonlinear;
pub mod tasks;

use std::borrow::Cow;
use std::collections::HashMap;
use std::sync::{Arc, OnceLock};

use qless::common::Identity;

/// The constraint that an equation belongs to, and which of its equations it is.
#[derive(Clone, Copy)]
pub struct EquationOwner {
    pub constraint: u32,
    /// Index into [`EquationNames`].
    pub name: u32,
}

/// Replaces each index into one list of names by `names[index]`, the index into another.
pub fn renumber(owners: &mut [EquationOwner], names: Option<&[u32]>) {
    if let Some(names) = names {
        owners.iter_mut().for_each(|owner| owner.name = names[owner.name as usize]);
    }
}

/// The names that tell the equations of one constraint apart, such as "x". Each is stored once, as few names serve many equations.
pub struct EquationNames {
    names: Vec<Cow<'static, str>>,
    places: HashMap<Cow<'static, str>, u32>,
}

impl Default for EquationNames {
    fn default() -> Self {
        Self { names: vec!["".into()], places: HashMap::new() }
    }
}

impl EquationNames {
    /// The index of a name; it is added if it is new. The empty name has index 0.
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

    /// The indices here of all names of another list; `None` if they are the same as there.
    pub fn places_of(&mut self, others: &Self) -> Option<Vec<u32>> {
        let places: Vec<u32> = others.names.iter().map(|name| self.place(name.clone())).collect();
        (0..).zip(&places).any(|(there, &here)| there != here).then_some(places)
    }

    pub fn name(&self, place: u32) -> Cow<'static, str> {
        self.names[place as usize].clone()
    }
}

/// The first row of each batch, and at the end the number of rows.
pub struct RowOffsets(Vec<u32>);

impl Default for RowOffsets {
    fn default() -> Self {
        Self(vec![0])
    }
}

impl RowOffsets {
    /// Rows of all batches.
    pub fn rows(&self) -> usize {
        self.0.last().map_or(0, |&rows| rows as usize)
    }

    /// The first row of a batch; the number of rows for the index after the last batch.
    pub fn first(&self, batch: usize) -> usize {
        self.0[batch] as usize
    }

    /// The batch that holds a row, and the row's number in that batch.
    pub fn find(&self, row: usize) -> (usize, usize) {
        let batch = self.0.partition_point(|&first| first as usize <= row) - 1;
        (batch, row - self.0[batch] as usize)
    }

    /// Changes the number of rows of a batch.
    pub fn grow(&mut self, batch: usize, by: i32) {
        self.0[batch + 1..].iter_mut().for_each(|first| *first = first.wrapping_add_signed(by));
    }

    /// Appends a batch of this many rows.
    pub fn push(&mut self, rows: usize) {
        self.0.push((self.rows() + rows) as u32);
    }

    /// Inserts a batch without rows.
    pub fn insert(&mut self, batch: usize) {
        self.0.insert(batch, self.0[batch]);
    }

    /// Removes a batch that has no rows.
    pub fn remove(&mut self, batch: usize) {
        self.0.remove(batch);
    }

    /// Splits a batch after its first `rows` rows.
    pub fn split(&mut self, batch: usize, rows: usize) {
        self.0.insert(batch + 1, self.0[batch] + rows as u32);
    }
}

/// Identity of a state since the last change. It is made on request, since most changes follow one another unobserved.
#[derive(Default)]
pub struct ChangeStamp(OnceLock<Identity>);

impl ChangeStamp {
    pub fn get(&self) -> Identity {
        *self.0.get_or_init(Identity::new)
    }

    /// To be called after each change.
    pub fn renew(&mut self) {
        self.0.take();
    }
}

/// A right-hand side `b(t)`.
pub type TimeFunction = Arc<dyn Fn(f64) -> f64 + Send + Sync>;

/// The right-hand side of a linear equation.
#[derive(Clone)]
pub enum LinearRhs {
    Value(f64),
    TimeFunction(TimeFunction),
}

impl LinearRhs {
    pub fn at(&self, time: f64) -> f64 {
        match self {
            Self::Value(value) => *value,
            Self::TimeFunction(function) => function(time),
        }
    }
}

//! Constraints by number, who an equation belongs to, and its label "constraint, name".
//! Which segment of a list a row belongs to.
//! Which state of something is meant: an identity that is made when somebody asks, as most changes follow one another unseen.
//! Right-hand sides and parameters that are functions of time: `c(u, t) = 0`.
//!
//! The pattern of G and H is the same at all times; [`ConstraintSet::set_time`] writes new numbers in place. Constraints that are not active
//! take theirs when they are activated.

pub mod contents;
pub mod coordinates;
pub mod hessian;
pub mod layout;
pub mod linear;
pub mod nonlinear;
pub mod tasks;

use std::borrow::Cow;
use std::collections::HashMap;
use std::sync::{Arc, OnceLock};

use qless::common::Identity;

/// The constraint that equations belong to, and which name of it they are.
#[derive(Clone, Copy)]
pub struct EquationOwner {
    pub constraint: u32,
    /// Its place among [`EquationNames`].
    pub name: u32,
}

/// Gives names the numbers that stand at theirs.
pub fn renumber(owners: &mut [EquationOwner], names: Option<&[u32]>) {
    if let Some(names) = names {
        owners.iter_mut().for_each(|owner| owner.name = names[owner.name as usize]);
    }
}

/// The names of names, each once: there are few, and many equations.
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

/// The first row of each segment, and one more: the number of rows.
pub struct RowOffsets(Vec<u32>);

impl Default for RowOffsets {
    fn default() -> Self {
        Self(vec![0])
    }
}

impl RowOffsets {
    /// Rows of all segments.
    pub fn rows(&self) -> usize {
        self.0.last().map_or(0, |&rows| rows as usize)
    }

    /// The first row of a segment; behind the last one, the number of rows.
    pub fn first(&self, segment: usize) -> usize {
        self.0[segment] as usize
    }

    /// The segment of a row that is there, and the row in it.
    pub fn find(&self, row: usize) -> (usize, usize) {
        let segment = self.0.partition_point(|&first| first as usize <= row) - 1;
        (segment, row - self.0[segment] as usize)
    }

    /// A segment has so many rows more.
    pub fn grow(&mut self, segment: usize, by: i32) {
        self.0[segment + 1..].iter_mut().for_each(|first| *first = first.wrapping_add_signed(by));
    }

    /// One more segment, of so many rows, behind all.
    pub fn push(&mut self, rows: usize) {
        self.0.push((self.rows() + rows) as u32);
    }

    /// A segment without rows is put in.
    pub fn insert(&mut self, segment: usize) {
        self.0.insert(segment, self.0[segment]);
    }

    /// A segment without rows is taken out.
    pub fn remove(&mut self, segment: usize) {
        self.0.remove(segment);
    }

    /// A segment ends after so many rows, and the next one has the others.
    pub fn split(&mut self, segment: usize, rows: usize) {
        self.0.insert(segment + 1, self.0[segment] + rows as u32);
    }
}

/// Of the state since the last change.
#[derive(Default)]
pub struct ChangeStamp(OnceLock<Identity>);

impl ChangeStamp {
    pub fn get(&self) -> Identity {
        *self.0.get_or_init(Identity::new)
    }

    /// After a change.
    pub fn renew(&mut self) {
        self.0.take();
    }
}

/// `b(t)`.
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

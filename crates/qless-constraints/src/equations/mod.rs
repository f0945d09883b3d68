//! Storage of the equations of a set: linear ones and nonlinear ones, and the plan by which their Hessians are summed.
//!
//! | word | meaning |
//! | --- | --- |
//! | item | the nonlinear equations of one call of `EquationSink::nonlinear`: parameters and a list of DOFs |
//! | batch | all items of one type |
//! | stamp | identity of one state of the data; each change gives a new one |
//!
//! Modules, lowest first: this one and [`dof_uses`], [`linear`] and [`nonlinear`], [`contents`] and [`hessian`], [`tasks`].

pub mod contents;
pub mod dof_uses;
pub mod hessian;
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

    pub fn name(&self, place: u32) -> Cow<'static, str> {
        self.names[place as usize].clone()
    }
}

/// Identity of the state since the last change. It is made only when it is first read, because often several changes follow each other
/// before that.
#[derive(Default)]
pub struct ChangeStamp(OnceLock<Identity>);

impl ChangeStamp {
    pub fn get(&self) -> Identity {
        *self.0.get_or_init(Identity::new)
    }

    /// Call this after each change: the next read then makes a new identity.
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

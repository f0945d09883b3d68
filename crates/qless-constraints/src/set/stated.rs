//! What active constraints state of the coordinates that DOFs add to.

use std::sync::OnceLock;

use super::rounding::{Size, Sizes};

/// A DOF that adds to a coordinate.
#[derive(Clone, Copy)]
pub(super) struct Coordinate {
    dof: u32,
    sizes: Sizes,
}

impl Coordinate {
    /// `node`: the largest coordinate of the node; along an axis where it has none, it is no smaller a model.
    pub fn new(dof: usize, at: f64, node: f64) -> Self {
        Self { dof: dof as u32, sizes: Sizes { at: Size::above(at), node: Size::above(node) } }
    }
}

/// By constraint, and the largest by DOF, which are looked for when they are asked for: a constraint that goes takes its own along.
#[derive(Default)]
pub(super) struct Stated {
    by_constraint: Vec<Box<[Coordinate]>>,
    largest: OnceLock<Vec<Sizes>>,
}

impl Stated {
    pub fn put(&mut self, constraint: u32, coordinates: Vec<Coordinate>) {
        if coordinates.is_empty() {
            return;
        }
        if let Some(largest) = self.largest.get_mut() {
            coordinates.iter().for_each(|&coordinate| enter(coordinate, largest));
        }
        let place = constraint as usize;
        if self.by_constraint.len() <= place {
            self.by_constraint.resize_with(place + 1, Box::default);
        }
        self.by_constraint[place] = coordinates.into_boxed_slice();
    }

    pub fn take(&mut self, constraint: u32) -> Vec<Coordinate> {
        let taken = self.by_constraint.get_mut(constraint as usize).map(std::mem::take).unwrap_or_default();
        if !taken.is_empty() {
            self.largest.take();
        }
        taken.into_vec()
    }

    /// By DOF; shorter if the others have none.
    pub fn largest(&self) -> &[Sizes] {
        self.largest.get_or_init(|| {
            let mut largest = Vec::new();
            self.by_constraint.iter().flatten().for_each(|&coordinate| enter(coordinate, &mut largest));
            largest
        })
    }
}

fn enter(Coordinate { dof, sizes }: Coordinate, largest: &mut Vec<Sizes>) {
    let dof = dof as usize;
    if largest.len() <= dof {
        largest.resize(dof + 1, Sizes::default());
    }
    let known = &mut largest[dof];
    *known = Sizes { at: known.at.max(sizes.at), node: known.node.max(sizes.node) };
}

//! What active constraints state of the coordinates that DOFs add to.

use std::ops::Range;
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
    /// Of all constraints, with those of some that are gone.
    all: Vec<Coordinate>,
    /// Where those of each constraint are.
    of: Vec<Range<usize>>,
    gone: usize,
    largest: OnceLock<Vec<Sizes>>,
}

impl Stated {
    /// Takes over what a constraint without any states.
    pub fn put(&mut self, constraint: u32, coordinates: &mut Vec<Coordinate>) {
        if coordinates.is_empty() {
            return;
        }
        if let Some(largest) = self.largest.get_mut() {
            coordinates.iter().for_each(|&coordinate| enter(coordinate, largest));
        }
        let (place, first) = (constraint as usize, self.all.len());
        if self.of.len() <= place {
            self.of.resize(place + 1, 0..0);
        }
        self.all.append(coordinates);
        self.of[place] = first..self.all.len();
    }

    pub fn take(&mut self, constraint: u32) -> Vec<Coordinate> {
        let range = self.of.get_mut(constraint as usize).map(std::mem::take).unwrap_or_default();
        let taken = self.all[range].to_vec();
        if !taken.is_empty() {
            self.largest.take();
            self.gone += taken.len();
            self.close_gaps();
        }
        taken
    }

    /// Where more than half is of constraints that are gone.
    fn close_gaps(&mut self) {
        if 2 * self.gone <= self.all.len() {
            return;
        }
        let mut all = Vec::with_capacity(self.all.len() - self.gone);
        for range in &mut self.of {
            let first = all.len();
            all.extend_from_slice(&self.all[range.clone()]);
            *range = first..all.len();
        }
        (self.all, self.gone) = (all, 0);
    }

    /// By DOF; shorter if the others have none.
    pub fn largest(&self) -> &[Sizes] {
        self.largest.get_or_init(|| {
            let mut largest = Vec::new();
            self.of
                .iter()
                .flat_map(|range| &self.all[range.clone()])
                .for_each(|&coordinate| enter(coordinate, &mut largest));
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

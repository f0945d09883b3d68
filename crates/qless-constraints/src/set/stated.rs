//! What active constraints state of the coordinates that DOFs add to.

use std::sync::OnceLock;

use super::rounding::{Size, Sizes};

/// Coordinates of a segment that no more are put behind, but for those of one constraint.
const LONG: usize = 1 << 16;

/// A DOF that adds to a coordinate.
#[derive(Clone, Copy)]
pub(super) struct Coordinate {
    dof: u32,
    sizes: Sizes,
}

impl Coordinate {
    /// `node`: the largest coordinate of the node; along an axis where it has none, it is no smaller a model.
    #[inline]
    pub fn new(dof: usize, at: f64, node: Size) -> Self {
        Self { dof: dof as u32, sizes: Sizes { at: Size::above(at), node } }
    }
}

/// What constraints state that follow one another.
#[derive(Default)]
pub(super) struct Segment {
    pub all: Vec<Coordinate>,
    /// Where those of each end.
    end: Vec<u32>,
}

impl Segment {
    /// What a constraint, one of so many, states is complete.
    pub fn close(&mut self, expected: usize) {
        if self.end.is_empty() {
            self.end.reserve_exact(expected);
            self.all.reserve_exact(self.all.len() * (expected - 1));
        }
        self.end.push(self.all.len() as u32);
    }
}

/// Where the coordinates of a constraint are.
#[derive(Clone, Copy, Default)]
struct Span {
    segment: u32,
    first: u32,
    end: u32,
}

/// By constraint, and the largest by DOF, which are looked for when they are asked for: a constraint that goes takes its own along.
#[derive(Default)]
pub(super) struct Stated {
    /// Of all constraints, with those of some that are gone.
    segments: Vec<Vec<Coordinate>>,
    of: Vec<Span>,
    there: usize,
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
        let place = constraint as usize;
        if self.of.len() <= place {
            self.of.resize(place + 1, Span::default());
        }
        self.there += coordinates.len();
        self.of[place] = append(&mut self.segments, coordinates);
        coordinates.clear();
    }

    /// Takes over what constraints state from this one on, which come after all others; how many these are.
    pub fn join(&mut self, constraint: u32, new: Segment) -> u32 {
        if !new.all.is_empty() {
            let (segment, mut first) = (self.segments.len() as u32, 0);
            self.of.resize(constraint as usize, Span::default());
            let spans = new.end.iter().map(|&end| Span { segment, first: std::mem::replace(&mut first, end), end });
            self.of.extend(spans);
            self.there += new.all.len();
            self.segments.push(new.all);
            self.largest.take();
        }
        new.end.len() as u32
    }

    pub fn take(&mut self, constraint: u32) -> Vec<Coordinate> {
        let span = self.of.get_mut(constraint as usize).map(std::mem::take).unwrap_or_default();
        let taken = within(&self.segments, span).to_vec();
        if !taken.is_empty() {
            self.largest.take();
            self.there -= taken.len();
            self.gone += taken.len();
            self.close_gaps();
        }
        taken
    }

    /// Where more than half is of constraints that are gone.
    fn close_gaps(&mut self) {
        if self.gone <= self.there {
            return;
        }
        let mut segments = Vec::new();
        for span in &mut self.of {
            *span = append(&mut segments, within(&self.segments, *span));
        }
        (self.segments, self.gone) = (segments, 0);
    }

    /// By DOF; shorter if the others have none.
    pub fn largest(&self) -> &[Sizes] {
        self.largest.get_or_init(|| {
            let mut largest = Vec::new();
            let all = self.of.iter().flat_map(|&span| within(&self.segments, span));
            all.for_each(|&coordinate| enter(coordinate, &mut largest));
            largest
        })
    }
}

/// Puts coordinates of one constraint behind the others.
fn append(segments: &mut Vec<Vec<Coordinate>>, coordinates: &[Coordinate]) -> Span {
    if coordinates.is_empty() {
        return Span::default();
    }
    if segments.last().is_none_or(|last| last.len() >= LONG) {
        segments.push(Vec::new());
    }
    let segment = segments.len() - 1;
    let first = segments[segment].len() as u32;
    segments[segment].extend_from_slice(coordinates);
    Span { segment: segment as u32, first, end: first + coordinates.len() as u32 }
}

/// None if there is no segment.
fn within(segments: &[Vec<Coordinate>], Span { segment, first, end }: Span) -> &[Coordinate] {
    segments.get(segment as usize).map_or(&[], |all| &all[first as usize..end as usize])
}

fn enter(Coordinate { dof, sizes }: Coordinate, largest: &mut Vec<Sizes>) {
    let dof = dof as usize;
    if largest.len() <= dof {
        largest.resize(dof + 1, Sizes::default());
    }
    let known = &mut largest[dof];
    *known = Sizes { at: known.at.max(sizes.at), node: known.node.max(sizes.node) };
}

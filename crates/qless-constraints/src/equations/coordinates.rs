//! What active constraints state of the coordinates that DOFs add to.

use std::sync::OnceLock;

use crate::scalar::Bounded;

/// The size of a number in 16 bits: rounded up, by at most a sixteenth.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct CoarseSize(u16);

/// What is known of the coordinates that a DOF adds to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CoordinateSizes {
    /// The largest of them.
    pub at: CoarseSize,
    /// The largest of the nodes that they belong to, along any axis; something if there is a node, wherever it lies.
    pub node: CoarseSize,
}

/// The bits of a double that a size does not keep.
const CUT: u32 = 48;

impl CoarseSize {
    /// Of a number that is not NaN.
    #[inline]
    pub fn above(x: f64) -> Self {
        let largest = (f64::MAX.to_bits() >> CUT) as u16;
        Self(if x == 0.0 { 0 } else { ((x.abs().to_bits() >> CUT) as u16 + 1).min(largest) })
    }

    /// Of the least number that there is, for one that is zero.
    pub fn of_something(x: f64) -> Self {
        Self::above(x).max(Self(1))
    }

    pub fn is_something(self) -> bool {
        self.0 > 0
    }

    pub fn number(self) -> f64 {
        f64::from_bits(u64::from(self.0) << CUT)
    }
}

/// The configuration, each DOF with what is not known of it.
pub struct UncertainDofs<'a> {
    pub u: &'a [f64],
    /// The largest coordinate that each DOF adds to; shorter if the others add to none.
    pub sizes: &'a [CoordinateSizes],
}

impl UncertainDofs<'_> {
    /// One DOF.
    pub fn dof(&self, j: u32) -> Bounded {
        let (u, size) = (self.u[j as usize], self.sizes.get(j as usize).copied().unwrap_or_default());
        Bounded::known_to(u, u.abs() + size.at.number())
    }
}

/// The bound, or infinity where the arithmetic of bounds has none.
///
/// Twice that of [`crate::Nonlinear::value`]: a Jacobian written by hand has the same terms in another order.
pub fn bound(of: Bounded) -> f64 {
    if of.error.is_nan() { f64::INFINITY } else { 2.0 * of.error }
}

/// Coordinates of a segment that no more are put behind, but for those of one constraint.
const LONG: usize = 1 << 16;

/// A DOF that adds to a coordinate.
#[derive(Clone, Copy)]
pub struct DofCoordinate {
    dof: u32,
    sizes: CoordinateSizes,
}

impl DofCoordinate {
    /// `node`: the largest coordinate of the node; along an axis where it has none, it is no smaller a model.
    #[inline]
    pub fn new(dof: usize, at: f64, node: CoarseSize) -> Self {
        Self { dof: dof as u32, sizes: CoordinateSizes { at: CoarseSize::above(at), node } }
    }
}

/// What constraints state that follow one another.
#[derive(Default)]
pub struct CoordinateList {
    pub all: Vec<DofCoordinate>,
    /// Where those of each end.
    end: Vec<u32>,
}

impl CoordinateList {
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
struct CoordinateSpan {
    segment: u32,
    first: u32,
    end: u32,
}

/// By constraint, and the largest by DOF, which are looked for when they are asked for: a constraint that goes takes its own along.
#[derive(Default)]
pub struct ReferenceCoordinates {
    /// Of all constraints, with those of some that are gone.
    segments: Vec<Vec<DofCoordinate>>,
    of: Vec<CoordinateSpan>,
    there: usize,
    gone: usize,
    largest: OnceLock<Vec<CoordinateSizes>>,
}

impl ReferenceCoordinates {
    /// Takes over what a constraint without any states.
    pub fn put(&mut self, constraint: u32, coordinates: &mut Vec<DofCoordinate>) {
        if coordinates.is_empty() {
            return;
        }
        if let Some(largest) = self.largest.get_mut() {
            coordinates.iter().for_each(|&coordinate| enter(coordinate, largest));
        }
        let place = constraint as usize;
        if self.of.len() <= place {
            self.of.resize(place + 1, CoordinateSpan::default());
        }
        self.there += coordinates.len();
        self.of[place] = append(&mut self.segments, coordinates);
        coordinates.clear();
    }

    /// Takes over what constraints state from this one on, which come after all others; how many these are.
    pub fn join(&mut self, constraint: u32, new: CoordinateList) -> u32 {
        if !new.all.is_empty() {
            let (segment, mut first) = (self.segments.len() as u32, 0);
            self.of.resize(constraint as usize, CoordinateSpan::default());
            let spans =
                new.end.iter().map(|&end| CoordinateSpan { segment, first: std::mem::replace(&mut first, end), end });
            self.of.extend(spans);
            self.there += new.all.len();
            self.segments.push(new.all);
            self.largest.take();
        }
        new.end.len() as u32
    }

    pub fn take(&mut self, constraint: u32) -> Vec<DofCoordinate> {
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
    pub fn largest(&self) -> &[CoordinateSizes] {
        self.largest.get_or_init(|| {
            let mut largest = Vec::new();
            let all = self.of.iter().flat_map(|&span| within(&self.segments, span));
            all.for_each(|&coordinate| enter(coordinate, &mut largest));
            largest
        })
    }
}

/// Puts coordinates of one constraint behind the others.
fn append(segments: &mut Vec<Vec<DofCoordinate>>, coordinates: &[DofCoordinate]) -> CoordinateSpan {
    if coordinates.is_empty() {
        return CoordinateSpan::default();
    }
    if segments.last().is_none_or(|last| last.len() >= LONG) {
        segments.push(Vec::new());
    }
    let segment = segments.len() - 1;
    let first = segments[segment].len() as u32;
    segments[segment].extend_from_slice(coordinates);
    CoordinateSpan { segment: segment as u32, first, end: first + coordinates.len() as u32 }
}

/// None if there is no segment.
fn within(segments: &[Vec<DofCoordinate>], CoordinateSpan { segment, first, end }: CoordinateSpan) -> &[DofCoordinate] {
    segments.get(segment as usize).map_or(&[], |all| &all[first as usize..end as usize])
}

fn enter(DofCoordinate { dof, sizes }: DofCoordinate, largest: &mut Vec<CoordinateSizes>) {
    let dof = dof as usize;
    if largest.len() <= dof {
        largest.resize(dof + 1, CoordinateSizes::default());
    }
    let known = &mut largest[dof];
    *known = CoordinateSizes { at: known.at.max(sizes.at), node: known.node.max(sizes.node) };
}

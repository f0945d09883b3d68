//! Reference coordinates of DOFs, `x = at + u`: their magnitudes bound how well a DOF is known, for the analysis of rounding errors.
//!
//! Constraint types report the coordinates of their nodes, since they often store coordinate differences only.

use std::sync::OnceLock;

use crate::scalar::Bounded;

/// The magnitude of a number in 16 bits, rounded up by at most 1/16.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct CoarseSize(u16);

/// Magnitudes of the reference coordinates that a DOF adds to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CoordinateSizes {
    /// Largest of these coordinates.
    pub at: CoarseSize,
    /// Largest coordinate, along any axis, of the nodes that the DOF moves. It is not zero if there is such a node, even at the origin.
    pub node: CoarseSize,
}

/// Low bits of a double that are dropped.
const CUT: u32 = 48;

impl CoarseSize {
    /// Rounds up. `x` must not be NaN.
    #[inline]
    pub fn above(x: f64) -> Self {
        let largest = (f64::MAX.to_bits() >> CUT) as u16;
        Self(if x == 0.0 { 0 } else { ((x.abs().to_bits() >> CUT) as u16 + 1).min(largest) })
    }

    /// Like [`CoarseSize::above`], but the smallest nonzero magnitude for zero.
    pub fn above_zero(x: f64) -> Self {
        Self::above(x).max(Self(1))
    }

    pub fn is_nonzero(self) -> bool {
        self.0 > 0
    }

    pub fn number(self) -> f64 {
        f64::from_bits(u64::from(self.0) << CUT)
    }
}

/// DOF values together with their uncertainty.
pub struct UncertainDofs<'a> {
    pub u: &'a [f64],
    /// Coordinate magnitudes by DOF; DOFs beyond the end have none.
    pub sizes: &'a [CoordinateSizes],
}

impl UncertainDofs<'_> {
    /// The value of DOF j with its error bound.
    pub fn dof(&self, j: u32) -> Bounded {
        let (u, size) = (self.u[j as usize], self.sizes.get(j as usize).copied().unwrap_or_default());
        Bounded::known_to(u, u.abs() + size.at.number())
    }
}

/// The error bound of a computed number; infinite if it is NaN.
///
/// The bound is doubled, because a Jacobian written by hand sums the same terms in another order than [`crate::Nonlinear::value`].
pub fn bound(x: Bounded) -> f64 {
    if x.error.is_nan() { f64::INFINITY } else { 2.0 * x.error }
}

/// Arrays of at least this many coordinates are closed: the next constraint starts another array.
const LONG: usize = 1 << 16;

/// A reference coordinate of a DOF.
#[derive(Clone, Copy)]
pub struct DofCoordinate {
    dof: u32,
    sizes: CoordinateSizes,
}

impl DofCoordinate {
    /// `node` is the largest coordinate of the node: it measures the model also along axes where the node's coordinate is zero.
    #[inline]
    pub fn new(dof: usize, at: f64, node: CoarseSize) -> Self {
        Self { dof: dof as u32, sizes: CoordinateSizes { at: CoarseSize::above(at), node } }
    }
}

/// Coordinates of consecutive constraints.
#[derive(Default)]
pub struct CoordinateList {
    pub all: Vec<DofCoordinate>,
    /// End of each constraint's coordinates.
    end: Vec<u32>,
}

impl CoordinateList {
    /// Ends the coordinates of the current constraint, one of `expected` in total.
    pub fn close(&mut self, expected: usize) {
        if self.end.is_empty() {
            self.end.reserve_exact(expected);
            self.all.reserve_exact(self.all.len() * (expected - 1));
        }
        self.end.push(self.all.len() as u32);
    }
}

/// Location of one constraint's coordinates.
#[derive(Clone, Copy, Default)]
struct CoordinateSpan {
    segment: u32,
    first: u32,
    end: u32,
}

/// Coordinates by constraint. The largest magnitude by DOF is computed on request, since it changes when constraints are removed.
#[derive(Default)]
pub struct ReferenceCoordinates {
    /// Coordinates of all constraints, including some that were removed.
    segments: Vec<Vec<DofCoordinate>>,
    spans: Vec<CoordinateSpan>,
    there: usize,
    gone: usize,
    largest: OnceLock<Vec<CoordinateSizes>>,
}

impl ReferenceCoordinates {
    /// Stores the coordinates of a constraint that has none yet, and empties the list.
    pub fn put(&mut self, constraint: u32, coordinates: &mut Vec<DofCoordinate>) {
        if coordinates.is_empty() {
            return;
        }
        if let Some(largest) = self.largest.get_mut() {
            coordinates.iter().for_each(|&coordinate| enter(coordinate, largest));
        }
        let place = constraint as usize;
        if self.spans.len() <= place {
            self.spans.resize(place + 1, CoordinateSpan::default());
        }
        self.there += coordinates.len();
        self.spans[place] = append(&mut self.segments, coordinates);
        coordinates.clear();
    }

    /// Appends the coordinates of new constraints, the first of which is `constraint`. Returns how many constraints these are.
    pub fn join(&mut self, constraint: u32, new: CoordinateList) -> u32 {
        if !new.all.is_empty() {
            let (segment, mut first) = (self.segments.len() as u32, 0);
            self.spans.resize(constraint as usize, CoordinateSpan::default());
            let spans =
                new.end.iter().map(|&end| CoordinateSpan { segment, first: std::mem::replace(&mut first, end), end });
            self.spans.extend(spans);
            self.there += new.all.len();
            self.segments.push(new.all);
            self.largest.take();
        }
        new.end.len() as u32
    }

    pub fn take(&mut self, constraint: u32) -> Vec<DofCoordinate> {
        let span = self.spans.get_mut(constraint as usize).map(std::mem::take).unwrap_or_default();
        let taken = within(&self.segments, span).to_vec();
        if !taken.is_empty() {
            self.largest.take();
            self.there -= taken.len();
            self.gone += taken.len();
            self.close_gaps();
        }
        taken
    }

    /// Compacts the arrays when more than half of the coordinates belong to removed constraints.
    fn close_gaps(&mut self) {
        if self.gone <= self.there {
            return;
        }
        let mut segments = Vec::new();
        for span in &mut self.spans {
            *span = append(&mut segments, within(&self.segments, *span));
        }
        (self.segments, self.gone) = (segments, 0);
    }

    /// Largest magnitudes by DOF; DOFs beyond the end have none.
    pub fn largest(&self) -> &[CoordinateSizes] {
        self.largest.get_or_init(|| {
            let mut largest = Vec::new();
            let all = self.spans.iter().flat_map(|&span| within(&self.segments, span));
            all.for_each(|&coordinate| enter(coordinate, &mut largest));
            largest
        })
    }
}

/// Appends the coordinates of one constraint.
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

/// The coordinates of a span; empty if its array does not exist.
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

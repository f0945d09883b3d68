//! Geometry of the net: rows of hinged bodies, and rungs of two bodies between neighbouring rows.

use super::joint::{Joint, JointKind};
use super::{Linkage, PER_RUNG};
use crate::Rng;
use crate::families::AXES;

/// Bodies and joints, and the number of redundant equations.
pub(super) struct Net {
    pub(super) centres: Vec<[f64; 3]>,
    pub(super) joints: Vec<Joint>,
    pub(super) redundant: usize,
}

/// Number of steps from one body to the next. Coordinates are whole numbers of steps, so lever arms are exact.
const STEP: usize = 64;
/// Length of a step along an axis of [`AXES`], which have length 3: a body is 1.5 long if `length` is 1.
const UNIT: f64 = 1.0 / 128.0;

impl Net {
    pub(super) fn new(linkage: &Linkage, rng: &mut Rng) -> Self {
        let mut net = Self { centres: Vec::new(), joints: Vec::new(), redundant: 0 };
        for row in 0..linkage.rows {
            for column in 0..linkage.columns {
                net.centres.push(linkage.place([column, row], [STEP / 2, 0], rng));
                if column > 0 {
                    let last = net.centres.len() - 1;
                    net.join(JointKind::Hinge, [last - 1, last], linkage.place([column, row], [0; 2], rng));
                }
            }
        }
        for row in 1..linkage.rows {
            for column in (0..linkage.columns).step_by(linkage.pitch) {
                let balls = if column > 0 && linkage.balls { rng.below(3) } else { 0 };
                net.add_rung(linkage, [column, row - 1], balls, rng);
            }
        }
        net
    }

    /// Adds two bodies and three joints between a body and the one above it; `balls` of the joints are ball joints.
    fn add_rung(&mut self, linkage: &Linkage, [column, row]: [usize; 2], balls: usize, rng: &mut Rng) {
        let lower = self.centres.len();
        let ends = [row, row + 1].map(|row| column + linkage.columns * row);
        let mut next = |along: usize, up: usize| linkage.place([column, row], [along, up], rng);
        self.centres.extend([next(STEP * 3 / 4, STEP / 4), next(STEP * 3 / 4, STEP * 3 / 4)]);
        let kind = |ball: bool| if ball { JointKind::Ball } else { JointKind::Hinge };
        self.join(kind(balls > 1), [ends[0], lower], next(STEP / 2, 0));
        self.join(kind(balls > 0), [lower, lower + 1], next(STEP, STEP / 2));
        self.join(JointKind::Hinge, [lower + 1, ends[1]], next(STEP / 2, STEP));
        // The first rung of a row closes no loop.
        self.redundant += if column > 0 { [3, 1, 0][balls] } else { 0 };
    }

    fn join(&mut self, kind: JointKind, bodies: [usize; 2], at: [f64; 3]) {
        self.joints.push(Joint { kind, bodies, at });
    }
}

impl Linkage {
    /// Number of rungs between two neighbouring rows.
    pub(super) fn rungs(&self) -> usize {
        self.columns.div_ceil(self.pitch.max(1))
    }

    /// Number of bodies.
    pub fn bodies(&self) -> usize {
        let rungs = self.rungs().saturating_mul(PER_RUNG).saturating_mul(self.rows.saturating_sub(1));
        self.rows.saturating_mul(self.columns).saturating_add(rungs)
    }

    /// Number of loops that rungs close.
    pub fn loops(&self) -> usize {
        self.rows.saturating_sub(1).saturating_mul(self.rungs().saturating_sub(1))
    }

    /// A point of the net, moved by up to an eighth of a body in each direction.
    fn place(&self, cell: [usize; 2], within: [usize; 2], rng: &mut Rng) -> [f64; 3] {
        let mut moved = || rng.below(STEP / 4 + 1) as f64 - (STEP / 8) as f64;
        let unit = self.length as f64 * UNIT;
        let [along, up] = [0, 1].map(|k| unit * ((STEP * cell[k] + within[k]) as f64 + moved()));
        let across = unit * moved();
        std::array::from_fn(|k| along * AXES[0][k] + up * AXES[1][k] + across * AXES[2][k])
    }
}

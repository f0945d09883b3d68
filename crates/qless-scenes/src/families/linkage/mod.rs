//! Hinges and ball joints of rigid bodies, `C (u, theta) = 0` for small displacements and rotations: one plane mechanism in space.

mod joint;
mod net;

use qless::SystemBuilder;

use super::MOST;
use crate::error::within;
use crate::{Rng, Scene, SceneError, Truth};
use net::Net;

/// A net of rigid bodies with six DOFs each, `u_x, u_y, u_z, theta_x, theta_y, theta_z`, that moves as a whole.
///
/// Rows of `columns` bodies, each hinged to the next, are tied to one another by rungs of two bodies with three joints. Rungs
/// stand at every `pitch`-th body. All hinges have parallel axes, across a plane that is askew in space, and coordinates are whole
/// numbers, so that everything is exact. A hinge has five equations, a ball joint three.
///
/// Rows and the first rungs are a tree: no equation depends on others. Each other rung closes a loop. Its three hinges are
/// not in line, so they let its ends move against each other as they like in the plane; across it the loop is tied already, so
/// that three equations are redundant. A ball joint at the elbow lets go of two of them; another at the foot of all three.
/// With `balls` the seed gives each of these rungs none, one or two; otherwise `3 loops` equations are redundant.
///
/// ```
/// use qless_scenes::families::Linkage;
/// let net = Linkage { rows: 3, columns: 4, pitch: 1, length: 1, balls: false };
/// assert_eq!((net.bodies(), net.loops()), (12 + 2 * 2 * 4, 6));
/// let scene = net.scene(1)?;
/// assert_eq!((scene.system.equations(), scene.truth.redundant), (5 * (28 - 1 + 6), Some(18)));
/// # Ok::<(), qless_scenes::SceneError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Linkage {
    /// Rows of bodies; one row is an open chain.
    pub rows: usize,
    /// Bodies per row.
    pub columns: usize,
    /// Bodies from one rung to the next; two rows with `columns - 1` are one ring.
    pub pitch: usize,
    /// Bodies are about so long. Where lengths are counted in a small unit, such as millimetres, rotations weigh more than
    /// displacements, and equations look more alike.
    pub length: usize,
    /// Whether rungs that close a loop have ball joints.
    pub balls: bool,
}

/// Bodies of a rung.
const PER_RUNG: usize = 2;

impl Linkage {
    /// A square net of at most so many bodies, with a rung at each body of a row: `3 n^2 - 2 n` of them.
    pub fn with_bodies(bodies: usize, balls: bool) -> Self {
        let side = (1 + bodies.saturating_mul(3).saturating_add(1).isqrt()) / 3;
        Self { rows: side, columns: side, pitch: 1, length: 1, balls }
    }

    /// The equations joint by joint: rows first, then rungs.
    ///
    /// # Errors
    /// [`SceneError::Size`] for a number that is zero or too large, or fewer than two bodies.
    pub fn scene(&self, seed: u64) -> Result<Scene, SceneError> {
        for (what, n) in [("rows", self.rows), ("columns", self.columns), ("pitch", self.pitch)] {
            within(what, n, 1, MOST / 64)?;
        }
        within("length", self.length, 1, 1 << 20)?;
        within("the number of bodies", self.bodies(), 2, MOST / 64)?;
        let net = Net::new(self, &mut Rng::new(seed));
        let mut builder = SystemBuilder::new(6 * net.centres.len());
        let mut equations = 0;
        for (k, joint) in net.joints.iter().enumerate() {
            for (part, terms) in joint.equations(&net.centres) {
                builder.labelled_equation(format!("joint {}, {part}", k + 1), terms, 0.0);
                equations += 1;
            }
        }
        builder.dof_labels(names(net.centres.len()));
        let truth = Truth::independent(equations).with_redundant(net.redundant).without_generated(true);
        Ok(Scene { nodes: net.centres, ..Scene::bare(builder, truth)? })
    }
}

fn names(bodies: usize) -> Vec<String> {
    (1..=bodies).flat_map(|body| ["x", "y", "z", "rx", "ry", "rz"].map(|c| format!("body {body}:{c}"))).collect()
}

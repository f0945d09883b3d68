//! A plane mechanism in space: rigid bodies with hinges and ball joints, `C (u, theta) = 0` for small displacements and rotations.

mod joint;
mod net;

use qless::SystemBuilder;

use super::MOST;
use crate::error::within;
use crate::{Rng, Scene, SceneError, Truth};
use net::Net;

/// A connected net of rigid bodies with six DOFs each, `u_x, u_y, u_z, theta_x, theta_y, theta_z`.
///
/// Each row has `columns` bodies, hinged to their neighbours. Rungs of two bodies and three joints connect neighbouring rows at
/// every `pitch`-th body. The axes of all hinges are parallel, normal to a plane that is inclined to x, y and z. Coordinates are whole
/// numbers, so all coefficients are exact. A hinge has five equations, a ball joint three.
///
/// The rows and the first rungs form a tree of independent equations. Each other rung closes a loop. The three hinges of a rung are not
/// collinear, so within the plane its ends can still move relative to each other. The tree already prevents relative motion of its ends out
/// of the plane, so three equations are redundant. A ball joint in the middle of the rung removes two of these three, and a second ball
/// joint at its lower end removes the third. With `balls` the seed chooses none, one or two ball joints for each of these rungs; otherwise
/// `3 loops` equations are redundant.
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
    /// Bodies from one rung to the next; two rows with a pitch of `columns - 1` form a ring.
    pub pitch: usize,
    /// Approximate length of a body. In a small unit such as millimetres, coefficients of rotations exceed those of displacements,
    /// and the equations are nearer to dependence.
    pub length: usize,
    /// Whether rungs that close a loop may have ball joints.
    pub balls: bool,
}

/// Number of bodies in a rung.
const PER_RUNG: usize = 2;

impl Linkage {
    /// A square net of at most `bodies` bodies, with a rung at each body of a row: `3 n^2 - 2 n` bodies for n rows.
    pub fn with_bodies(bodies: usize, balls: bool) -> Self {
        let side = (1 + bodies.saturating_mul(3).saturating_add(1).isqrt()) / 3;
        Self { rows: side, columns: side, pitch: 1, length: 1, balls }
    }

    /// The equations, joint by joint: first the hinges between bodies of a row, then the joints of the rungs.
    ///
    /// # Errors
    /// [`SceneError::Size`] if a number is zero or too large, or for fewer than two bodies.
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

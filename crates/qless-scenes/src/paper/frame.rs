//! `u1 = u2 = u3 = u4`: Figure 2, the first floor of a frame moves as one in X.

use qless::SystemBuilder;

use super::equations::names;
use crate::{Component, Dof, Scene, SceneError, Truth};

/// How the three equations are written; all say the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FloorInput {
    /// u1 - u2, u1 - u3, u1 - u4: every equation starts with u1, so one that takes the first DOF as its slave fails.
    Star,
    /// u1 - u2, u2 - u3, u3 - u4: each slave but the first was a master before.
    Chain,
    /// u1 - u4, u2 - u4, u3 - u4: the form that such programs accept.
    Accepted,
}

/// Figure 2: equal X displacement of the four corners of a frame's first floor, 3 independent equations.
///
/// # Errors
/// None in practice.
pub fn figure_2(input: FloorInput) -> Result<Scene, SceneError> {
    let pairs = match input {
        FloorInput::Star => [(0, 1), (0, 2), (0, 3)],
        FloorInput::Chain => [(0, 1), (1, 2), (2, 3)],
        FloorInput::Accepted => [(0, 3), (1, 3), (2, 3)],
    };
    let mut builder = SystemBuilder::new(4);
    for (a, b) in pairs {
        builder.labelled_equation(format!("u{} - u{} = 0", a + 1, b + 1), [(a, 1.0), (b, -1.0)], 0.0);
    }
    builder.dof_labels(names(4));
    let nodes = vec![[0.0, 0.0, 3.0], [6.0, 0.0, 3.0], [6.0, 6.0, 3.0], [0.0, 6.0, 3.0]];
    let dofs = (0..4).map(|node| Dof { node, component: Component::X }).collect();
    let truth = Truth::independent(3).without_generated(true);
    Ok(Scene { system: builder.build()?, truth, nodes, dofs })
}

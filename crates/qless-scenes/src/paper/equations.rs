//! Equations (12)-(14) and Figures 2, 5 and 6 of the paper.

use qless::SystemBuilder;

use crate::{Component, Dof, Scene, SceneError, Truth};

/// Equations (12)-(14), of rank 2:
///
/// ```text
/// (12)   u1 -   u2 + 2 u3 = 1
/// (13)   u1 + 2 u2 -   u3 = 0
/// (14) 2 u1 +   u2 +   u3 = rhs
/// ```
///
/// The paper prints (13) as `u1 - 2 u2 - u3 = 0`, but then the rank is 3; its (16) and (17) need the sign above.
/// (14) = (12) + (13): redundant for rhs = 1, conflicting for any other value (0 in the paper's Figure 3b).
///
/// # Errors
/// [`SceneError::System`] for a right-hand side that is not finite.
pub fn equations_12_to_14(rhs: f64) -> Result<Scene, SceneError> {
    Scene::bare(three_equations(rhs), Truth::rank(3, 2).with_conflict(rhs != 1.0).without_generated(rhs == 1.0))
}

/// Three equivalent forms of the equations of Figure 2.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FloorInput {
    /// u1 - u2, u1 - u3, u1 - u4: programs that take the first DOF of each equation as its slave fail.
    Star,
    /// u1 - u2, u2 - u3, u3 - u4: each slave except the first is a master of the equation before.
    Chain,
    /// u1 - u4, u2 - u4, u3 - u4: accepted by programs that take the first DOF of each equation as its slave.
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

/// Figure 5: equations (12)-(14) with rhs 1 and u2 prescribed; u1 = 1/3 - u2 and u3 = 1/3 + u2 are then fixed.
///
/// # Errors
/// [`SceneError::System`] for a value that is not finite.
pub fn figure_5(u2: f64) -> Result<Scene, SceneError> {
    let mut builder = three_equations(1.0);
    builder.prescribe(1, u2);
    let generated = Some(vec![(0, 1.0 / 3.0 - u2), (2, 1.0 / 3.0 + u2)]);
    Scene::bare(builder, Truth { generated, ..Truth::rank(3, 2) })
}

/// Figure 6: u4 is prescribed, which fixes u3 and u5 (generated boundary conditions) but not u1 and u2.
///
/// ```text
/// u1 - u2 + u3 - u4 = 0
/// u1 - u2 - u3 + u4 = 0      so u3 = u4
/// u3 + u4 - u5      = 0      so u5 = 2 u4
/// u1 - u6           = 0
/// ```
///
/// The paper states the outcome but not the coefficients; these are ours.
///
/// # Errors
/// [`SceneError::System`] for a value that is not finite.
pub fn figure_6(u4: f64) -> Result<Scene, SceneError> {
    let mut builder = SystemBuilder::new(6);
    builder.equation([(0, 1.0), (1, -1.0), (2, 1.0), (3, -1.0)], 0.0);
    builder.equation([(0, 1.0), (1, -1.0), (2, -1.0), (3, 1.0)], 0.0);
    builder.equation([(2, 1.0), (3, 1.0), (4, -1.0)], 0.0);
    builder.equation([(0, 1.0), (5, -1.0)], 0.0);
    builder.prescribe(3, u4);
    builder.dof_labels(names(6));
    let generated = Some(vec![(2, u4), (4, 2.0 * u4)]);
    Scene::bare(builder, Truth { generated, ..Truth::independent(4) })
}

fn three_equations(rhs: f64) -> SystemBuilder {
    let mut builder = SystemBuilder::new(3);
    builder.labelled_equation("Eq. 12", [(0, 1.0), (1, -1.0), (2, 2.0)], 1.0);
    builder.labelled_equation("Eq. 13", [(0, 1.0), (1, 2.0), (2, -1.0)], 0.0);
    builder.labelled_equation("Eq. 14", [(0, 2.0), (1, 1.0), (2, 1.0)], rhs);
    builder.dof_labels(names(3));
    builder
}

/// The names u1, u2, ... of `count` DOFs.
fn names(count: usize) -> Vec<String> {
    (1..=count).map(|j| format!("u{j}")).collect()
}

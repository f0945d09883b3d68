//! Periodicity of a cube of size L, `u(x + L e_d) - u(x) - E_d = 0` for all nodes of all three pairs of faces; E_d are DOFs too.

use qless::SystemBuilder;

use super::MOST;
use crate::error::within;
use crate::{Component, Dof, Scene, SceneError, Truth};

/// A cubic cell with n elements per side and nine macroscopic displacement differences `E_d` as DOFs.
///
/// Each component has 3 (n + 1)^2 equations of rank (n + 1)^3 - n^3. Edges and corners are tied more than once, so 3 n + 2
/// equations are redundant. The nodes are those of the surface and, last, one for each `E_d`.
///
/// # Errors
/// [`SceneError::Size`] for n = 0.
pub fn rve(n: usize) -> Result<Scene, SceneError> {
    within("n", n, 1, MOST.isqrt() / 16)?;
    let surface = RveSurface::new(n);
    let mut builder = SystemBuilder::new(3 * surface.nodes.len());
    for axis in 0..3 {
        for (a, b) in (0..=n).flat_map(|a| (0..=n).map(move |b| (a, b))) {
            let at = |along: usize| std::array::from_fn(|d| [along, a, b][(d + 3 - axis) % 3]);
            let (near, far, jump) = (surface.number(at(0)), surface.number(at(n)), surface.nodes.len() - 3 + axis);
            for c in Component::SPACE {
                let dof = |node: usize| 3 * node + c as usize;
                let label = format!("periodic {}, node ({a},{b}), {}", Component::SPACE[axis].letter(), c.letter());
                builder.labelled_equation(label, [(dof(far), 1.0), (dof(near), -1.0), (dof(jump), -1.0)], 0.0);
            }
        }
    }
    let dofs = Dof::of_nodes(surface.nodes.len(), 3);
    let truth = Truth::rank(9 * (n + 1).pow(2), 3 * ((n + 1).pow(3) - n.pow(3))).without_generated(true);
    Ok(Scene { system: builder.build()?, truth, nodes: surface.nodes, dofs })
}

/// The nodes on the surface of the cube with n elements per side, and their numbers.
struct RveSurface {
    n: usize,
    number: Vec<usize>,
    nodes: Vec<[f64; 3]>,
}

impl RveSurface {
    fn new(n: usize) -> Self {
        let mut surface = Self { n, number: vec![usize::MAX; (n + 1).pow(3)], nodes: Vec::new() };
        for k in 0..(n + 1).pow(3) {
            let place = [k % (n + 1), k / (n + 1) % (n + 1), k / (n + 1).pow(2)];
            if place.iter().any(|&i| i == 0 || i == n) {
                surface.number[k] = surface.nodes.len();
                surface.nodes.push(place.map(|i| i as f64 / n as f64));
            }
        }
        surface.nodes.extend([[2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 2.0]]);
        surface
    }

    fn number(&self, [i, j, k]: [usize; 3]) -> usize {
        self.number[i + (self.n + 1) * (j + (self.n + 1) * k)]
    }
}

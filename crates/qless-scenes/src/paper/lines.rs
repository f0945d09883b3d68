//! Figures 1 and 8: ties `u_a - u_b = 0` along four lines that meet in a point.
//!
//! Four bodies, one in each quadrant, meet at a corner. Along each of the four lines between them the nodes of two bodies
//! are tied pair by pair. Each line ends at the corner, where the four corner nodes are tied in a ring: four equations, of
//! which three suffice.

use qless::SystemBuilder;

use crate::{Component, Dof, Scene, SceneError, Truth};

/// A pair of tied nodes of two bodies at the same point.
struct PaperLinePair {
    /// Scene DOFs (and nodes) of the pair.
    dofs: [usize; 2],
    at: [f64; 2],
}

/// Figure 1: 8 equations on one component of nodes D, F, I, L in the middle and 8 nodes outside.
///
/// D-F, F-L, L-I and I-D are a ring: one of the four equations is redundant. C is prescribed as 0 and H as `h`. The tie of
/// C and H is therefore redundant for h = 0 and conflicting otherwise. The paper names the nodes above; the other letters are ours.
///
/// # Errors
/// [`SceneError::System`] for a value that is not finite.
pub fn figure_1(h: f64) -> Result<Scene, SceneError> {
    let names = ["B", "E", "G", "M", "K", "J", "H", "C", "D", "F", "L", "I"];
    let mut scene = PaperLines::new(1);
    scene.builder.prescribe(7, 0.0);
    scene.builder.prescribe(6, h);
    scene.builder.dof_labels(names.map(|name| format!("{name}:y")).into());
    let truth = Truth::rank(8, 6).with_conflict(h != 0.0).without_generated(h == 0.0);
    scene.finish(|[a, b]| format!("tie {}-{}", names[a], names[b]), truth)
}

/// Figure 8: 16 equations from four line-to-line ties, u1 and u213 prescribed as 0; the 1st and the 16th are redundant.
///
/// The first ties u1 to u213, the last closes the ring in the middle. The paper names these two DOFs; the other numbers are
/// ours.
///
/// # Errors
/// None in practice.
pub fn figure_8() -> Result<Scene, SceneError> {
    let mut scene = PaperLines::new(3);
    let names: Vec<String> = (0..28).map(|j| format!("u{}", [1, 213, 2][j.min(2)] + j.saturating_sub(2))).collect();
    scene.builder.prescribe(0, 0.0);
    scene.builder.prescribe(1, 0.0);
    scene.builder.dof_labels(names.clone());
    let truth = Truth::rank(16, 14).without_generated(true);
    scene.finish(|[a, b]| format!("tie {} - {}", names[a], names[b]), truth)
}

/// Four lines of pairs. DOFs 2k and 2k + 1 are the k-th pair, line by line from outside; the last four are the corner nodes.
struct PaperLines {
    builder: SystemBuilder,
    pairs: Vec<PaperLinePair>,
    dofs: usize,
}

impl PaperLines {
    fn new(outer: usize) -> Self {
        let directions = [[0.0, 1.0], [1.0, 0.0], [0.0, -1.0], [-1.0, 0.0]];
        let mut pairs = Vec::new();
        let middle = 8 * outer;
        for (line, [x, y]) in directions.into_iter().enumerate() {
            for k in 0..outer {
                let first = 2 * (line * outer + k);
                let distance = (outer - k) as f64;
                pairs.push(PaperLinePair { dofs: [first, first + 1], at: [x * distance, y * distance] });
            }
            pairs.push(PaperLinePair { dofs: [middle + line, middle + (line + 1) % 4], at: [0.0; 2] });
        }
        Self { builder: SystemBuilder::new(middle + 4), pairs, dofs: middle + 4 }
    }

    fn finish(mut self, label: impl Fn([usize; 2]) -> String, truth: Truth) -> Result<Scene, SceneError> {
        let mut nodes = vec![[0.0; 3]; self.dofs];
        for pair in &self.pairs {
            let [a, b] = pair.dofs;
            self.builder.labelled_equation(label(pair.dofs), [(a, 1.0), (b, -1.0)], 0.0);
            pair.dofs.iter().for_each(|&node| nodes[node] = [pair.at[0], pair.at[1], 0.0]);
        }
        let dofs = (0..self.dofs).map(|node| Dof { node, component: Component::Y }).collect();
        Ok(Scene { system: self.builder.build()?, truth, nodes, dofs })
    }
}

//! Rigid spiders: nodes that follow masters with six DOFs, `u_i - (U + theta x r_i) = 0`.

use qless::SystemBuilder;

use super::MOST;
use crate::error::within;
use crate::{Component, Rng, Scene, SceneError, Truth};

/// k nodes, tied to each of one or two masters by 3 equations.
///
/// Coordinates are whole numbers of at most 500, so coefficients are exact; the nodes are not collinear. With one master
/// the 3 k equations are independent. With two masters only the six rigid motions of all nodes and both masters remain:
/// rank 3 k + 12 - 6. The scene has nodes (the masters last), but `dofs` is empty because a rotation is no [`Component`].
///
/// ```
/// use qless_scenes::{families::rbe2, oracle};
/// let scene = rbe2(20, 2, 1)?;
/// assert_eq!(oracle::rank_free(&scene.system)?, 66);
/// # Ok::<(), qless_scenes::SceneError>(())
/// ```
///
/// # Errors
/// [`SceneError::Size`] for fewer than 3 nodes or other than 1 or 2 masters.
pub fn rbe2(k: usize, masters: usize, seed: u64) -> Result<Scene, SceneError> {
    within("k", k, 3, MOST)?;
    within("masters", masters, 1, 2)?;
    let places = places(k + masters, &mut Rng::new(seed));
    let mut builder = SystemBuilder::new(3 * k + 6 * masters);
    for master in 0..masters {
        for leg in 0..k {
            let arm: [f64; 3] = std::array::from_fn(|axis| places[leg][axis] - places[k + master][axis]);
            for axis in 0..3 {
                let letter = Component::SPACE[axis].letter();
                let label = format!("rigid spider {}, node {}, {letter}", master + 1, leg + 1);
                builder.labelled_equation(label, row(3 * leg, 3 * k + 6 * master, axis, arm), 0.0);
            }
        }
    }
    builder.dof_labels(names(k, masters));
    let rank = if masters == 1 { 3 * k } else { 3 * k + 6 };
    let scene = Scene::bare(builder, Truth::rank(3 * k * masters, rank).without_generated(true))?;
    Ok(Scene { nodes: places, ..scene })
}

/// `u - U - theta x r` along one axis: `(theta x r)_x = theta_y r_z - theta_z r_y`, cyclically.
fn row(leg: usize, master: usize, axis: usize, r: [f64; 3]) -> [(usize, f64); 4] {
    let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
    [(leg + axis, 1.0), (master + axis, -1.0), (master + 3 + next, -r[last]), (master + 3 + last, r[next])]
}

/// Whole coordinates; the first three places are not collinear.
fn places(count: usize, rng: &mut Rng) -> Vec<[f64; 3]> {
    let mut places: Vec<[f64; 3]> =
        (0..count).map(|_| std::array::from_fn(|_| rng.below(1001) as f64 - 500.0)).collect();
    places[..3].copy_from_slice(&[[500.0, 0.0, 0.0], [0.0, 500.0, 0.0], [0.0, 0.0, 500.0]]);
    places
}

fn names(k: usize, masters: usize) -> Vec<String> {
    let legs = (1..=k).flat_map(|leg| ["x", "y", "z"].map(|c| format!("node {leg}:{c}")));
    let heads = (1..=masters).flat_map(|m| ["x", "y", "z", "rx", "ry", "rz"].map(|c| format!("master {m}:{c}")));
    legs.chain(heads).collect()
}

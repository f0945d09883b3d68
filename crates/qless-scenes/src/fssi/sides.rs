//! Ties `u_near - sum_k N_k u_far,k = 0` of each near-field side node to the far-field cell around it.

use super::model::{FssiMesh, FssiModel};
use crate::Component;

/// Adds 3 equations per node of each face; nodes of edges get the same equations from both faces.
pub(super) fn tie(model: &mut FssiModel) {
    let mesh = model.mesh;
    for face in 0..4 {
        for (layer, i) in (0..mesh.layers).flat_map(|layer| (0..mesh.columns).map(move |i| (layer, i))) {
            let node = model.side(face, i, layer);
            let across = weights(i, mesh.columns, mesh.far_columns);
            let down = weights(layer, mesh.layers, mesh.far_layers);
            let masters = down.map(|(l, wz)| across.map(|(k, wx)| (model.far(face, k, l), wx * wz)));
            for component in Component::SPACE {
                let slave = (FssiMesh::Side, node, component, 1.0);
                let masters = masters.as_flattened().iter().map(|&(far, w)| (FssiMesh::Far, far, component, -w));
                let label =
                    format!("tie side face {}, node ({},{}), {}", face + 1, i + 1, layer + 1, component.letter());
                model.equation(label, std::iter::once(slave).chain(masters));
            }
        }
    }
}

/// Linear weights of node i of n, equally spaced, on its two neighbours among m; exactly 0 and 1 at coinciding nodes.
///
/// For i = n - 1 both neighbours are the last of the m nodes, with weights 1 and 0.
fn weights(i: usize, n: usize, m: usize) -> [(usize, f64); 2] {
    let (cell, rest) = (i * (m - 1) / (n - 1), i * (m - 1) % (n - 1));
    let share = rest as f64 / (n - 1) as f64;
    [(cell, 1.0 - share), ((cell + 1).min(m - 1), share)]
}

#[cfg(test)]
mod tests {
    use super::weights;

    #[test]
    fn weights_reproduce_linear_functions() {
        for i in 0..9 {
            let [(a, wa), (b, wb)] = weights(i, 9, 4);
            let (got, expected) = (wa * a as f64 + wb * b as f64, i as f64 * 3.0 / 8.0);
            assert!((wa + wb - 1.0).abs() < 1e-15 && (got - expected).abs() < 1e-15);
        }
        assert_eq!(weights(8, 9, 4), [(3, 1.0), (3, 0.0)]);
    }
}

//! Jacobians of multibody linkages at their reference configuration. Each body has a position x and Euler parameters (e0, e), which are
//! (1, 0) at first. A small change rotates the body by `2 de`; the parameters keep their norm if `de0 = 0`.
//!
//! A closed ring of n hinges and n bodies, one of them the ground, has 7 (n - 1) coordinates and 5 n + (n - 1) equations. Because the
//! hinges are parallel (four-bar) or arranged as by Bricard, it has one degree of freedom. So the rank is 7 (n - 1) - 1, and the other
//! equations are redundant.

use qless::SystemBuilder;
use qless_scenes::{Scene, Truth};

/// A hinge: a point of its axis, and the direction of the axis.
type Hinge = ([f64; 3], [f64; 3]);
type BuiltLinkage = Result<Scene, Box<dyn std::error::Error>>;

/// `count` four-bar linkages with parallel hinges, each with 23 equations of rank 20.
pub fn four_bar(count: usize) -> BuiltLinkage {
    let z = [0.0, 0.0, 1.0];
    rings(count, &[([0.0; 3], z), ([0.25, 1.0, 0.5], z), ([2.0, 1.5, 0.25], z), ([1.75, 0.0, -0.25], z)])
}

/// `count` orthogonal linkages of Bricard, along six edges of a cube, each with 35 equations of rank 34.
pub fn bricard(count: usize) -> BuiltLinkage {
    let at = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [1, 1, 1], [0, 1, 1], [0, 0, 1]];
    // Hinge i turns about an axis that is perpendicular to the edges before and after it.
    let hinge = |i: usize| (at[i].map(f64::from), std::array::from_fn(|k| f64::from(u8::from(k == (i + 1) % 3))));
    rings(count, &[0, 1, 2, 3, 4, 5].map(hinge))
}

fn rings(count: usize, hinges: &[Hinge]) -> BuiltLinkage {
    let bodies = hinges.len() - 1;
    let mut system = SystemBuilder::new(7 * bodies * count);
    for ring in 0..count {
        for i in 0..=bodies {
            let sides = [(i, 1.0), ((i + 1) % (bodies + 1), -1.0)];
            let terms = |row: &dyn Fn(usize) -> Vec<(usize, f64)>| -> Vec<(usize, f64)> {
                let moving = sides.into_iter().filter(|&(body, _)| body > 0);
                let at = |body: usize| 7 * (ring * bodies + body - 1);
                moving
                    .flat_map(|(body, sign)| row(body).into_iter().map(move |(k, v)| (at(body) + k, sign * v)))
                    .collect()
            };
            // The right-hand side is zero: the linkage keeps its position.
            for k in 0..3 {
                system.equation(terms(&|body| point(hinges, body, i, k)), 0.0);
            }
            for normal in normals(hinges[i].1) {
                system.equation(terms(&|_| (0..3).map(|k| (4 + k, 2.0 * normal[k])).collect()), 0.0);
            }
        }
        for body in 0..bodies {
            system.equation([(7 * (ring * bodies + body) + 3, 2.0)], 0.0);
        }
    }
    let rank = count * (7 * bodies - 1);
    let truth = Truth::rank(count * (5 * hinges.len() + bodies), rank);
    Ok(Scene { system: system.build()?, truth, nodes: Vec::new(), dofs: Vec::new() })
}

/// Coordinate k of `dx + 2 de x r` at the point of a hinge; r starts midway between the two hinges of the body.
fn point(hinges: &[Hinge], body: usize, hinge: usize, k: usize) -> Vec<(usize, f64)> {
    let middle = |k: usize| f64::midpoint(hinges[body - 1].0[k], hinges[body].0[k]);
    let r = |k: usize| hinges[hinge].0[k] - middle(k);
    let (next, last) = ((k + 1) % 3, (k + 2) % 3);
    vec![(k, 1.0), (4 + next, 2.0 * r(last)), (4 + last, -2.0 * r(next))]
}

/// Two directions normal to a coordinate axis.
fn normals(axis: [f64; 3]) -> [[f64; 3]; 2] {
    [1, 2].map(|turn| std::array::from_fn(|k| axis[(k + turn) % 3]))
}

#[cfg(test)]
mod tests {
    use qless_scenes::oracle;

    #[test]
    fn linkages_move_in_one_way() {
        for (scene, rank) in [(super::four_bar(2), 40), (super::bricard(2), 68)] {
            let scene = scene.expect("a linkage");
            let values = oracle::singular_values(&scene.system).expect("small");
            let found = values.iter().filter(|&&value| value > 1e-12 * values[0]).count();
            assert_eq!((found, scene.truth.rank_free), (rank, Some(rank)));
        }
    }
}

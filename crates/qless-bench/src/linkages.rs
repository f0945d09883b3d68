//! Jacobians of multibody linkages at their reference configuration; each body has a position and four Euler parameters.
//!
//! A closed ring of n hinges and n bodies, one of them the ground, has 7 (n - 1) coordinates and 5 n + (n - 1) equations. It has one
//! degree of freedom, so the rank is 7 (n - 1) - 1: the other equations are redundant, because hinges are parallel (four-bar) or arranged as by Bricard.

use qless::SystemBuilder;
use qless_constraints::ConstraintSet;
use qless_constraints::types::{Body, EulerNorm, Revolute};
use qless_scenes::{Scene, Truth};

/// A point of the axis, and its direction.
type Hinge = ([f64; 3], [f64; 3]);
type BuiltLinkage = Result<Scene, Box<dyn std::error::Error>>;

/// A number of four-bar linkages with parallel hinges: 23 equations of rank 20 each.
pub fn four_bar(count: usize) -> BuiltLinkage {
    let z = [0.0, 0.0, 1.0];
    rings(count, &[([0.0; 3], z), ([0.25, 1.0, 0.5], z), ([2.0, 1.5, 0.25], z), ([1.75, 0.0, -0.25], z)])
}

/// A number of Bricard's orthogonal linkages, along six edges of a cube: 35 equations of rank 34 each.
pub fn bricard(count: usize) -> BuiltLinkage {
    let at = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [1, 1, 1], [0, 1, 1], [0, 0, 1]];
    // Hinge i turns about an axis that is perpendicular to the edges before and after it.
    let hinge = |i: usize| (at[i].map(f64::from), std::array::from_fn(|k| f64::from(u8::from(k == (i + 1) % 3))));
    rings(count, &[0, 1, 2, 3, 4, 5].map(hinge))
}

fn rings(count: usize, hinges: &[Hinge]) -> BuiltLinkage {
    let coordinates = 7 * (hinges.len() - 1);
    let mut builder = ConstraintSet::builder(count * coordinates);
    for ring in 0..count {
        let body = |i: usize| body(i, hinges, ring * coordinates);
        for (i, &(at, axis)) in hinges.iter().enumerate() {
            builder.add(format!("hinge {}", i + 1), Revolute { a: body(i), b: body(i + 1), at, axis })?;
        }
        for i in 1..hinges.len() {
            let first = ring * coordinates + 7 * (i - 1) + 3;
            let parameters = [first, first + 1, first + 2, first + 3];
            builder.add(format!("body {}", i + 1), EulerNorm { parameters })?;
        }
    }
    let set = builder.build()?;
    let mut quantities = set.allocate();
    set.evaluate(&vec![0.0; set.dofs()], &mut quantities)?;
    let mut system = SystemBuilder::new(set.dofs());
    // The right-hand side is zero: the linkage keeps its position.
    (0..set.equations()).for_each(|row| {
        system.equation(quantities.g().row(row), 0.0);
    });
    let truth = Truth::rank(set.equations(), count * (coordinates - 1));
    Ok(Scene { system: system.build()?, truth, nodes: Vec::new(), dofs: Vec::new() })
}

/// Body i between its two hinges; bodies 0 and n are the ground.
fn body(i: usize, hinges: &[Hinge], first: usize) -> Body {
    if i.is_multiple_of(hinges.len()) {
        return Body::ground();
    }
    let (p, q) = (hinges[i - 1].0, hinges[i].0);
    let at = std::array::from_fn(|k| f64::midpoint(p[k], q[k]));
    let first = first + 7 * (i - 1);
    Body::with_euler([first, first + 1, first + 2], at, [first + 3, first + 4, first + 5, first + 6])
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

use std::array::from_fn;

use qless_constraints::types::{
    Cyclic, Face, FaceSearch, HangingNode, LineTie, MacroStrain, MortarTie, Multipliers, Node, NodeTie, OrderTie,
    Periodic, Shape, Surface, Turn, Turning,
};
use qless_constraints::{Constraint, ConstraintSet};

use crate::common::random;

const BAD: [f64; 11] =
    [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 0.0, -0.0, 5e-324, 1e-200, 1e16, -1e120, 1e200, f64::MAX];

/// The constraint is refused, or its coefficients are finite.
fn take<C: Constraint>(constraint: C) -> bool {
    let mut builder = ConstraintSet::builder(60);
    let taken = builder.add("it", constraint).is_ok();
    let set = builder.build().expect("few DOFs");
    let g = set.allocate().g().clone();
    assert!(g.values().iter().all(|v| v.is_finite()));
    taken
}

/// A node of one field per number.
fn node<const D: usize>(dof: usize, at: [f64; D]) -> Node<D, 1> {
    Node::of_field(dof, at)
}

fn somewhere<const D: usize>(seed: usize) -> [f64; D] {
    from_fn(|k| 2.0 * random(3 * seed + k))
}

/// Bad values in each coordinate of elements of every shape, in the plane and in space: no panic, no coefficient that is not finite, and no
/// acceptance of a coordinate that is not finite.
#[test]
fn ties_survive_bad_coordinates() {
    fn ties<const D: usize>() {
        for (shape, x) in Shape::ALL.into_iter().flat_map(|shape| BAD.map(|x| (shape, x))) {
            for bad in 0..=shape.nodes() * D {
                let mut places: Vec<[f64; D]> = (0..=shape.nodes()).map(|k| somewhere(k + 100 * bad)).collect();
                places[bad / D][bad % D] = x;
                let face: Vec<_> = (1..places.len()).map(|k| node(k, places[k])).collect();
                let tie = NodeTie { node: node(0, places[0]), shape, face: face.clone(), tolerance: 1e300 };
                assert!(!take(tie) || x.is_finite(), "{shape:?}, {x}");
                let numbers: Vec<_> = (0..shape.nodes()).collect();
                let surface = Surface { nodes: face, faces: vec![Face::new(shape, numbers)] };
                if let Ok(search) = FaceSearch::new(&surface) {
                    let found = search.nearest(&places[0]);
                    assert!(found.is_none_or(|found| found.weights.iter().all(|n| n.is_finite())));
                }
            }
        }
    }
    ties::<2>();
    ties::<3>();
}

#[test]
fn mortar_ties_survive_bad_coordinates() {
    let edges = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.5, 0.0], [1.0, 0.5], [0.5, 1.0], [0.0, 0.5]];
    let square = [&edges[..], &[[0.5, 0.5]]].concat();
    for (shape, x) in [Shape::Line2, Shape::Line3, Shape::Quad4, Shape::Quad8, Shape::Quad9]
        .into_iter()
        .flat_map(|s| BAD.map(|x| (s, x)))
    {
        for (bad, kind) in
            (0..6 * shape.nodes()).flat_map(|bad| [(bad, Multipliers::Standard), (bad, Multipliers::Dual)])
        {
            let mut places: Vec<[f64; 3]> =
                (0..2 * shape.nodes()).map(|k| square[k % shape.nodes()]).map(|[x, y]| [x, y, 0.0]).collect();
            places[bad / 3][bad % 3] = x;
            let side = |first: usize| Surface {
                nodes: (0..shape.nodes()).map(|k| node(first + k, places[first + k])).collect(),
                faces: vec![Face::new(shape, (0..shape.nodes()).collect::<Vec<_>>())],
            };
            for tolerance in [1e-9, x, f64::MAX] {
                let tie = MortarTie { slave: side(0), master: side(shape.nodes()), multipliers: kind, tolerance };
                assert!(!take(tie) || (x.is_finite() || tolerance.is_nan()), "{shape:?}, {x}");
            }
        }
    }
}

#[test]
fn other_ties_survive_bad_numbers() {
    for x in BAD {
        for k in 0..2 {
            let at = |own: usize| from_fn(|j| if own == 0 && j == k { x } else { (own + j) as f64 });
            let line = |own: usize| vec![node::<2>(0, at(own)), node(1, at(own + 1))];
            let tie = LineTie { slave: line(0), master: vec![node(2, at(2)), node(3, at(3))], tolerance: 1e300 };
            assert!(!take(tie) || x.is_finite());
            assert!(!take(LineTie { slave: vec![node(3, at(3))], master: line(0), tolerance: x }) || x.is_finite());
            let (a, b) = (node::<2>(0, at(0)), node(1, at(1)));
            assert!(!take(Periodic { a, b, strain: MacroStrain::Given([[1.0; 2]]) }) || x.is_finite());
            take(Periodic { a, b, strain: MacroStrain::Given([[x; 2]]) });
            take(Periodic { a, b, strain: MacroStrain::Dofs([[2, 3]]) });
            for turn in [Turn::in_plane([x, 0.0], 1.0), Turn::in_plane([0.0; 2], x)] {
                take(Cyclic { a, b, turn, fields: Turning::Scalars, tolerance: 1e300 });
                take(Cyclic { a, b, turn, fields: Turning::Vectors, tolerance: f64::INFINITY });
            }
        }
        for shape in Shape::ALL {
            let parent = (0..shape.nodes()).map(|k| [k]).collect();
            let inside = take(HangingNode { node: [40], shape, parent, at: [x, 0.0] });
            assert!(!inside || x.abs() <= 1.0 + 1e-12, "{shape:?}, {x}");
        }
        for (fine, coarse) in
            [([0.0, x, 1.0], [0.0, 1.0]), ([0.0, 0.5, 1.0], [x, 1.0]), ([0.0, x, 2.0 * x], [0.0, 2.0 * x])]
        {
            let fine = fine.iter().enumerate().map(|(i, &at)| (at, [i])).collect();
            let coarse = coarse.iter().enumerate().map(|(i, &at)| (at, [5 + i])).collect();
            take(OrderTie { fine, coarse });
        }
        assert!(Turn::about([0.0; 3], [x, 0.0, 0.0], 1.0).is_ok() == (x.is_finite() && x != 0.0), "{x}");
    }
}

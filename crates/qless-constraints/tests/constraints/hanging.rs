use faer::Mat;
use qless::{Options, analyse};
use qless_constraints::ConstraintSet;
use qless_constraints::types::{HangingNode, OrderTie, Shape};

use crate::common::Outcome;

const TRIANGLE: [[f64; 2]; 6] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.5, 0.0], [0.5, 0.5], [0.0, 0.5]];
const QUAD: [[f64; 2]; 9] =
    [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [0.0, -1.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, 0.0]];
const LINE: [[f64; 2]; 3] = [[-1.0, 0.0], [1.0, 0.0], [0.0, 0.0]];

/// Parameters of the nodes, and of those that one regular refinement adds with children of the same shape.
fn refined(shape: Shape) -> (&'static [[f64; 2]], Vec<[f64; 2]>) {
    let lattice = |n: i32, low: f64, keep: &dyn Fn(i32, i32) -> bool| -> Vec<[f64; 2]> {
        let all = (0..=n).flat_map(|i| (0..=n).map(move |j| (i, j)));
        let at = |i: i32| low + (1.0 - low) * f64::from(i) / f64::from(n);
        all.filter(|&(i, j)| keep(i, j)).map(|(i, j)| [at(i), at(j)]).collect()
    };
    let (own, all) = match shape {
        Shape::Line2 => (&LINE[..2], vec![[0.0, 0.0]]),
        Shape::Line3 => (&LINE[..], vec![[-0.5, 0.0], [0.5, 0.0]]),
        Shape::Tri3 => (&TRIANGLE[..3], lattice(2, 0.0, &|i, j| i + j <= 2)),
        Shape::Tri6 => (&TRIANGLE[..], lattice(4, 0.0, &|i, j| i + j <= 4)),
        Shape::Quad4 => (&QUAD[..4], lattice(2, -1.0, &|_, _| true)),
        Shape::Quad9 => (&QUAD[..], lattice(4, -1.0, &|_, _| true)),
        // Children have no nodes in their own middles.
        _ => (&QUAD[..8], lattice(4, -1.0, &|i, j| i % 2 == 0 || j % 2 == 0)),
    };
    let added = all.into_iter().filter(|at| !own.contains(at)).collect();
    (own, added)
}

fn set_of(shape: Shape) -> Outcome<(ConstraintSet, Vec<[f64; 2]>)> {
    let (own, added) = refined(shape);
    let mut builder = ConstraintSet::builder(own.len() + added.len());
    for (i, &at) in added.iter().enumerate() {
        let parent = (0..own.len()).map(|k| [k]).collect();
        builder.add(format!("{i}"), HangingNode { node: [own.len() + i], shape, parent, at })?;
    }
    Ok((builder.build().expect("few DOFs"), [own.to_vec(), added].concat()))
}

/// Hanging nodes lie on the polynomial of the parent: every field of its shape passes exactly, and one of higher degree does not.
#[test]
fn hanging_nodes_are_on_the_polynomial_of_the_parent() -> Outcome {
    let degree = |shape: Shape| match shape {
        Shape::Line2 | Shape::Tri3 => vec![[0, 0], [1, 0], [0, 1]],
        Shape::Quad4 => vec![[0, 0], [1, 0], [0, 1], [1, 1]],
        Shape::Line3 | Shape::Tri6 => vec![[0, 0], [1, 0], [0, 1], [1, 1], [2, 0], [0, 2]],
        Shape::Quad8 => vec![[0, 0], [1, 0], [0, 1], [1, 1], [2, 0], [0, 2], [2, 1], [1, 2]],
        _ => (0..9).map(|k| [k % 3, k / 3]).collect(),
    };
    for (shape, added) in [
        (Shape::Line2, 1),
        (Shape::Line3, 2),
        (Shape::Tri3, 3),
        (Shape::Quad4, 5),
        (Shape::Tri6, 9),
        (Shape::Quad8, 13),
        (Shape::Quad9, 16),
    ] {
        let (set, places) = set_of(shape)?;
        assert_eq!(set.equations(), added, "{shape:?}");
        let mut evaluation = set.allocate();
        for [p, q] in degree(shape) {
            set.evaluate(&places.iter().map(|[x, y]| x.powi(p) * y.powi(q)).collect::<Vec<_>>(), &mut evaluation)?;
            assert!(evaluation.c().iter().all(|c| c.abs() < 1e-15), "{shape:?}, x^{p} y^{q}: {:?}", evaluation.c());
        }
        let beyond: Vec<f64> = places.iter().map(|[x, y]| (x + 0.3 * y).powi(4)).collect();
        set.evaluate(&beyond, &mut evaluation)?;
        assert!(evaluation.c().iter().any(|c| c.abs() > 1e-3), "{shape:?}");
        // Weights are dyadic, so that there is no rounding.
        let sums = (0..set.equations()).map(|row| evaluation.g().row(row).map(|(_, v)| v).sum::<f64>());
        assert!(sums.into_iter().all(|sum| sum == 0.0), "{shape:?}");
    }
    Ok(())
}

/// A node that hangs on an edge and on a face with that edge is redundant; the rank is that of the SVD.
#[test]
fn a_node_on_an_edge_and_on_its_face_is_redundant() -> Outcome {
    let face: Vec<_> = (0..8).map(|k| [k]).collect();
    let mut builder = ConstraintSet::builder(11);
    for (i, at) in [[-0.5, -1.0], [0.5, -1.0], [0.25, 0.5]].into_iter().enumerate() {
        builder.add("face", HangingNode { node: [8 + i], shape: Shape::Quad8, parent: face.clone(), at })?;
    }
    for (i, at) in [-0.5, 0.5].into_iter().enumerate() {
        let parent = vec![[0], [1], [4]];
        builder.add("edge", HangingNode { node: [8 + i], shape: Shape::Line3, parent, at: [at, 0.0] })?;
    }
    let set = builder.build().expect("few DOFs");
    let evaluation = set.allocate();
    let mut dense = Mat::<f64>::zeros(set.equations(), 11);
    (0..set.equations()).for_each(|i| evaluation.g().row(i).for_each(|(j, v)| dense[(i, j)] = v));
    let sizes = dense.singular_values().map_err(|error| format!("{error:?}"))?;
    let rank = sizes.iter().filter(|&&s| s > 1e-12 * sizes[0]).count();
    assert_eq!((rank, analyse(&crate::common::at_rest(&set, &[])?, &Options::default())?.rank()), (3, 3));
    Ok(())
}

/// Points of degree p on [-1, 1]: equally spaced, or those of Gauss and Lobatto.
fn points(p: usize, lobatto: bool) -> Vec<f64> {
    match (p, lobatto) {
        (3, true) => vec![-1.0, -(0.2_f64.sqrt()), 0.2_f64.sqrt(), 1.0],
        (4, true) => vec![-1.0, -(3.0_f64 / 7.0).sqrt(), 0.0, (3.0_f64 / 7.0).sqrt(), 1.0],
        _ => (0..=p).map(|i| 2.0 * i as f64 / p as f64 - 1.0).collect(),
    }
}

/// Degree q passes and degree q + 1 does not, for all orders, both sets of points, shared ends or not, in every unit of length.
#[test]
fn orders_meet_in_the_lower_one() -> Outcome {
    let orders = (2..=8_usize).flat_map(|p| (1..p).map(move |q| (p, q)));
    for ((p, q), lobatto) in orders.flat_map(|o| [(o, false), (o, true)]) {
        for (scale, shared) in [(1.0, true), (1e-6, false), (1e6, true)] {
            let [s, t] = [points(p, lobatto), points(q, lobatto)].map(|s| s.into_iter().map(|s| s * scale).collect());
            let (s, t): (Vec<f64>, Vec<f64>) = (s, t);
            let coarse: Vec<_> = t.iter().enumerate().map(|(k, &at)| (at, [2 * k, 2 * k + 1])).collect();
            let dofs = |i: usize| [2 * (t.len() + i), 2 * (t.len() + i) + 1];
            let own = |i: usize| if shared && i == 0 { [0, 1] } else { dofs(i) };
            let fine: Vec<_> = s.iter().enumerate().map(|(i, &at)| (at, own(i))).collect();
            let mut builder = ConstraintSet::builder(2 * (s.len() + t.len()));
            builder.add("edge", OrderTie { fine: fine.clone(), coarse: coarse.clone() })?;
            let set = builder.build().expect("few DOFs");
            assert_eq!(set.equations(), 2 * (p + 1 - usize::from(shared)));
            let residual = |degree: usize| -> Outcome<f64> {
                let mut u = vec![0.0; set.dofs()];
                for &(at, dofs) in coarse.iter().chain(&fine) {
                    (u[dofs[0]], u[dofs[1]]) = ((at / scale).powi(degree as i32), 1.0 - at / scale);
                }
                let mut evaluation = set.allocate();
                set.evaluate(&u, &mut evaluation)?;
                Ok(evaluation.c().iter().fold(0.0, |most: f64, c| most.max(c.abs())))
            };
            for degree in 0..=q {
                assert!(residual(degree)? < 1e-13, "{p} at {q}, {degree}: {}", residual(degree)?);
            }
            // The finer nodes between the coarser ones detect the missing degree.
            assert!(residual(q + 1)? > 1e-4, "{p} at {q}: {}", residual(q + 1)?);
            let rank = analyse(&crate::common::at_rest(&set, &[])?, &Options::default())?.rank();
            assert_eq!(rank, set.equations());
        }
    }
    Ok(())
}

#[test]
fn faults_of_hanging_nodes_are_named() {
    let said = |tie: HangingNode<1>| {
        ConstraintSet::builder(20).add("it", tie).map_or_else(|error| error.to_string(), |_| "accepted".to_owned())
    };
    let tie = |shape: Shape, nodes: usize, at: [f64; 2]| HangingNode {
        node: [10],
        shape,
        parent: (0..nodes).map(|k| [k]).collect(),
        at,
    };
    assert!(said(tie(Shape::Tri3, 3, [0.6, 0.6])).contains("[0.6, 0.6] are not inside of a Tri3"));
    assert!(said(tie(Shape::Line2, 2, [f64::NAN, 0.0])).contains("not inside"));
    assert!(said(tie(Shape::Line2, 2, [1.0, f64::NAN])).contains("accepted"));
    assert!(said(tie(Shape::Quad8, 4, [0.0; 2])).contains("has 4 nodes; a Quad8 has 8"));
    assert!(said(tie(Shape::Hex8, 8, [0.0; 2])).contains("is a Hex8; nodes hang on edges and faces"));
    assert!(
        said(HangingNode { node: [1], ..tie(Shape::Line2, 2, [0.0; 2]) })
            .contains("DOF 1 of the node also belongs to the parent")
    );
    // A parameter that is out of range by rounding is accepted.
    assert!(said(tie(Shape::Line2, 2, [1.0 + f64::EPSILON, 0.0])).contains("accepted"));
    assert!(said(tie(Shape::Tri6, 6, [1.0 / 3.0, 2.0 / 3.0 + f64::EPSILON])).contains("accepted"));
    assert!(said(tie(Shape::Tri6, 6, [1.0 / 3.0, 2.0 / 3.0 + 1e-9])).contains("not inside"));
    let order = |fine: &[(f64, usize)], coarse: &[(f64, usize)]| {
        let [fine, coarse] = [fine, coarse].map(|side| side.iter().map(|&(at, dof)| (at, [dof])).collect());
        let added = ConstraintSet::builder(9).add("it", OrderTie { fine, coarse });
        added.map_or_else(|error| error.to_string(), |_| "accepted".to_owned())
    };
    let ends = [(0.0, 0), (1.0, 1)];
    assert!(order(&[(0.0, 2), (1.0, 3)], &ends).contains("2 nodes are tied to 2"));
    assert!(order(&[(0.0, 2), (0.5, 3), (2.0, 4)], &ends).contains("node 3, from 1, of the finer side is at 2"));
    assert!(order(&[(0.0, 2), (f64::NAN, 3), (1.0, 4)], &ends).contains("is at NaN"));
    assert!(order(&[(0.0, 2), (0.5, 1), (1.0, 4)], &ends).contains("shares DOF 1 with a different coarser node"));
    assert!(order(&[(0.0, 2), (0.5, 3), (1.0, 4)], &[(0.5, 0), (0.5, 1)]).contains("nodes 1 and 2, from 1"));
    assert!(order(&[(0.0, 0), (0.5, 3), (1.0, 1)], &ends).contains("accepted"));
    assert!(order(&[(0.0, 0), (0.5, 3), (1.0 + f64::EPSILON, 1)], &ends).contains("accepted"));
    assert!(order(&[(0.0, 0), (0.5, 3), (1.0 + f64::EPSILON, 4)], &ends).contains("accepted"));
}

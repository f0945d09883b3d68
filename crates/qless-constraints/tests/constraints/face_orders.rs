use std::array::from_fn;

use qless::{Options, analyse};
use qless_constraints::ConstraintSet;
use qless_constraints::types::{FaceOrderTie, FaceSide, OrderTie, Polynomials, Shape};

use crate::common::{Outcome, random};

/// Nodes equally spaced on a face; where a serendipity face has none, some further ones anywhere.
fn places(of: Polynomials) -> Vec<[f64; 2]> {
    let p = of.degree();
    let at = |i: usize| i as f64 / p as f64;
    let lattice = (0..=p).flat_map(|j| (0..=p).map(move |i| (i, j)));
    match of {
        Polynomials::Triangle(_) => lattice.filter(|(i, j)| i + j <= p).map(|(i, j)| [at(i), at(j)]).collect(),
        Polynomials::Quadrilateral(_) => lattice.map(|(i, j)| [2.0 * at(i) - 1.0, 2.0 * at(j) - 1.0]).collect(),
        Polynomials::Serendipity(_) => {
            let rim = lattice.filter(|(i, j)| [i, j].into_iter().any(|k| k % p == 0));
            let inner = [[0.1, 0.2], [-0.4, 0.3], [0.35, -0.45]];
            rim.map(|(i, j)| [2.0 * at(i) - 1.0, 2.0 * at(j) - 1.0]).chain(inner).take(of.dimension()).collect()
        }
    }
}

/// A monomial basis, independent of the library's.
fn monomials(of: Polynomials) -> Vec<[i32; 2]> {
    let p = of.degree() as i32;
    let all = (0..=p).flat_map(|i| (0..=p).map(move |j| [i, j]));
    let counted = |k: i32| if k > 1 { k } else { 0 };
    all.filter(|&[i, j]| match of {
        Polynomials::Triangle(_) => i + j <= p,
        Polynomials::Quadrilateral(_) => true,
        Polynomials::Serendipity(_) => counted(i) + counted(j) <= p,
    })
    .collect()
}

fn side(of: Polynomials, first: usize) -> FaceSide<2> {
    let own = |(i, at)| (at, from_fn(|k| first + 2 * i + k));
    FaceSide { polynomials: of, nodes: places(of).into_iter().enumerate().map(own).collect() }
}

fn tied(fine: Polynomials, coarse: Polynomials) -> Outcome<(ConstraintSet, FaceOrderTie<2>)> {
    let tie = FaceOrderTie { fine: side(fine, 2 * coarse.dimension()), coarse: side(coarse, 0) };
    let mut builder = ConstraintSet::builder(2 * (fine.dimension() + coarse.dimension()));
    builder.add("face", tie.clone())?;
    Ok((builder.build()?, tie))
}

fn pairs() -> Vec<(Polynomials, Polynomials)> {
    let all = |p: usize| [Polynomials::Triangle(p), Polynomials::Quadrilateral(p), Polynomials::Serendipity(p)];
    let every: Vec<Polynomials> = (1..=5).flat_map(all).collect();
    let both = every.iter().flat_map(|&fine| every.iter().map(move |&coarse| (fine, coarse)));
    both.filter(|(fine, coarse)| fine.contain(*coarse)).collect()
}

/// Every polynomial of the coarser side passes, in both fields, and one that it cannot be does not; each equation is independent, and
/// weights sum to one.
#[test]
fn faces_meet_in_the_coarser_polynomial() -> Outcome {
    let pairs = pairs();
    assert!(pairs.len() > 60, "{}", pairs.len());
    for (fine, coarse) in pairs {
        let (set, tie) = tied(fine, coarse)?;
        assert_eq!(set.equations(), 2 * fine.dimension());
        let residual = |field: &dyn Fn([f64; 2]) -> f64| -> Outcome<f64> {
            let mut u = vec![0.0; set.dofs()];
            for &(at, dofs) in tie.coarse.nodes.iter().chain(&tie.fine.nodes) {
                (u[dofs[0]], u[dofs[1]]) = (field(at), 1.0 - 2.0 * field(at));
            }
            let mut evaluation = set.allocate();
            set.evaluate(&u, &mut evaluation)?;
            Ok(evaluation.c().iter().fold(0.0, |most: f64, c| most.max(c.abs())))
        };
        let terms = monomials(coarse);
        let some = |[x, y]: [f64; 2]| {
            terms.iter().enumerate().map(|(k, &[i, j])| random(k + 7) * x.powi(i) * y.powi(j)).sum::<f64>()
        };
        assert!(residual(&some)? < 1e-12, "{fine:?} at {coarse:?}: {}", residual(&some)?);
        let p = coarse.degree() as i32 + 1;
        if fine.degree() > coarse.degree() {
            assert!(residual(&|[x, y]| x.powi(p) + y.powi(p))? > 1e-3, "{fine:?} at {coarse:?}");
        }
        let g = set.allocate().g().clone();
        assert!((0..set.equations()).all(|row| g.row(row).map(|(_, a)| a).sum::<f64>().abs() < 1e-13));
        let rank = analyse(&crate::common::at_rest(&set, &[])?, &Options::default())?.rank();
        assert_eq!(rank, set.equations());
    }
    Ok(())
}

/// Between the nodes too: the finer polynomial through what the equations give is the coarser one, everywhere on the face.
#[test]
fn sides_meet_between_their_nodes() -> Outcome {
    for (fine, coarse) in pairs() {
        let (set, tie) = tied(fine, coarse)?;
        let terms = monomials(fine);
        let values: Vec<f64> = (0..coarse.dimension()).map(|k| random(3 * k + 1)).collect();
        let follow = |row: usize| -> f64 {
            set.allocate()
                .g()
                .row(2 * row)
                .filter(|&(dof, _)| dof < 2 * values.len())
                .map(|(dof, a)| -a * values[dof / 2])
                .sum()
        };
        let solve = |of: Polynomials, nodes: &[([f64; 2], [usize; 2])], right: &[f64], basis: &[[i32; 2]]| {
            use faer::linalg::solvers::Solve;
            let matrix = faer::Mat::from_fn(of.dimension(), basis.len(), |k, m| {
                let [x, y] = nodes[k].0;
                x.powi(basis[m][0]) * y.powi(basis[m][1])
            });
            matrix.partial_piv_lu().solve(faer::Mat::from_fn(right.len(), 1, |k, _| right[k]))
        };
        let followed: Vec<f64> = (0..fine.dimension()).map(follow).collect();
        let coarse_terms = monomials(coarse);
        let one = solve(fine, &tie.fine.nodes, &followed, &terms);
        let two = solve(coarse, &tie.coarse.nodes, &values, &coarse_terms);
        for (m, exponents) in terms.iter().enumerate() {
            let other = coarse_terms.iter().position(|e| e == exponents).map_or(0.0, |k| two[(k, 0)]);
            assert!(
                (one[(m, 0)] - other).abs() < 1e-9 * (1.0 + other.abs()),
                "{fine:?} at {coarse:?}, {exponents:?}: {} {other}",
                one[(m, 0)]
            );
        }
    }
    Ok(())
}

/// On an edge of the face it says what the tie of the edge says.
#[test]
fn edges_of_faces_are_tied_as_edges() -> Outcome {
    for (p, q) in (2..=5).flat_map(|p| (1..p).map(move |q| (p, q))) {
        let (set, tie) = tied(Polynomials::Quadrilateral(p), Polynomials::Quadrilateral(q))?;
        let on_edge = |side: &FaceSide<2>| -> Vec<(f64, [usize; 2])> {
            side.nodes.iter().filter(|(at, _)| at[1] == -1.0).map(|&(at, dofs)| (at[0], dofs)).collect()
        };
        let mut builder = ConstraintSet::builder(set.dofs());
        builder.add("edge", OrderTie { fine: on_edge(&tie.fine), coarse: on_edge(&tie.coarse) })?;
        let edge = builder.build()?.allocate().g().clone();
        let face = set.allocate().g().clone();
        for row in 0..2 * (p + 1) {
            let (one, two): (Vec<_>, Vec<_>) = (edge.row(row).collect(), face.row(row).collect());
            assert_eq!(one.len(), two.len(), "{p} at {q}: {one:?} {two:?}");
            assert!(one.iter().zip(&two).all(|(a, b)| a.0 == b.0 && (a.1 - b.1).abs() < 1e-13), "{one:?} {two:?}");
        }
    }
    Ok(())
}

/// The shapes of elements: corners that are shared have no equation, others are those of the coarser shape.
#[test]
fn shapes_meet_with_shared_corners() -> Outcome {
    for (fine, coarse, equations) in [
        (Shape::Tri6, Shape::Tri3, 3),
        (Shape::Quad8, Shape::Quad4, 4),
        (Shape::Quad9, Shape::Quad4, 5),
        (Shape::Quad9, Shape::Quad8, 1),
    ] {
        let dofs = |count: usize| (0..count).map(|k| [k]).collect::<Vec<_>>();
        let side = |shape: Shape| FaceSide::of_shape(shape, &dofs(shape.nodes()));
        let tie = FaceOrderTie { fine: side(fine)?, coarse: side(coarse)? };
        let mut builder = ConstraintSet::builder(fine.nodes());
        builder.add("face", tie)?;
        let set = builder.build()?;
        assert_eq!(set.equations(), equations, "{fine:?} at {coarse:?}");
        let g = set.allocate().g().clone();
        let own: Vec<Vec<(usize, f64)>> = (0..equations).map(|row| g.row(row).collect()).collect();
        match (fine, coarse) {
            (Shape::Quad9, Shape::Quad8) => {
                let truth = |k: usize| if k < 4 { 0.25 } else { -0.5 };
                assert!(
                    own[0][..8].iter().all(|&(k, a)| (a - truth(k)).abs() < 1e-15) && own[0][8] == (8, 1.0),
                    "{own:?}"
                );
            }
            _ => assert!(own.iter().flatten().all(|&(_, a)| [1.0, -0.5, -0.25].contains(&a)), "{own:?}"),
        }
    }
    Ok(())
}

#[test]
fn faults_of_faces_of_other_orders_are_named() {
    let said = |tie: FaceOrderTie<2>| {
        ConstraintSet::builder(200).add("it", tie).map_or_else(|error| error.to_string(), |_| "accepted".to_owned())
    };
    let of = |fine: Polynomials, coarse: Polynomials| FaceOrderTie { fine: side(fine, 100), coarse: side(coarse, 0) };
    let (two, one) = (Polynomials::Quadrilateral(2), Polynomials::Quadrilateral(1));
    assert_eq!(said(of(two, one)), "accepted");
    assert!(said(of(one, two)).contains("do not contain Quadrilateral(2)"));
    assert!(said(of(Polynomials::Serendipity(3), two)).contains("do not contain Quadrilateral(2)"));
    assert!(said(of(Polynomials::Triangle(3), one)).contains("do not contain Quadrilateral(1)"));
    for polynomials in
        [Polynomials::Quadrilateral(0), Polynomials::Triangle(usize::MAX), Polynomials::Serendipity(usize::MAX)]
    {
        let coarse = FaceSide { polynomials, ..side(one, 0) };
        assert!(
            said(FaceOrderTie { coarse, ..of(two, one) }).contains("the coarser side has 4 nodes"),
            "{polynomials:?}"
        );
    }
    let moved = |node: usize, at: [f64; 2]| {
        let mut tie = of(two, one);
        tie.coarse.nodes[node].0 = at;
        said(tie)
    };
    assert!(moved(1, [1.0 + 1e-9, 0.0]).contains("node 2, from 1, of the coarser side is at [1.000000001, 0.0]"));
    assert!(moved(1, [f64::NAN, 0.0]).contains("node 2, from 1, of the coarser side is at [NaN, 0.0]"));
    assert!(moved(1, [-1.0, -1.0]).contains("nodes of the coarser side do not determine"));
    assert!(moved(1, [-1.0 + 1e-12, -1.0]).contains("nodes of the coarser side do not determine"));
    assert_eq!(moved(1, [0.9, -1.0 + f64::EPSILON]), "accepted");
    let mut tie = of(two, one);
    tie.fine.nodes[3].0 = tie.fine.nodes[4].0;
    assert!(said(tie).contains("nodes of the finer side do not determine"));
    let mut tie = of(two, one);
    tie.fine.nodes[4].1 = [100, 3];
    assert!(said(tie).contains("node 5, from 1, of the finer side shares DOF 3"));
    let side =
        |shape: Shape| FaceSide::of_shape(shape, &[[0]]).map_or_else(|error| error.to_string(), |_| String::new());
    assert_eq!(side(Shape::Hex8), "a Hex8 is not a face");
    assert_eq!(side(Shape::Quad9), "1 nodes are given; a Quad9 has 9");
}

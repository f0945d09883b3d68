use std::array::from_fn;

use qless_constraints::types::{
    Cyclic, Face, LineTie, MacroStrain, MortarTie, Multipliers, Node, NodeTie, Periodic, Shape, Surface, Turn, Turning,
};
use qless_constraints::{Constraint, ConstraintSet};

use crate::common::{Outcome, random};

/// Nodes on the plane z = 0, or the line z = 0 in two dimensions, with F fields each.
fn node<const D: usize, const F: usize>(number: usize, at: [f64; 2]) -> Node<D, F> {
    Node::new(from_fn(|k| F * number + k), from_fn(|k| if k < 2 { at[k] } else { 0.0 }))
}

fn rows(nodes: usize, constraints: Vec<impl Constraint>) -> Vec<(String, Vec<(usize, f64)>)> {
    let mut builder = ConstraintSet::builder(nodes);
    for constraint in constraints {
        assert!(builder.add("it", constraint).is_ok());
    }
    let set = builder.build().expect("few DOFs");
    let g = set.allocate().g().clone();
    (0..g.rows()).map(|row| (set.label(row).expect("a row"), g.row(row).collect())).collect()
}

/// The equations of F fields are F times those of one, to the last bit, and are named.
fn assert_alike<const F: usize>(
    one: &[(String, Vec<(usize, f64)>)],
    many: &[(String, Vec<(usize, f64)>)],
    name: impl Fn(usize) -> String,
) {
    assert_eq!(many.len(), F * one.len());
    for (i, (label, terms)) in many.iter().enumerate() {
        let (own, field) = (&one[i / F], i % F);
        let expected: Vec<_> = own.1.iter().map(|&(dof, v)| (F * dof + field, v)).collect();
        assert_eq!(terms, &expected);
        assert_eq!(label, &format!("{}, {}", own.0, name(field)));
    }
}

fn square<const D: usize, const F: usize>(first: usize) -> Surface<D, F> {
    let nodes = (0..9).map(|i| {
        let at = |k: usize| k as f64 / 2.0 + if k == 1 { 0.1 * random(first + i) } else { 0.0 };
        node(first + i, [at(i % 3), at(i / 3)])
    });
    let face = |a: usize| Face::new(Shape::Quad4, [a, a + 1, a + 4, a + 3]);
    Surface { nodes: nodes.collect(), faces: [0, 1, 3, 4].map(face).to_vec() }
}

fn ties<const F: usize>() -> Outcome<Vec<NodeTie<3, F>>> {
    let places = |i: usize| node(9 + i, [0.5 + random(2 * i), 0.5 + random(2 * i + 1)]);
    Ok(NodeTie::to_surface(&(0..20).map(places).collect::<Vec<_>>(), &square(0), 1e-9)?)
}

fn mortars<const F: usize>(multipliers: Multipliers) -> Vec<MortarTie<3, F>> {
    vec![MortarTie { slave: square(0), master: square(9), multipliers, tolerance: 1e-9 }]
}

fn lines<const F: usize>() -> Vec<LineTie<2, F>> {
    let line = |first: usize, count: usize| -> Vec<_> {
        (0..=count).map(|i| node(first + i, [i as f64 / count as f64, 0.0])).collect()
    };
    vec![LineTie { slave: line(0, 5), master: line(6, 3), tolerance: 0.0 }]
}

#[test]
fn equations_of_many_fields_are_those_of_one() -> Outcome {
    let field = |k: usize| format!("field {}", k + 1);
    let axis = |k: usize| ["x", "y", "z"][k].to_owned();
    let one = rows(29, ties::<1>()?);
    assert_alike::<2>(&one, &rows(58, ties::<2>()?), field);
    assert_alike::<3>(&one, &rows(87, ties::<3>()?), axis);
    assert_alike::<6>(&one, &rows(174, ties::<6>()?), field);
    for kind in [Multipliers::Standard, Multipliers::Dual] {
        let one = rows(18, mortars::<1>(kind));
        assert_alike::<2>(&one, &rows(36, mortars::<2>(kind)), field);
        assert_alike::<6>(&one, &rows(108, mortars::<6>(kind)), field);
    }
    let one = rows(10, lines::<1>());
    assert_eq!(one[2].0, "it, node 3");
    assert_alike::<2>(&one, &rows(20, lines::<2>()), axis);
    assert_alike::<3>(&one, &rows(30, lines::<3>()), field);
    Ok(())
}

/// A linear field with its own gradient in every component satisfies periodic pairs, with E given and with E as DOFs.
#[test]
fn periodic_pairs_of_any_fields_take_their_gradient() -> Outcome {
    fn assert_periodic<const D: usize, const F: usize>() -> Outcome {
        let e: [[f64; D]; F] = from_fn(|k| from_fn(|j| random(10 * k + j)));
        let at: [[f64; D]; 2] = [from_fn(|j| random(50 + j)), from_fn(|j| 2.0 + random(60 + j))];
        let [a, b] = [0, 1].map(|i| Node::<D, F>::new(from_fn(|k| F * i + k), at[i]));
        let dofs = from_fn(|k| from_fn(|j| 2 * F + D * k + j));
        let mut builder = ConstraintSet::builder(2 * F + D * F);
        builder.add("given", Periodic { a, b, strain: MacroStrain::Given(e) })?;
        builder.add("unknown", Periodic { a, b, strain: MacroStrain::Dofs(dofs) })?;
        let field = |i: usize, k: usize| 0.7 * k as f64 + (0..D).map(|j| e[k][j] * at[i][j]).sum::<f64>();
        let values = (0..2).flat_map(|i| (0..F).map(move |k| field(i, k)));
        let u: Vec<f64> = values.chain(e.into_iter().flatten()).collect();
        let set = builder.build().expect("few DOFs");
        let mut evaluation = set.allocate();
        set.evaluate(&u, &mut evaluation)?;
        assert_eq!(set.equations(), 2 * F);
        assert!(evaluation.c().iter().all(|c| c.abs() < 1e-14), "{:?}", evaluation.c());
        Ok(())
    }
    assert_periodic::<2, 1>()?;
    assert_periodic::<3, 1>()?;
    assert_periodic::<2, 2>()?;
    assert_periodic::<3, 6>()?;
    assert_periodic::<2, 3>()
}

/// What turns with the sectors satisfies cyclic symmetry, in the plane and in space: displacements, rotations, and a temperature.
#[test]
fn fields_that_turn_are_cyclic() -> Outcome {
    fn assert_cyclic<const D: usize, const F: usize>(
        turn: Turn<D>,
        fields: Turning,
        at: [[f64; D]; 2],
        u: [[f64; F]; 2],
    ) -> Outcome {
        let [a, b] = [0, 1].map(|i| Node::<D, F>::new(from_fn(|k| F * i + k), at[i]));
        let mut builder = ConstraintSet::builder(2 * F);
        builder.add("it", Cyclic { a, b, turn, fields, tolerance: 1e-12 })?;
        let set = builder.build().expect("few DOFs");
        let mut evaluation = set.allocate();
        set.evaluate(&u.concat(), &mut evaluation)?;
        assert_eq!(set.equations(), F);
        assert!(evaluation.c().iter().all(|c| c.abs() < 1e-15), "{:?}", evaluation.c());
        Ok(())
    }
    let (sin, cos) = 0.8_f64.sin_cos();
    let flat = |[x, y]: [f64; 2]| [cos * x - sin * y, sin * x + cos * y];
    let space = |[x, y, z]: [f64; 3]| [cos * x - sin * y, sin * x + cos * y, z];
    let (p, u, theta) = ([0.7, -0.2], [0.3, 0.5], [0.1, -0.6, 0.9]);
    let image = flat(p).map(|x| x + 1.0);
    let from = p.map(|x| x + 1.0);
    assert_cyclic(Turn::in_plane([1.0; 2], 0.8), Turning::Vectors, [from, image], [u, flat(u)])?;
    assert_cyclic(Turn::in_plane([1.0; 2], 0.8), Turning::Scalars, [from, image], [[0.4], [0.4]])?;
    let [a, b] = [[0.7, -0.2, 3.0], space([0.7, -0.2, 3.0])];
    let shell = |u: [f64; 2], theta: [f64; 3]| [u[0], u[1], 0.25, theta[0], theta[1], theta[2]];
    let about = Turn::about([0.0, 0.0, 9.0], [0.0, 0.0, 3.0], 0.8)?;
    assert_cyclic(about, Turning::Vectors, [a, b], [shell(u, theta), shell(flat(u), space(theta))])?;
    assert_cyclic(about, Turning::Scalars, [a, b], [theta, theta])
}

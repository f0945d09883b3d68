//! Cards with geometry: rigid motions of the whole, and for ties also homogeneous deformations, must satisfy their equations.

use qless_io::deck::{Deck, Model};

use super::solver::parse;

/// Nodes at irregular places: 1 to 8 are a skew brick, 9 to 16 a second brick on top of it, 20 to 27 lie on a line and a plane.
const NODES: &str = "*NODE, NSET=NALL
1,0.,0.,0.\n2,1.,.1,0.\n3,1.2,1.1,0.\n4,.1,.9,0.\n5,0.,0.,1.\n6,1.,.1,1.\n7,1.2,1.1,1.\n8,.1,.9,1.
9,.2,.2,1.\n10,.8,.2,1.\n11,.7,.8,1.\n12,.2,.7,1.\n13,.2,.2,2.\n14,.8,.2,2.\n15,.7,.8,2.\n16,.2,.7,2.
20,0.,0.,3.\n21,1.,.5,3.\n22,.2,1.,3.3\n23,2.,1.,3.\n24,1.2,1.5,3.3\n30,.3,-.4,.7\n31,9.,9.,9.
*ELEMENT, TYPE=C3D8, ELSET=LOW\n1,1,2,3,4,5,6,7,8\n*ELEMENT, TYPE=C3D8, ELSET=HIGH\n2,9,10,11,12,13,14,15,16
*ELEMENT, TYPE=B31, ELSET=BEAMS\n3,20,21\n*ELEMENT, TYPE=DCOUP3D, ELSET=EREF\n4,30
*SURFACE, NAME=TOP\nLOW,S2\n*SURFACE, NAME=FOOT\nHIGH,S1\n*SURFACE, NAME=NODES, TYPE=NODE\n5\n6\n7\n8
*NSET, NSET=TURNED\n6,10\n*NSET, NSET=FIVE, GENERATE\n5,8
*TRANSFORM, NSET=TURNED, TYPE=C\n0.,0.,0.,.3,.2,1.
*ORIENTATION, NAME=ROUND, SYSTEM=CYLINDRICAL\n.5,.5,0.,.5,.5,1.
";

/// Positions of the nodes, and the axes of transformed nodes.
fn position(node: u32) -> [f64; 3] {
    let line = NODES.lines().find(|line| line.starts_with(&format!("{node},")) && line.matches('.').count() >= 3);
    let numbers: Vec<f64> =
        line.expect("a node").split(',').skip(1).map(|word| word.parse().expect("a number")).collect();
    [numbers[0], numbers[1], numbers[2]]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn unit(a: [f64; 3]) -> [f64; 3] {
    let length = a.iter().map(|x| x * x).sum::<f64>().sqrt();
    a.map(|x| x / length)
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// Radial, tangential and axial directions of the transformed nodes.
fn axes(node: u32) -> [[f64; 3]; 3] {
    if ![6, 10].contains(&node) {
        return [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    }
    let (x, axis) = (position(node), unit([0.3, 0.2, 1.0]));
    let along = dot(x, axis);
    let radial = unit(std::array::from_fn(|k| x[k] - along * axis[k]));
    [radial, cross(axis, radial), axis]
}

/// The largest residual of the equations under a displacement field, relative to their terms; rotations are `w`, those of
/// the body's own node 31 too.
fn residual(model: &Model, field: &dyn Fn([f64; 3]) -> [f64; 3], w: [f64; 3]) -> f64 {
    let mut worst = 0.0_f64;
    for i in 0..model.equations() {
        let equation = model.equation(i).expect("an equation");
        let terms = equation.columns.iter().zip(equation.coefficients).map(|(&j, a)| {
            let dof = model.dofs()[j as usize];
            // Nodes from 21 on are rotations that only the solver knows.
            let k = usize::from(if dof.component > 20 { dof.component - 17 } else { dof.component }) - 1;
            let turned = if dof.node == 31 { w } else { field(position(dof.node)) };
            a * if k < 3 { dot(axes(dof.node)[k], turned) } else { dot(axes(dof.node)[k - 3], w) }
        });
        let (sum, size) = terms.fold((0.0, 0.0), |(sum, size): (f64, f64), term| (sum + term, size + term.abs()));
        worst = worst.max((sum - equation.rhs).abs() / size.max(1e-3));
    }
    worst
}

fn deck(cards: &str) -> Deck {
    parse(format!("{NODES}{cards}*STEP\n*STATIC\n*END STEP\n").as_bytes())
}

#[test]
fn rigid_motions_fulfil_every_card() {
    for (cards, equations) in [
        ("*RIGID BODY, NSET=FIVE, REF NODE=30, ROT NODE=31\n", 12),
        ("*RIGID BODY, ELSET=LOW, REF NODE=30\n", 24),
        ("*COUPLING, REF NODE=30, SURFACE=TOP, CONSTRAINT NAME=C\n*KINEMATIC\n1,3\n", 12),
        ("*COUPLING, REF NODE=30, SURFACE=NODES, CONSTRAINT NAME=C, ORIENTATION=ROUND\n*KINEMATIC\n2\n", 4),
        ("*KINEMATIC COUPLING, REF NODE=30\nFIVE,1,2\n9,3\n", 9),
        ("*MPC\nPLANE,20,21,22,23,\n24\n", 2),
        ("*MPC\nSTRAIGHT,20,21,23\n", 2),
        ("*MPC\nBEAM,20,21\n", 6),
        ("*MPC\nBEAM,5,9\n", 1),
        ("*MPC\nLINK,6,10\n", 1),
        ("*TIE, NAME=T, POSITION TOLERANCE=.01\nFOOT,TOP\n", 12),
    ] {
        let deck = deck(cards);
        assert_eq!(deck.model().equations(), equations, "{cards}");
        let w = [0.3, -0.7, 0.2];
        let motion = |x: [f64; 3]| {
            let turned = cross(w, x);
            std::array::from_fn(|k| [0.5, -1.0, 2.0][k] + turned[k])
        };
        let residual = residual(deck.model(), &motion, w);
        assert!(residual < 1e-13, "{cards}: {residual:e}");
    }
}

#[test]
fn ties_follow_every_even_deformation() {
    let deck = deck("*TIE, NAME=T, POSITION TOLERANCE=.01\nFOOT,TOP\n");
    let even =
        |x: [f64; 3]| [x[0] + 2.0 * x[1] - x[2], 0.3 * x[0] - x[1] + 0.5 * x[2] + 1.0, x[1] - 0.2 * x[0] + 0.1 * x[2]];
    assert!(residual(deck.model(), &even, [0.0; 3]) < 1e-13);
}

#[test]
fn an_old_distributing_coupling_is_a_plain_mean_of_displacements() {
    let deck = deck("*DISTRIBUTING COUPLING, ELSET=EREF\nFIVE,2.\n9,1.\n");
    let shift = |_: [f64; 3]| [0.5, -1.0, 2.0];
    assert_eq!(deck.model().equations(), 3);
    assert!(residual(deck.model(), &shift, [0.0; 3]) < 1e-15);
    // Node 5 is the slave, with the weight 2 of 9 in all.
    let equation = deck.model().equation(0).expect("an equation");
    let reference =
        equation.columns.iter().position(|&j| deck.model().dofs()[j as usize].node == 30).expect("the reference");
    assert!(
        (equation.coefficients[reference] + 4.5).abs() < 1e-15
            && deck.model().dofs()[equation.columns[0] as usize].node == 5
    );
}

#[test]
fn what_is_left_out_is_named() {
    let named =
        |cards: &str| deck(cards).model().warnings().iter().map(|w| w.text.clone()).collect::<Vec<_>>().join("\n");
    assert!(
        named("*TIE, NAME=T, POSITION TOLERANCE=1e-3\nTOP,FOOT\n")
            .contains("leaves 4 nodes free that are farther than 0.001")
    );
    assert!(named("*MPC\nMYOWN,5,6,7\n").contains("*MPC of type MYOWN constrains 3 nodes, but is not understood"));
    assert!(named("*CYCLIC SYMMETRY MODEL, N=4\n").contains("*CYCLIC SYMMETRY MODEL constrains, but no *TIE"));
    assert!(named("*TIE, NAME=T, CYCLIC SYMMETRY\nTOP,FOOT\n").contains("*TIE with CYCLIC SYMMETRY constrains"));
}

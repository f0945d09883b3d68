/// Orders of convergence, curved sides, a flow that must pass.
mod accuracy;
/// Linear fields on flat sides, whole or with bare borders.
mod linear_fields;
/// What the functions of the multipliers are.
mod multipliers;
/// Ranks, threads, and sides that are no sides.
mod ranks;

use qless_constraints::ConstraintSet;
use qless_constraints::types::{Face, MortarTie, Multipliers, Node, Shape, Surface};

use crate::common::{Outcome, random};
use crate::surface_mortar::{Mesh, inclined};

fn tied<const D: usize>(
    slave: &Surface<D, 1>,
    master: &Surface<D, 1>,
    multipliers: Multipliers,
    tolerance: f64,
) -> Outcome<ConstraintSet> {
    let mut builder = ConstraintSet::builder(slave.nodes.len() + master.nodes.len());
    builder.add("tie", MortarTie { slave: slave.clone(), master: master.clone(), multipliers, tolerance })?;
    Ok(builder.build().expect("few DOFs"))
}

/// A line of `n` elements with two or three nodes, at places that are not even, mapped into space.
fn line<const D: usize>(first: usize, n: usize, quadratic: bool, place: impl Fn(f64) -> [f64; D]) -> Surface<D, 1> {
    let steps = if quadratic { 2 } else { 1 };
    let corner = |i: usize| (i as f64 + if i == 0 || i == n { 0.0 } else { 0.5 * random(first + i) }) / n as f64;
    let at = |i: usize| {
        if i.is_multiple_of(steps) { corner(i / steps) } else { f64::midpoint(corner(i / 2), corner(i / 2 + 1)) }
    };
    let nodes = (0..=steps * n).map(|i| Node::of_field(first + i, place(at(i)))).collect();
    let face = |i: usize| {
        if quadratic {
            Face::new(Shape::Line3, [2 * i, 2 * i + 2, 2 * i + 1])
        } else {
            Face::new(Shape::Line2, [i, i + 1])
        }
    };
    Surface { nodes, faces: (0..n).map(face).collect() }
}

/// A surface of one field from one of displacements.
fn of_field(surface: &Surface<3>, first: usize) -> Surface<3, 1> {
    let nodes = surface.nodes.iter().enumerate().map(|(i, node)| Node::of_field(first + i, node.at)).collect();
    Surface { nodes, faces: surface.faces.clone() }
}

fn pair(slave: Mesh, master: Mesh, place: impl Fn([f64; 2]) -> [f64; 3]) -> [Surface<3, 1>; 2] {
    let one = of_field(&slave.surface(0, &place), 0);
    let other = of_field(&master.surface(0, &place), one.nodes.len());
    [one, other]
}

fn residual(set: &ConstraintSet, u: &[f64]) -> Outcome<f64> {
    let mut evaluation = set.allocate();
    set.evaluate(u, &mut evaluation)?;
    // Relative to the terms of each equation.
    let of_row = |row: usize| {
        let size: f64 = evaluation.g().row(row).map(|(dof, v)| (v * u[dof]).abs()).sum();
        if size > 0.0 { evaluation.c()[row].abs() / size } else { 0.0 }
    };
    Ok((0..set.equations()).map(of_row).fold(0.0, f64::max))
}

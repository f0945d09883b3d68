use std::array::from_fn;

use qless_constraints::ConstraintSet;
use qless_constraints::types::{
    Cyclic, CyclicHarmonic, FluidNormal, Line, LineTie, MortarTie, Multipliers, OnLine, OnPlane, PlanarPoint, Plane,
    Point, Surface, Turn, Turning,
};

use crate::common::{Outcome, field, point};

fn residual(set: &ConstraintSet, u: &[f64]) -> f64 {
    let mut evaluation = set.allocate();
    set.evaluate(u, &mut evaluation).expect("of this set");
    evaluation.c().iter().fold(0.0, |most: f64, c| most.max(c.abs()))
}

fn displaced(nodes: &[[f64; 3]]) -> Vec<f64> {
    nodes.iter().flat_map(|&x| field(x)).collect()
}

#[test]
fn lines_and_mortar_pass_linear_fields() -> Outcome {
    let on = |s: f64| [s, 2.0 * s, -s];
    let (slave, master) = ([0.0, 0.31, 0.8, 1.0], [0.0, 0.2, 0.45, 0.6, 1.0]);
    let nodes: Vec<[f64; 3]> = slave.iter().chain(&master).map(|&s| on(s)).collect();
    let points: Vec<Point> = nodes.iter().enumerate().map(|(i, &at)| point(i, at)).collect();
    let (slave, master) = (points[..4].to_vec(), points[4..].to_vec());
    let mut builder = ConstraintSet::builder(27);
    builder.add("line", LineTie { slave: slave.clone(), master: master.clone(), tolerance: 1e-12 })?;
    let [slave, master] = [slave, master].map(Surface::polyline);
    builder.add("mortar", MortarTie { slave, master, multipliers: Multipliers::Standard, tolerance: 1e-12 })?;
    let set = builder.build().expect("few DOFs");
    assert_eq!(set.equations(), 24);
    assert!(residual(&set, &displaced(&nodes)) < 1e-14);
    // Sums of rows of D and of M over all nodes are the length of the interface.
    let sum = |sign: f64| -> f64 {
        (12..24)
            .flat_map(|row| set.allocate().g().row(row).collect::<Vec<_>>())
            .map(|(_, v)| v)
            .filter(|v| v * sign > 0.0)
            .sum()
    };
    let length = 3.0 * 6.0_f64.sqrt();
    assert!((sum(1.0) - length).abs() < 1e-14 * length && (sum(-1.0) + length).abs() < 1e-14 * length);
    Ok(())
}

/// The mortar integrals are those of a fine rule.
#[test]
fn mortar_integrals_are_exact() -> Outcome {
    let (slave, master) = ([0.0, 0.4, 1.0], [0.0, 0.55, 1.0]);
    let at = |i: usize, x: f64| PlanarPoint::new([2 * i, 2 * i + 1], [x, 0.0]);
    let tie = MortarTie {
        slave: Surface::polyline((0..3).map(|i| at(i, slave[i])).collect()),
        master: Surface::polyline((0..3).map(|i| at(i + 3, master[i])).collect()),
        multipliers: Multipliers::Standard,
        tolerance: 1e-12,
    };
    let mut builder = ConstraintSet::builder(12);
    builder.add("mortar", tie)?;
    let g = builder.build().expect("few DOFs").allocate().g().clone();
    let hat = |nodes: &[f64; 3], i: usize, x: f64| {
        let rise = if i > 0 { (x - nodes[i - 1]) / (nodes[i] - nodes[i - 1]) } else { 1.0 };
        let fall = if i < 2 { (nodes[i + 1] - x) / (nodes[i + 1] - nodes[i]) } else { 1.0 };
        rise.min(fall).max(0.0)
    };
    let steps = 20_000;
    for i in 0..3 {
        for k in 0..3 {
            let sum = (0..steps).map(|s| (f64::from(s) + 0.5) / f64::from(steps));
            let truth = sum.map(|x| hat(&slave, i, x) * hat(&master, k, x)).sum::<f64>() / f64::from(steps);
            let found = g.row(2 * i).find(|&(col, _)| col == 2 * (k + 3)).map_or(0.0, |(_, v)| -v);
            assert!((found - truth).abs() < 1e-8, "M({i}, {k}): {found}, {truth}");
        }
    }
    Ok(())
}

/// A wave `u = R(phi) v e^(i k phi)` around the axis satisfies the equations of harmonic k.
#[test]
fn harmonics_pass_cyclic_pairs() -> Outcome {
    let (alpha, k) = (0.7_f64, 3_u32);
    let turn = |phi: f64, x: [f64; 3]| [phi.cos() * x[0] - phi.sin() * x[1], phi.sin() * x[0] + phi.cos() * x[1], x[2]];
    let (x, v, w) = ([1.0, 0.5, 2.0], [0.3, -0.4, 0.5], [0.1, 0.7, -0.2]);
    let (a, b) = (point(0, x), point(1, turn(alpha, x)));
    let turn_of_sector = Turn::about([0.0; 3], [0.0, 0.0, 2.0], alpha)?;
    let real = Cyclic { a, b, turn: turn_of_sector, fields: Turning::Vectors, tolerance: 1e-12 };
    let pair = CyclicHarmonic { real, imaginary_a: [6, 7, 8], imaginary_b: [9, 10, 11], harmonic: k };
    let (sin, cos) = (f64::from(k) * alpha).sin_cos();
    let (rv, rw) = (turn(alpha, v), turn(alpha, w));
    let at_b = [from_fn(|i| cos * rv[i] - sin * rw[i]), from_fn(|i| sin * rv[i] + cos * rw[i])];
    let u = [v, at_b[0], w, at_b[1]].concat();
    let mut builder = ConstraintSet::builder(12);
    builder.add("wave", pair)?;
    assert!(residual(&builder.build().expect("few DOFs"), &u) < 1e-15);
    let mut builder = ConstraintSet::builder(6);
    builder.add("alike", real)?;
    assert!(residual(&builder.build().expect("few DOFs"), &[v, rv].concat()) < 1e-15);
    Ok(())
}

/// Sliding is free, and what separates is the normal part.
#[test]
fn sliding_is_free() -> Outcome {
    let mut builder = ConstraintSet::builder(6);
    builder.add("wall", FluidNormal { structure: [0, 1, 2], fluid: [3, 4, 5], normal: [0.0, 0.0, 5.0] })?;
    builder.add(
        "plane",
        OnPlane {
            point: point(0, [1.0, 2.0, 3.0]),
            plane: Plane::Fixed { through: [0.0, 0.0, 3.0], normal: [0.0, 0.0, -1.0] },
        },
    )?;
    builder.add(
        "line",
        OnLine {
            point: point(1, [1.0, 2.0, 3.0]),
            line: Line::Fixed { through: [1.0, 2.0, 0.0], direction: [0.0, 0.0, 1.0] },
        },
    )?;
    let set = builder.build().expect("few DOFs");
    assert!(residual(&set, &[0.7, -0.2, 0.0, 0.0, 0.0, 0.0]) < 1e-16);
    assert!((residual(&set, &[0.0, 0.0, 0.0, 0.0, 0.0, 0.25]) - 0.25).abs() < 1e-16);
    Ok(())
}

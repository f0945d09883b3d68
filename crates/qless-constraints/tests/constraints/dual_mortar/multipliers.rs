use std::collections::BTreeSet;

use qless::{Options, analyse};
use qless_constraints::types::{Face, Multipliers, Node, Shape, Surface};

use super::{inclined, pair, tied};
use crate::common::Outcome;
use crate::surface_mortar::{FACETS, Mesh};

/// Where meshes match, `int Phi_i N_k = delta_ik d_i`: a tie node by node, without any other entry.
#[test]
fn dual_ties_of_matching_meshes_are_node_by_node() -> Outcome {
    for shape in FACETS {
        let mesh = Mesh { shape, cells: 4, wiggle: 0.4, bend: 0.0 };
        let [slave, master] = pair(mesh, mesh, inclined);
        let set = tied(&slave, &master, Multipliers::Dual, 1e-9)?;
        let (g, n) = (set.allocate().g().clone(), slave.nodes.len());
        for (i, row) in (0..n).map(|i| (i, g.row(i).collect::<Vec<_>>())) {
            let mirrored: Vec<_> = row.iter().filter(|&&(j, _)| j < n).collect();
            assert_eq!(2 * mirrored.len(), row.len(), "{shape:?}, node {i}: {row:?}");
            assert!(mirrored.len() == if shape.nodes() > 4 && mirrored.len() == 3 { 3 } else { 1 });
            for &&(j, v) in &mirrored {
                let other = row.iter().find(|&&(k, _)| k == n + j).map_or(0.0, |&(_, v)| -v);
                assert!((v - other).abs() < 1e-12 * v.abs(), "{shape:?}, ({i}, {j}): {v}, {other}");
            }
        }
    }
    Ok(())
}

/// On a line of two nodes `Phi = (1 -+ 3 xi) / 2`: integrals by a fine rule.
#[test]
fn dual_integrals_are_those_of_the_formula() -> Outcome {
    let nodes = |first: usize, at: &[f64]| -> Surface<2, 1> {
        Surface::polyline(at.iter().enumerate().map(|(i, &x)| Node::of_field(first + i, [x, 0.0])).collect())
    };
    let (slave, master) = ([0.0, 0.4, 1.0], [0.0, 0.55, 0.7, 1.0]);
    let set = tied(&nodes(0, &slave), &nodes(3, &master), Multipliers::Dual, 1e-12)?;
    let g = set.allocate().g().clone();
    let dual = |i: usize, x: f64| {
        let e = usize::from(x > slave[1]);
        let xi = 2.0 * (x - slave[e]) / (slave[e + 1] - slave[e]) - 1.0;
        match i.checked_sub(e) {
            Some(0) => (1.0 - 3.0 * xi) / 2.0,
            Some(1) => f64::midpoint(1.0, 3.0 * xi),
            _ => 0.0,
        }
    };
    let hat = |k: usize, x: f64| {
        let rise = if k > 0 { (x - master[k - 1]) / (master[k] - master[k - 1]) } else { 1.0 };
        let fall = if k < 3 { (master[k + 1] - x) / (master[k + 1] - master[k]) } else { 1.0 };
        rise.min(fall).max(0.0)
    };
    let steps = 20_000;
    for (i, k) in (0..3).flat_map(|i| (0..4).map(move |k| (i, k))) {
        let points = (0..steps).map(|s| (f64::from(s) + 0.5) / f64::from(steps));
        let truth = points.map(|x| dual(i, x) * hat(k, x)).sum::<f64>() / f64::from(steps);
        let found = g.row(i).find(|&(dof, _)| dof == 3 + k).map_or(0.0, |(_, v)| -v);
        assert!((found - truth).abs() < 1e-7, "M({i}, {k}): {found}, {truth}");
    }
    for (i, d) in [0.2, 0.5, 0.3].into_iter().enumerate() {
        let own: Vec<_> = g.row(i).filter(|&(dof, _)| dof < 3).collect();
        assert!(own.len() == 1 && own[0].0 == i && (own[0].1 - d).abs() < 1e-15, "{own:?}");
    }
    Ok(())
}

/// Each slave node depends on the masters over its own facets only, so that T is sparse; with the standard multipliers it is full.
#[test]
fn dual_ties_are_local() -> Outcome {
    let mesh = Mesh { shape: Shape::Quad4, cells: 12, wiggle: 0.3, bend: 0.0 };
    let [slave, master] = pair(mesh, Mesh { cells: 16, ..mesh }, |[x, y]| [x, y, 0.0]);
    let n = slave.nodes.len();
    let set = tied(&slave, &master, Multipliers::Dual, 1e-9)?;
    let g = set.allocate().g().clone();
    let extent = |surface: &Surface<3, 1>, face: &Face| -> [[f64; 2]; 2] {
        let of = |k: usize| face.nodes.iter().map(move |&i| surface.nodes[i].at[k]);
        [0, 1].map(|k| [of(k).fold(9.0, f64::min), of(k).fold(-9.0, f64::max)])
    };
    let touch = |a: [[f64; 2]; 2], b: [[f64; 2]; 2]| (0..2).all(|k| a[k][0] <= b[k][1] && b[k][0] <= a[k][1]);
    for i in 0..n {
        let own = || slave.faces.iter().filter(|face| face.nodes.contains(&i));
        let near = master.faces.iter().filter(|m| own().any(|s| touch(extent(&slave, s), extent(&master, m))));
        let allowed: BTreeSet<usize> = near.flat_map(|face| face.nodes.iter().map(|k| n + k)).chain([i]).collect();
        assert!(g.row(i).all(|(dof, _)| allowed.contains(&dof)), "node {i}");
    }
    let entries = |kind: Multipliers| -> Outcome<usize> {
        let set = tied(&slave, &master, kind, 1e-9)?;
        let reduction = analyse(&crate::common::at_rest(&set, &[])?, &Options::default())?.reduction()?;
        Ok((0..reduction.slaves().len()).map(|i| reduction.row(i).map(|row| row.len())).sum::<Result<usize, _>>()?)
    };
    let [standard, dual] = [entries(Multipliers::Standard)?, entries(Multipliers::Dual)?];
    println!("{n} slave nodes: {standard} entries of T with standard multipliers, {dual} with dual ones");
    // A node of a mesh has few masters over its four facets.
    assert!(dual < 40 * n && standard > 3 * dual, "{standard}, {dual}");
    Ok(())
}

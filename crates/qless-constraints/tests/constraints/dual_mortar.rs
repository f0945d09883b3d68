use std::array::from_fn;
use std::collections::BTreeSet;

use faer::Mat;
use faer::sparse::{SparseColMat, Triplet};
use qless::{Options, analyse};
use qless_constraints::ConstraintSet;
use qless_constraints::enforce::Problem;
use qless_constraints::types::{Face, MortarTie, Multipliers, Node, Shape, Surface};

use crate::hanging::conduct;
use crate::linkages::{Outcome, random};
use crate::surface_mortar::{FACETS, Mesh};

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
    let mut quantities = set.allocate();
    set.evaluate(u, &mut quantities)?;
    // Relative to the terms of each equation.
    let of_row = |row: usize| {
        let size: f64 = quantities.g().row(row).map(|(dof, v)| (v * u[dof]).abs()).sum();
        if size > 0.0 { quantities.c()[row].abs() / size } else { 0.0 }
    };
    Ok((0..set.equations()).map(of_row).fold(0.0, f64::max))
}

fn inclined([x, y]: [f64; 2]) -> [f64; 3] {
    [2.0 * x, x + 3.0 * y, 0.5 * 2.0 * x - 0.25 * (x + 3.0 * y) + 1.0]
}

/// On flat surfaces, for all pairs of shapes, in every unit and far from the origin: linear fields pass, rows sum to zero, D sums to the
/// area, and the rank is full.
#[test]
fn dual_ties_pass_linear_fields() -> Outcome {
    for (a, b) in FACETS.into_iter().flat_map(|a| FACETS.map(|b| (a, b))) {
        for (unit, shift, bend) in
            [(1.0, 0.0, 0.0), (1.0, 0.0, 0.1), (1e-6, 0.0, 0.0), (1e6, 0.0, 0.1), (1.0, 1000.0, 0.0)]
        {
            let mesh = Mesh { shape: a, cells: 3, wiggle: 0.4, bend };
            let place = |x: [f64; 2]| inclined(x).map(|x| unit * x + shift);
            let [slave, master] = pair(mesh, Mesh { shape: b, cells: 4, ..mesh }, place);
            let set = tied(&slave, &master, Multipliers::Dual, 1e-9 * unit)?;
            assert_eq!(set.equations(), slave.nodes.len());
            let field = |[x, y, z]: [f64; 3]| 0.3 + (0.7 * x - 1.1 * y + 0.4 * z) / unit;
            let u: Vec<f64> = slave.nodes.iter().chain(&master.nodes).map(|node| field(node.at)).collect();
            let (off, allowed) = (residual(&set, &u)?, 1e-13 * (1.0 + shift / unit));
            assert!(off < allowed, "{a:?}, {b:?}, {unit}, {shift}: {off}");
            let g = set.allocate().g().clone();
            let d: f64 =
                (0..g.rows()).flat_map(|i| g.row(i)).filter(|&(j, _)| j < slave.nodes.len()).map(|(_, v)| v).sum();
            let area = 6.0 * 1.3125_f64.sqrt() * unit * unit;
            assert!((d - area).abs() < 1e-11 * area * (1.0 + shift), "{a:?}, {b:?}: {d}, {area}");
            let rank = analyse(&crate::linkages::at_rest(&set, &[])?, &Options::default())?.rank();
            assert_eq!(rank, set.equations(), "{a:?}, {b:?}, {unit}, {shift}");
        }
    }
    Ok(())
}

/// The same of lines in the plane and in space, straight ones, with two and three nodes.
#[test]
fn ties_of_lines_pass_linear_fields() -> Outcome {
    let kinds = [Multipliers::Standard, Multipliers::Dual];
    for (quadratic, kind) in [[false, false], [true, false], [false, true], [true, true]]
        .into_iter()
        .flat_map(|q| kinds.map(|kind| (q, kind)))
    {
        for (unit, shift) in [(1.0, 0.0), (1e-6, 0.0), (1e6, 0.0), (1.0, 1000.0)] {
            let place = |s: f64| [1.0, -2.0, 0.5].map(|a| unit * a * s + shift);
            let slave = line(0, 5, quadratic[0], place);
            let master = line(slave.nodes.len(), 7, quadratic[1], place);
            let set = tied(&slave, &master, kind, 1e-9 * unit)?;
            let field = |[x, y, z]: [f64; 3]| 0.3 + (0.7 * x - 1.1 * y + 0.4 * z) / unit;
            let u: Vec<f64> = slave.nodes.iter().chain(&master.nodes).map(|node| field(node.at)).collect();
            let (off, allowed) = (residual(&set, &u)?, 1e-13 * (1.0 + shift / unit));
            assert!(off < allowed, "{quadratic:?}, {kind:?}, {unit}, {shift}: {off}");
            let rank = analyse(&crate::linkages::at_rest(&set, &[])?, &Options::default())?.rank();
            assert_eq!(rank, slave.nodes.len());
        }
    }
    Ok(())
}

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
        let reduction = analyse(&crate::linkages::at_rest(&set, &[])?, &Options::default())?.reduction()?;
        Ok((0..reduction.slaves().len()).map(|i| reduction.row(i).map(|row| row.len())).sum::<Result<usize, _>>()?)
    };
    let [standard, dual] = [entries(Multipliers::Standard)?, entries(Multipliers::Dual)?];
    println!("{n} slave nodes: {standard} entries of T with standard multipliers, {dual} with dual ones");
    // A node of a mesh has few masters over its four facets.
    assert!(dual < 40 * n && standard > 3 * dual, "{standard}, {dual}");
    Ok(())
}

/// A smooth field arrives with an error of order h^2, with either kind.
#[test]
fn ties_converge_with_the_square_of_the_size() -> Outcome {
    let field = |[x, y, _]: [f64; 3]| (2.0 * x).sin() * (1.5 * y).cos();
    for kind in [Multipliers::Standard, Multipliers::Dual] {
        let mut errors = Vec::new();
        for cells in [6, 12, 24] {
            let mesh = Mesh { shape: Shape::Quad4, cells, wiggle: 0.0, bend: 0.0 };
            let [slave, master] = pair(mesh, Mesh { cells: cells * 4 / 3, ..mesh }, |[x, y]| [x, y, 0.0]);
            let set = tied(&slave, &master, kind, 1e-9)?;
            let (g, n) = (set.allocate().g().clone(), slave.nodes.len());
            // D u = M v, dense.
            let (mut d, mut rhs) = (Mat::<f64>::zeros(n, n), Mat::<f64>::zeros(n, 1));
            for i in 0..n {
                for (j, v) in g.row(i) {
                    if j < n { d[(i, j)] = v } else { rhs[(i, 0)] -= v * field(master.nodes[j - n].at) }
                }
            }
            let u = faer::linalg::solvers::Solve::solve(&d.partial_piv_lu(), &rhs);
            let off = |(i, node): (usize, &Node<3, 1>)| (u[(i, 0)] - field(node.at)).abs();
            errors.push(slave.nodes.iter().enumerate().map(off).fold(0.0, f64::max));
        }
        println!("{kind:?}: {errors:?}");
        assert!(errors.windows(2).all(|pair| pair[0] / pair[1] > 3.0), "{kind:?}: {errors:?}");
    }
    Ok(())
}

/// Two meshes of an arc that do not match, in the plane: constants pass, and lengths come near to the truth.
#[test]
fn curved_lines_pass_constants() -> Outcome {
    for (quadratic, kind) in [(false, Multipliers::Dual), (true, Multipliers::Dual), (true, Multipliers::Standard)] {
        let arc = |s: f64| [(2.0 * s).cos(), (2.0 * s).sin()];
        let slave = line(0, 9, quadratic, arc);
        let master = line(slave.nodes.len(), 13, quadratic, arc);
        let set = tied(&slave, &master, kind, 0.02)?;
        assert!(residual(&set, &vec![1.0; set.dofs()])? < 1e-14);
        let g = set.allocate().g().clone();
        let d: f64 = (0..g.rows()).flat_map(|i| g.row(i)).filter(|&(j, _)| j < slave.nodes.len()).map(|(_, v)| v).sum();
        assert!((d - 2.0).abs() < 0.02, "{d}");
    }
    Ok(())
}

/// A tie of lines turned in the plane has the coefficients that it had.
#[test]
fn ties_do_not_depend_on_direction() -> Outcome {
    for kind in [Multipliers::Standard, Multipliers::Dual] {
        let of = |angle: f64| -> Outcome<_> {
            let place = |s: f64| [s * angle.cos(), s * angle.sin()];
            let slave = line(0, 4, true, place);
            let mut master = line(slave.nodes.len(), 3, false, place);
            // In any order and direction.
            master.faces.reverse();
            master.faces[0].nodes.reverse();
            Ok(tied(&slave, &master, kind, 1e-9)?.allocate().g().clone())
        };
        let truth = of(0.0)?;
        for angle in [0.7, 1.0 + std::f64::consts::PI, std::f64::consts::FRAC_PI_2] {
            let g = of(angle)?;
            for i in 0..g.rows() {
                assert_eq!(
                    g.row(i).map(|(j, _)| j).collect::<Vec<_>>(),
                    truth.row(i).map(|(j, _)| j).collect::<Vec<_>>()
                );
                assert!(g.row(i).zip(truth.row(i)).all(|((_, a), (_, b))| (a - b).abs() < 1e-14), "{angle}, row {i}");
            }
        }
    }
    Ok(())
}

/// A plate of two rows of elements on the unit square that do not match: a constant flow passes the interface exactly, with insulated
/// sides, whichever row is the slave, turned, in every unit of length and of conductivity.
#[test]
fn a_constant_flow_passes_rows_that_do_not_match() -> Outcome {
    let kinds = [Multipliers::Standard, Multipliers::Dual];
    let counts = [[3, 4], [4, 3], [5, 2]];
    for ((cells, kind), (unit, angle)) in counts
        .into_iter()
        .flat_map(|cells| kinds.map(|kind| (cells, kind)))
        .flat_map(|case| [(1.0, 0.0), (1.0, 0.7), (1e-6, 2.0), (1e6, -1.0)].map(|place| (case, place)))
    {
        let (sin, cos) = f64::sin_cos(angle);
        let turned = |[x, y]: [f64; 2]| [cos * x - sin * y, sin * x + cos * y].map(|x| unit * (x + 3.0));
        let first = [0, 2 * (cells[0] + 1)];
        let flat = |row: usize, i: usize| {
            let side = cells[row] + 1;
            [(i % side) as f64 / cells[row] as f64, (row + i / side) as f64 / 2.0]
        };
        let (mut k, mut edges) = (Vec::new(), Vec::new());
        for row in 0..2 {
            let (side, low) = (cells[row] + 1, first[row]);
            for cell in 0..cells[row] {
                let corners = [cell, cell + 1, cell + 1 + side, cell + side].map(|i| low + i);
                k.extend(conduct(corners, [1.0 / cells[row] as f64, 0.5]));
            }
            // The upper edge of the lower row, and the lower one of the upper row.
            let edge = (0..side).map(|i| if row == 0 { side + i } else { i });
            edges.push(Surface::polyline(edge.map(|i| Node::of_field(low + i, turned(flat(row, i)))).collect()));
        }
        let dofs = first[1] + 2 * (cells[1] + 1);
        let places: Vec<_> = (0..dofs).map(|i| if i < first[1] { flat(0, i) } else { flat(1, i - first[1]) }).collect();
        let [slave, master] = [edges[0].clone(), edges[1].clone()];
        let mut builder = ConstraintSet::builder(dofs);
        builder.add("interface", MortarTie { slave, master, multipliers: kind, tolerance: 1e-9 * unit })?;
        let set = builder.build().expect("few DOFs");
        let truth = |[_, y]: [f64; 2]| 20.0 - 7.0 * y;
        let outer = (0..dofs).filter(|&i| places[i][1] == 0.0 || places[i][1] == 1.0);
        let held: Vec<_> = outer.map(|i| (i, truth(places[i]))).collect();
        for conductivity in [1.0, 1e-6, 1e6] {
            let scaled: Vec<_> = k.iter().map(|t| Triplet::new(t.row, t.col, conductivity * t.val)).collect();
            let k = SparseColMat::try_new_from_triplets(dofs, dofs, &scaled)?;
            let system = crate::linkages::at_rest(&set, &held)?;
            let solution = Problem::new(&k, &vec![0.0; dofs], &system)?.transformation()?;
            let off = |i: usize| (solution.u[i] - truth(places[i])).abs();
            let most = (0..dofs).map(off).fold(0.0, f64::max);
            assert!(most < 20.0 * 1e-14, "{cells:?}, {kind:?}, {unit}, {angle}, {conductivity}: {most}");
        }
    }
    Ok(())
}

/// The same bits with one thread and with four.
#[test]
fn threads_do_not_change_a_bit() {
    for kind in [Multipliers::Standard, Multipliers::Dual] {
        let mesh = Mesh { shape: Shape::Quad8, cells: 9, wiggle: 0.4, bend: 0.1 };
        let [slave, master] = pair(mesh, Mesh { shape: Shape::Tri6, cells: 11, ..mesh }, inclined);
        let with = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            pool.install(|| tied(&slave, &master, kind, 1e-9).expect("tied").allocate().g().clone())
        };
        assert_eq!(with(1), with(4));
    }
}

/// Interfaces that share slave nodes, and one that is said twice in the other direction: the rank is that of the SVD.
#[test]
fn ranks_are_those_of_the_svd() -> Outcome {
    for (kind, twice) in [
        (Multipliers::Standard, false),
        (Multipliers::Dual, false),
        (Multipliers::Standard, true),
        (Multipliers::Dual, true),
    ] {
        let along = |s: f64| [s, 0.0];
        let up = |s: f64| [0.0, s];
        let (slave, master) = (line(0, 4, false, along), line(5, 3, false, along));
        // The first slave node is that of the corner.
        let mut side = line(8, 4, false, up);
        side.nodes[0] = slave.nodes[0];
        let wall = line(13, 5, true, up);
        let mut builder = ConstraintSet::builder(24);
        builder.add(
            "floor",
            MortarTie { slave: slave.clone(), master: master.clone(), multipliers: kind, tolerance: 1e-9 },
        )?;
        builder.add("wall", MortarTie { slave: side, master: wall, multipliers: kind, tolerance: 1e-9 })?;
        if twice {
            builder
                .add("floor again", MortarTie { slave: master, master: slave, multipliers: kind, tolerance: 1e-9 })?;
        }
        let set = builder.build().expect("few DOFs");
        let quantities = set.allocate();
        let mut dense = Mat::<f64>::zeros(set.equations(), 24);
        (0..set.equations()).for_each(|i| quantities.g().row(i).for_each(|(j, v)| dense[(i, j)] = v));
        let sizes = dense.singular_values().map_err(|error| format!("{error:?}"))?;
        let rank = sizes.iter().filter(|&&s| s > 1e-12 * sizes[0]).count();
        let found = analyse(&crate::linkages::at_rest(&set, &[])?, &Options::default())?.rank();
        assert_eq!(found, rank, "{kind:?}, {twice}: {sizes:?}");
        println!("{kind:?}, said twice {twice}: rank {rank} of {}", set.equations());
    }
    Ok(())
}

/// A border of the slave side that the tolerance allows to be bare: linear fields pass all the same.
#[test]
fn bare_borders_pass_linear_fields() -> Outcome {
    for (shape, kind) in
        FACETS.into_iter().flat_map(|s| [Multipliers::Standard, Multipliers::Dual].map(|kind| (s, kind)))
    {
        let mesh = Mesh { shape, cells: 4, wiggle: 0.3, bend: 0.0 };
        let slave = of_field(&mesh.surface(0, |[x, y]| [x, y, 0.0]), 0);
        let smaller = Mesh { cells: 3, ..mesh }.surface(0, |[x, y]| [0.01 + 0.98 * x, 0.008 + 0.985 * y, 0.0]);
        let master = of_field(&smaller, slave.nodes.len());
        assert!(tied(&slave, &master, kind, 1e-3).is_err());
        let set = tied(&slave, &master, kind, 0.015)?;
        let u: Vec<f64> = slave.nodes.iter().chain(&master.nodes).map(|n| 1.0 + 2.0 * n.at[0] - n.at[1]).collect();
        assert!(residual(&set, &u)? < 1e-12, "{shape:?}, {kind:?}: {}", residual(&set, &u)?);
        let rank = analyse(&crate::linkages::at_rest(&set, &[])?, &Options::default())?.rank();
        assert_eq!(rank, set.equations(), "{shape:?}, {kind:?}");
    }
    Ok(())
}

#[test]
fn facets_of_other_dimensions_are_refused() {
    let square = |first: usize| -> Surface<2, 1> {
        let at = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let nodes = (0..4).map(|i| Node::of_field(first + i, at[i])).collect();
        Surface { nodes, faces: vec![Face::new(Shape::Quad4, [0, 1, 2, 3])] }
    };
    let tie = MortarTie { slave: square(0), master: square(4), multipliers: Multipliers::Dual, tolerance: 1.0 };
    let words =
        ConstraintSet::builder(8).add("it", tie).map_or_else(|error| error.to_string(), |_| "accepted".to_owned());
    assert!(
        words.contains("facet 1, from 1, of the slave side is a Quad4; the facets of both sides must be lines"),
        "{words}"
    );
    let solid = |first: usize| -> Surface<3, 1> {
        let at: [[f64; 3]; 4] = from_fn(|i| from_fn(|k| f64::from(u8::from(i == k + 1))));
        let nodes = (0..4).map(|i| Node::of_field(first + i, at[i])).collect();
        Surface { nodes, faces: vec![Face::new(Shape::Tet4, [0, 1, 2, 3])] }
    };
    let tie = MortarTie { slave: solid(0), master: solid(4), multipliers: Multipliers::Standard, tolerance: 1.0 };
    let words =
        ConstraintSet::builder(8).add("it", tie).map_or_else(|error| error.to_string(), |_| "accepted".to_owned());
    assert!(words.contains("slave side is a Tet4"), "{words}");
}

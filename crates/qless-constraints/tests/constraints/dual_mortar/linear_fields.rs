use qless::{Options, analyse};
use qless_constraints::types::Multipliers;

use super::{inclined, line, of_field, pair, residual, tied};
use crate::common::Outcome;
use crate::surface_mortar::{FACETS, Mesh};

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
            let rank = analyse(&crate::common::at_rest(&set, &[])?, &Options::default())?.rank();
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
            let rank = analyse(&crate::common::at_rest(&set, &[])?, &Options::default())?.rank();
            assert_eq!(rank, slave.nodes.len());
        }
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
        let rank = analyse(&crate::common::at_rest(&set, &[])?, &Options::default())?.rank();
        assert_eq!(rank, set.equations(), "{shape:?}, {kind:?}");
    }
    Ok(())
}

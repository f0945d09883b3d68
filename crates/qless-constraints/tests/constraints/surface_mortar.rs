use std::array::from_fn;
use std::collections::BTreeMap;

use qless::{Options, analyse};
use qless_constraints::ConstraintSet;
use qless_constraints::types::{Face, MortarTie, Multipliers, PlanarPoint, Point, Shape, Surface};

use crate::common::{Outcome, field, random};

pub const FACETS: [Shape; 5] = [Shape::Tri3, Shape::Quad4, Shape::Tri6, Shape::Quad8, Shape::Quad9];

/// How the square [0, 1] x [0, 1] is meshed.
#[derive(Clone, Copy)]
pub struct Mesh {
    pub shape: Shape,
    /// Cells in each direction; triangles are halves of cells.
    pub cells: usize,
    /// How far inner corners are moved, in cells.
    pub wiggle: f64,
    /// How far the middles of inner edges are moved from the straight edge, in cells.
    pub bend: f64,
}

impl Mesh {
    /// Corners of the facets on a lattice of half cells, so that middles of edges have places too.
    fn outlines(self) -> Vec<Vec<[usize; 2]>> {
        let corner = |i: usize, j: usize| [[0, 0], [2, 0], [2, 2], [0, 2]].map(|[p, q]| [2 * i + p, 2 * j + q]);
        let split = |[a, b, c, d]: [[usize; 2]; 4]| match self.shape {
            Shape::Quad4 | Shape::Quad8 | Shape::Quad9 => vec![vec![a, b, c, d]],
            _ => vec![vec![a, b, c], vec![a, c, d]],
        };
        (0..self.cells * self.cells).flat_map(|k| split(corner(k % self.cells, k / self.cells))).collect()
    }

    fn corner(self, at: [usize; 2]) -> [f64; 2] {
        let size = 2 * self.cells;
        let off = |k: usize, seed: usize| self.wiggle * random(seed) * f64::from(u8::from(!at[k].is_multiple_of(size)));
        from_fn(|k| (at[k] as f64 / 2.0 + off(k, 90 * at[0] + 7 * at[1] + k)) / self.cells as f64)
    }

    fn middle(self, a: [usize; 2], b: [usize; 2]) -> [f64; 2] {
        let (size, sum) = (4 * self.cells, [a[0] + b[0], a[1] + b[1]]);
        let inner = !sum.iter().any(|s| s.is_multiple_of(size));
        let off =
            |k: usize| if inner { self.bend * random(31 * sum[0] + 5 * sum[1] + k) / self.cells as f64 } else { 0.0 };
        from_fn(|k| f64::midpoint(self.corner(a)[k], self.corner(b)[k]) + off(k))
    }

    /// The surface, bent into space by `place`, with DOFs from `3 * first` on.
    pub fn surface(self, first: usize, place: impl Fn([f64; 2]) -> [f64; 3]) -> Surface<3> {
        let (mut numbers, mut nodes, mut faces) = (BTreeMap::new(), Vec::new(), Vec::new());
        for outline in self.outlines() {
            let ends = || outline.iter().zip(outline.iter().cycle().skip(1));
            let mut all: Vec<_> = outline.iter().map(|&at| ([2 * at[0], 2 * at[1]], self.corner(at))).collect();
            if self.shape.nodes() > outline.len() {
                all.extend(ends().map(|(&a, &b)| ([a[0] + b[0], a[1] + b[1]], self.middle(a, b))));
            }
            if self.shape == Shape::Quad9 {
                let (a, c) = (outline[0], outline[2]);
                let mean = from_fn(|k| outline.iter().map(|&at| self.corner(at)[k]).sum::<f64>() / 4.0);
                all.push(([a[0] + c[0], a[1] + c[1]], mean));
            }
            let number = |(key, at)| {
                *numbers.entry(key).or_insert_with(|| {
                    nodes.push(Point::new(from_fn(|k| 3 * (first + nodes.len()) + k), place(at)));
                    nodes.len() - 1
                })
            };
            faces.push(Face::new(self.shape, all.into_iter().map(number).collect::<Vec<_>>()));
        }
        Surface { nodes, faces }
    }
}

fn tied(slave: &Surface<3>, master: &Surface<3>, tolerance: f64) -> Outcome<ConstraintSet> {
    tied_by(Multipliers::Standard, slave, master, tolerance)
}

fn tied_by(
    multipliers: Multipliers,
    slave: &Surface<3>,
    master: &Surface<3>,
    tolerance: f64,
) -> Outcome<ConstraintSet> {
    let mut builder = ConstraintSet::builder(3 * (slave.nodes.len() + master.nodes.len()));
    let (slave, master) = (slave.clone(), master.clone());
    builder.add("tie", MortarTie { slave, master, multipliers, tolerance })?;
    Ok(builder.build().expect("few DOFs"))
}

fn pair(slave: Mesh, master: Mesh, place: impl Fn([f64; 2]) -> [f64; 3]) -> (Surface<3>, Surface<3>) {
    let first = slave.surface(0, &place);
    let second = master.surface(first.nodes.len(), &place);
    (first, second)
}

/// Sums of D and of M over the rows of one component; every row sums to zero.
#[track_caller]
fn sums(set: &ConstraintSet, slaves: usize) -> [f64; 2] {
    let g = set.allocate().g().clone();
    let mut totals = [0.0; 2];
    for row in 0..set.equations() {
        let size: f64 = g.row(row).map(|(_, v)| v.abs()).sum();
        assert!(
            g.row(row).map(|(_, v)| v).sum::<f64>().abs() < 1e-14 * size,
            "{}",
            set.label(row).expect("of this set")
        );
        if row % 3 == 0 {
            g.row(row).for_each(|(dof, v)| totals[usize::from(dof >= 3 * slaves)] += v);
        }
    }
    [totals[0], -totals[1]]
}

/// On the plane z = 0.5 x - 0.25 y + 1.
pub fn inclined([x, y]: [f64; 2]) -> [f64; 3] {
    [2.0 * x, x + 3.0 * y, 0.5 * 2.0 * x - 0.25 * (x + 3.0 * y) + 1.0]
}

/// On a flat surface: rows sum to zero, D and M to the area, and what is linear passes, for all pairs of shapes, edges bent too.
#[test]
fn flat_surfaces_pass_linear_fields() -> Outcome {
    let area = 6.0 * 1.3125_f64.sqrt();
    for (a, b, bend) in
        FACETS.into_iter().flat_map(|a| FACETS.into_iter().flat_map(move |b| [(a, b, 0.0), (a, b, 0.1)]))
    {
        let slave = Mesh { shape: a, cells: 3, wiggle: 0.4, bend };
        let (slave, master) = pair(slave, Mesh { shape: b, cells: 4, ..slave }, inclined);
        let set = tied(&slave, &master, 1e-12)?;
        assert_eq!(set.equations(), 3 * slave.nodes.len());
        let [d, m] = sums(&set, slave.nodes.len());
        assert!((d - area).abs() < 1e-12 * area && (m - area).abs() < 1e-12 * area, "{a:?}, {b:?}: {d}, {m}, {area}");
        let u: Vec<f64> = slave.nodes.iter().chain(&master.nodes).flat_map(|node| field(node.at)).collect();
        let mut evaluation = set.allocate();
        set.evaluate(&u, &mut evaluation).expect("of this set");
        for row in 0..set.equations() {
            let size: f64 = evaluation.g().row(row).map(|(dof, v)| (v * u[dof]).abs()).sum();
            assert!(evaluation.c()[row].abs() < 1e-12 * size, "{a:?}, {b:?}, {}", set.label(row).expect("of this set"));
        }
    }
    Ok(())
}

/// Where the meshes match, elimination finds `u_s = u_m`, whichever side its slaves are on.
#[test]
fn matching_meshes_move_together() -> Outcome {
    for shape in FACETS {
        let mesh = Mesh { shape, cells: 3, wiggle: 0.4, bend: 0.0 };
        let (slave, master) = pair(mesh, mesh, inclined);
        let set = tied(&slave, &master, 1e-12)?;
        let mut evaluation = set.allocate();
        set.evaluate(&vec![0.0; set.dofs()], &mut evaluation)?;
        let system = set.linearised(&evaluation, &[])?;
        let analysis = analyse(&system, &Options::default())?;
        assert_eq!(analysis.rank(), set.equations());
        let reduction = analysis.reduction().expect("within the gate");
        let masters: Vec<f64> = (0..reduction.masters().len()).map(random).collect();
        let u = reduction.expand(&masters, &[]).expect("of its lengths");
        let (one, other) = u.split_at(3 * slave.nodes.len());
        let off = one.iter().zip(other).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
        assert!(off < 1e-12, "{shape:?}: {off:e}");
    }
    Ok(())
}

/// On rectangles `D` and `M` are tensor products of those of lines.
#[test]
fn integrals_on_rectangles_are_products() -> Outcome {
    let line = |i: usize, x: f64| PlanarPoint::new([2 * i, 2 * i + 1], [x, 0.0]);
    let slave: Vec<_> = (0..3).map(|i| line(i, i as f64 / 2.0)).collect();
    let master: Vec<_> = (0..4).map(|i| line(3 + i, i as f64 / 3.0)).collect();
    let mut builder = ConstraintSet::builder(14);
    let [slave, master] = [slave, master].map(Surface::polyline);
    builder.add("line", MortarTie { slave, master, multipliers: Multipliers::Standard, tolerance: 1e-12 })?;
    let along = builder.build().expect("few DOFs").allocate().g().clone();
    let of_line = |i: usize, j: usize| along.row(2 * i).find(|&(dof, _)| dof == 2 * j).map_or(0.0, |(_, v)| v);
    let mesh = |cells: usize| Mesh { shape: Shape::Quad4, cells, wiggle: 0.0, bend: 0.0 };
    let (slave, master) = pair(mesh(2), mesh(3), |[x, y]| [x, y, 0.5]);
    let g = tied(&slave, &master, 1e-12)?.allocate().g().clone();
    let place = |at: [f64; 3], cells: f64, k: usize| (at[k] * cells).round() as usize;
    for (i, node) in slave.nodes.iter().enumerate() {
        for (j, other) in slave.nodes.iter().chain(&master.nodes).enumerate() {
            let (first, cells, sign) = if j < slave.nodes.len() { (0, 2.0, 1.0) } else { (3, 3.0, -1.0) };
            let [x, y] = from_fn(|k| of_line(place(node.at, 2.0, k), first + place(other.at, cells, k)));
            let found = g.row(3 * i).find(|&(dof, _)| dof == 3 * j).map_or(0.0, |(_, v)| v);
            assert!((found - sign * x * y).abs() < 1e-15, "({i}, {j}): {found}, {}", sign * x * y);
        }
    }
    Ok(())
}

/// On a quarter of a cylinder, where facets of the two sides are apart, constants still pass, and areas come near to the truth.
#[test]
fn curved_surfaces_pass_constants() -> Outcome {
    let round = |[x, y]: [f64; 2]| [(1.5 * x).cos(), (1.5 * x).sin(), y];
    for (a, b) in [
        (Shape::Quad4, Shape::Tri3),
        (Shape::Tri3, Shape::Quad8),
        (Shape::Quad8, Shape::Tri6),
        (Shape::Quad9, Shape::Quad8),
    ] {
        let slave = Mesh { shape: a, cells: 7, wiggle: 0.3, bend: 0.0 };
        let (slave, master) = pair(slave, Mesh { shape: b, cells: 5, ..slave }, round);
        for kind in [Multipliers::Standard, Multipliers::Dual] {
            let [d, m] = sums(&tied_by(kind, &slave, &master, 0.03)?, slave.nodes.len());
            assert!((d - m).abs() < 1e-13 && (d - 1.5).abs() < 0.02, "{a:?}, {b:?}, {kind:?}: {d}, {m}");
        }
    }
    Ok(())
}

/// Facets that face each other, as those of two bodies do, have the same integrals as facets that face the same way.
#[test]
fn orientation_does_not_matter() -> Outcome {
    let slave = Mesh { shape: Shape::Tri3, cells: 3, wiggle: 0.4, bend: 0.0 };
    let (slave, master) = pair(slave, Mesh { cells: 2, ..slave }, inclined);
    let turned = |surface: &Surface<3>| {
        let faces = surface.faces.iter().map(|f| Face::new(f.shape, f.nodes.iter().rev().copied().collect::<Vec<_>>()));
        Surface { faces: faces.collect(), nodes: surface.nodes.clone() }
    };
    let truth = tied(&slave, &master, 1e-12)?.allocate().g().clone();
    for (slave, master) in [(turned(&slave), master.clone()), (slave.clone(), turned(&master))] {
        let g = tied(&slave, &master, 1e-12)?.allocate().g().clone();
        for i in 0..truth.rows() {
            assert!(g.row(i).zip(truth.row(i)).all(|((j, a), (k, b))| j == k && (a - b).abs() < 1e-15), "row {i}");
        }
    }
    Ok(())
}

/// A Quad4 that names a corner twice is a triangle.
#[test]
fn collapsed_facets_pass_linear_fields() -> Outcome {
    let mesh = Mesh { shape: Shape::Tri3, cells: 2, wiggle: 0.4, bend: 0.0 };
    let (slave, master) = pair(mesh, Mesh { cells: 3, ..mesh }, inclined);
    let collapsed = |surface: &Surface<3>| {
        let faces =
            surface.faces.iter().map(|f| Face::new(Shape::Quad4, [f.nodes[0], f.nodes[1], f.nodes[2], f.nodes[2]]));
        Surface { faces: faces.collect(), nodes: surface.nodes.clone() }
    };
    let pairs = [(collapsed(&slave), master.clone()), (slave.clone(), collapsed(&master))];
    let kinds = [Multipliers::Standard, Multipliers::Dual];
    for ((slave, master), kind) in pairs.into_iter().flat_map(|pair| kinds.map(|kind| (pair.clone(), kind))) {
        let set = tied_by(kind, &slave, &master, 1e-12)?;
        let [d, m] = sums(&set, slave.nodes.len());
        let area = 6.0 * 1.3125_f64.sqrt();
        assert!((d - area).abs() < 1e-12 * area && (m - area).abs() < 1e-12 * area);
        let u: Vec<f64> = slave.nodes.iter().chain(&master.nodes).flat_map(|node| field(node.at)).collect();
        let mut evaluation = set.allocate();
        set.evaluate(&u, &mut evaluation).expect("of this set");
        assert!(evaluation.c().iter().all(|c| c.abs() < 1e-13));
    }
    Ok(())
}

//! `qless-constraints`: sets, types, Newton, enforcement.

use faer::sparse::{SparseColMat, Triplet};
use qless::{Options, SystemBuilder, analyse};
use qless_constraints::scalar::{Dual, Scalar, vector};
use qless_constraints::types::{
    Average, BeamToSolid, Body, Cyclic, CyclicHarmonic, Distance, Equal, Face, FaceSearch, Fixed, FluidNode,
    FluidNormal, FluidWall, HangingNode, Line, LineTie, LinearEquation, MacroStrain, MortarTie, Multipliers, Node6,
    NodeTie, OnLine, OnPlane, OnSphere, OrderTie, Periodic, PlanarPoint, Plane, Point, Prescribed, Prismatic, Revolute,
    RigidBody, Section, Shape, ShellToSolid, SmallRigidBody, Spherical, Surface, ThicknessLine, Turn, Turning,
    Universal, Volume,
};
use qless_constraints::{Constraint, ConstraintSet, EquationSink, Nonlinear};
use qless_solve::enforce::{BlockPlan, Problem, reduced};
use qless_solve::newton::{NewtonOptions, redundancies, solve};

use super::{BAD, HUGE, refused, survives};

/// Two points in the plane that a rod joins, one on a circle.
fn linkage() -> ConstraintSet {
    let (p, q) = (PlanarPoint::new([0, 1], [1.0, 0.0]), PlanarPoint::new([2, 3], [3.0, 0.5]));
    let mut builder = ConstraintSet::builder(4);
    builder.add("rod", Distance::new(p, q)).expect("a rod");
    builder.add("crank", OnSphere { point: p, centre: [0.0; 2], radius: None }).expect("a crank");
    builder.add("guide", Equal::new([2, 3])).expect("a guide");
    builder.build().expect("few DOFs")
}

#[test]
fn sets_take_their_own_only() {
    let (set, twin) = (linkage(), linkage());
    let (mut own, mut foreign) = (set.allocate(), twin.allocate());
    for count in [0, 3, 5] {
        let u = vec![0.0; count];
        refused("u", || set.evaluate(&u, &mut own));
        refused("u", || set.effective_hessian(&u, &[0.0; 3], &mut own));
        refused("u", || set.assemble(&u, &[0.0; 3], &mut own));
    }
    for count in [0, 2, 4] {
        refused("weights", || set.effective_hessian(&[0.0; 4], &vec![0.0; count], &mut own));
        refused("weights", || set.assemble(&[0.0; 4], &vec![0.0; count], &mut own));
    }
    refused("of a twin", || set.evaluate(&[0.0; 4], &mut foreign));
    refused("of a twin", || set.effective_hessian(&[0.0; 4], &[0.0; 3], &mut foreign));
    refused("of a twin", || set.assemble(&[0.0; 4], &[0.0; 3], &mut foreign));
    refused("of a twin", || set.linearised(&foreign, &[]));
    refused("a constraint", || set.rows_of(twin.constraint_of(0).expect("a row")));
    assert_eq!(ConstraintSet::builder(0).build().expect("empty").linear_rows(), 0..0);
    for row in [3, usize::MAX] {
        assert!(!set.linear_rows().contains(&row));
        refused("a row", || set.label(row));
        refused("a row", || set.constraint_of(row));
        assert!(!survives("a row", || set.is_linear(row)));
    }
    for bad in BAD {
        survives("evaluated", || set.assemble(&[bad; 4], &[bad; 3], &mut own)).expect("what is not finite stays so");
        refused("linearised", || set.linearised(&own, &[]));
    }
    set.evaluate(&[0.0; 4], &mut own).expect("its own");
    for prescribed in [vec![(4, 0.0)], vec![(usize::MAX, 0.0)], vec![(0, f64::NAN)], vec![(0, 0.0), (0, 1.0)]] {
        refused("prescribed", || set.linearised(&own, &prescribed));
    }
    for dofs in HUGE {
        refused("DOFs", || ConstraintSet::builder(dofs).build().map(drop));
    }
    survives("no DOFs", || ConstraintSet::builder(0).build().map(|set| set.allocate())).expect("empty");
}

/// Adds a constraint and, if it is accepted, evaluates it; neither may panic.
fn take<C: Constraint>(constraint: C) {
    survives(C::NAME, || {
        let mut builder = ConstraintSet::builder(40);
        if let Err(error) = builder.add("it", constraint) {
            assert!(error.to_string().contains(C::NAME), "{error}");
        }
        let set = builder.build().expect("few DOFs");
        let mut evaluation = set.allocate();
        for u in [0.0, 1e-3, 1e200, f64::NAN] {
            set.assemble(&vec![u; set.dofs()], &vec![1.0; set.equations()], &mut evaluation).expect("its own");
        }
    });
}

/// Every type with this number and this DOF in it.
fn every_type(x: f64, dof: usize) {
    let point = |i: usize, at: [f64; 3]| Point::new([3 * i, 3 * i + 1, 3 * i + 2], at);
    let (odd, p) = (Point::new([dof, 0, 1], [x, 0.0, 1.0]), point(1, [1.0, x, 0.0]));
    let (q, r, s) = (point(2, [0.0, 1.0, 0.0]), point(3, [0.0, 0.0, 1.0]), point(4, [x; 3]));
    let flat = |i: usize, a: f64| PlanarPoint::new([2 * i, 2 * i + 1], [a, 0.0]);
    let (axis, at) = ([0.0, x, 1.0], [x; 3]);
    let body = Body::with_vector([0, 1, dof], at, [3, 4, 5]);
    let euler = Body::with_euler([6, 7, 8], [0.0; 3], [9, 10, 11, dof]);
    take(LinearEquation { terms: vec![(dof, x), (0, 1.0)], rhs: x });
    take(Prescribed { values: vec![(dof, x)] });
    take(Equal::new([dof, 0]));
    take(Distance { length: Some(x), ..Distance::new(odd, p) });
    take(FluidNormal { structure: [0, 1, dof], fluid: [3, 4, 5], normal: [x; 3] });
    if let Ok(turn) = Turn::about(at, axis, x) {
        let pair = Cyclic { a: odd, b: p, turn, fields: Turning::Vectors, tolerance: x };
        take(pair);
        take(CyclicHarmonic { real: pair, imaginary_a: [20, 21, dof], imaginary_b: [23, 24, 25], harmonic: u32::MAX });
    }
    take(HangingNode { node: [dof], shape: Shape::Line3, parent: vec![[0], [1], [2]], at: [x; 2] });
    take(OrderTie { fine: vec![(0.0, [dof]), (x, [3]), (1.0, [4])], coarse: vec![(0.0, [0]), (x, [1])] });
    let reference = Node6::new(odd.dofs, [30, 31, dof], odd.at);
    take(Average { reference, nodes: vec![(p.into(), x), (q.into(), 1.0), (r.into(), 1.0)] });
    let partial = Node6 { dofs: [Some(6), None, Some(dof), None, Some(40), None], at: [x, 1.0, 0.0], local: None };
    take(SmallRigidBody {
        reference: Node6::new(odd.dofs, [30, 31, 32], odd.at),
        nodes: vec![p.into(), q.into(), partial],
    });
    take(RigidBody { body, nodes: vec![q.into(), partial] });
    take(RigidBody { body: euler, nodes: vec![s.into()] });
    couplings(odd, [p, q, r, s], x, dof);
    take(Periodic { a: odd, b: p, strain: MacroStrain::Given([[x; 3]; 3]) });
    take(OnSphere { point: odd, centre: at, radius: Some(x) });
    take(OnLine { point: q, line: Line::Nodes(p, odd) });
    take(OnPlane { point: q, plane: Plane::Fixed { through: at, normal: [x; 3] } });
    take(OnPlane { point: q, plane: Plane::Nodes(p, r, odd) });
    take(LineTie { slave: vec![flat(1, x)], master: vec![flat(2, 0.0), flat(3, x)], tolerance: x });
    let surface = |z: f64| Surface {
        nodes: vec![odd, point(5, [1.0, 0.0, z]), point(6, [1.0, 1.0, z]), point(7, [0.0, 1.0, x])],
        faces: vec![Face::new(Shape::Quad4, [0, 1, 2, 3])],
    };
    for multipliers in [Multipliers::Standard, Multipliers::Dual] {
        let line = |i: usize, j: usize| Surface::polyline(vec![flat(i, 0.0), flat(j, x)]);
        take(MortarTie { slave: line(1, 4), master: line(2, 3), multipliers, tolerance: x });
        take(MortarTie { slave: surface(0.0), master: surface(x), multipliers, tolerance: x });
    }
    for shape in [Shape::Line2, Shape::Tri3, Shape::Quad4] {
        take(NodeTie { node: odd, shape, face: vec![p, q, r, s][..shape.nodes()].to_vec(), tolerance: x });
        take(NodeTie { node: q, shape, face: vec![], tolerance: f64::NAN });
    }
    for (shape, count) in
        [(Shape::Tet4, 4), (Shape::Pyramid5, 5), (Shape::Wedge6, 6), (Shape::Hex8, 8), (Shape::Hex20, 20)]
    {
        let face = [p, q, r, s, odd].into_iter().cycle().take(count).collect();
        take(NodeTie { node: odd, shape, face, tolerance: x });
    }
    take(Volume { nodes: vec![p, q, r, odd], tetrahedra: vec![[0, 1, 2, 3], [0, 1, 2, dof]] });
    take(Spherical { a: body, b: euler, at });
    take(Revolute { a: body, b: euler, at, axis });
    take(Prismatic { a: body, b: euler, at, axis });
    take(Fixed { a: body, b: euler, at });
    take(Universal { a: body, b: euler, at, axis_a: axis, axis_b: [x, 0.0, 1.0] });
    survives("a search", || {
        let surface = surface(1.0);
        let Ok(search) = FaceSearch::new(&surface) else { return };
        search.nearest(&[x; 3]);
        search.within(&[[x; 3], [0.0; 3]], x).ok();
        NodeTie::to_surface(&[odd], &surface, x).ok();
    });
}

/// Couplings of nodes with rotations, with this number and this DOF in them.
fn couplings(odd: Point, [p, q, r, s]: [Point; 4], x: f64, dof: usize) {
    let beam =
        Node6 { dofs: [Some(20), Some(21), Some(22), Some(23), None, Some(dof)], at: [x, 0.0, 1.0], local: None };
    let face = Surface { nodes: vec![odd, p, q, r, s], faces: vec![Face::new(Shape::Tri3, [0, 1, 2])] };
    for section in [Section::Rigid, Section::Plane, Section::Mean] {
        take(BeamToSolid { beam, face: face.clone(), section });
        for nodes in [vec![0, 1, 2], vec![dof, 1], vec![]] {
            take(ShellToSolid { lines: vec![ThicknessLine { shell: beam, nodes }], face: face.clone(), section });
        }
    }
    let fluid = [odd, p, q].map(|node| FluidNode { normal: dof, at: node.at }).to_vec();
    take(FluidWall { structure: face.clone(), fluid, faces: face.faces.clone(), tolerance: x });
    let faces = vec![Face::new(Shape::Tri3, [0, 1, dof])];
    take(FluidWall { structure: face, fluid: vec![], faces, tolerance: x });
}

#[test]
fn every_type_with_every_bad_number() {
    for x in [0.0, -0.0, 0.5, -1.0, 5e-324, 1e-160, 1e160, f64::MAX, f64::MIN].into_iter().chain(BAD) {
        for dof in [0, 15, 39, 40, 1 << 32, usize::MAX] {
            every_type(x, dof);
        }
    }
}

#[test]
fn newton_with_wrong_starts_and_settings() {
    let set = linkage();
    let default = NewtonOptions::default;
    for count in [0, 3, 5] {
        refused("u", || solve(&set, &vec![0.0; count], &[], &default()));
        refused("u", || redundancies(&set, &vec![0.0; count], &default()));
    }
    for bad in BAD {
        refused("u", || solve(&set, &[bad; 4], &[], &default()));
        refused("u", || redundancies(&set, &[bad; 4], &default()));
        refused("a value", || solve(&set, &[0.1; 4], &[(0, bad)], &default()));
        survives("a tolerance", || solve(&set, &[0.1; 4], &[], &NewtonOptions { tolerance: bad, ..default() })).ok();
    }
    for prescribed in [vec![(4, 0.0)], vec![(usize::MAX, 0.0)], vec![(0, 0.0), (0, 1.0)]] {
        refused("a DOF", || solve(&set, &[0.1; 4], &prescribed, &default()));
    }
    survives("huge", || solve(&set, &[1e200, -1e200, 1e150, 0.0], &[(0, 1e300)], &default())).ok();
    refused("no steps", || solve(&set, &[0.3; 4], &[], &NewtonOptions { steps: 0, tolerance: 0.0, ..default() }));
    let analysis = Options { growth: f64::NAN, ..Options::default() };
    refused("options", || solve(&set, &[0.3; 4], &[], &NewtonOptions { analysis, ..default() }));
}

#[test]
fn enforcement_of_what_does_not_fit() {
    let diagonal = |n: usize, v: f64| {
        let entries: Vec<_> = (0..n).map(|j| Triplet::new(j, j, v)).collect();
        SparseColMat::try_new_from_triplets(n, n, &entries).expect("a diagonal")
    };
    let mut builder = SystemBuilder::new(3);
    builder.equation([(0, 1.0), (1, -1.0)], 0.5);
    builder.prescribe(2, 1.0);
    let system = builder.build().expect("valid");
    let (k, f) = (diagonal(3, 2.0), [1.0; 3]);
    for n in [0, 2, 4] {
        refused("K", || Problem::new(&diagonal(n, 1.0), &f, &system).map(drop));
        refused("f", || Problem::new(&k, &vec![0.0; n], &system).map(drop));
    }
    for bad in BAD {
        refused("K", || Problem::new(&diagonal(3, bad), &f, &system).map(drop));
        refused("f", || Problem::new(&k, &[bad; 3], &system).map(drop));
    }
    let problem = Problem::new(&k, &f, &system).expect("fits");
    for factor in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        refused("a factor", || problem.penalty(factor, 1e-3));
        refused("a factor", || problem.augmented(factor, 1e-10));
    }
    for tolerance in [f64::NAN, -1.0, f64::NEG_INFINITY] {
        refused("a tolerance", || problem.augmented(1e3, tolerance));
    }
    for limit in [f64::NAN, -1.0] {
        refused("a limit", || problem.plan(limit).map(drop));
    }
    for limit in [0.0, f64::INFINITY] {
        survives("a plan", || problem.plan(limit).and_then(|plan| problem.mixed(&plan))).expect("either way");
    }
    let block = |rows: Vec<usize>| BlockPlan { rows, fill: 1.0, eliminate: true };
    for rows in [vec![], vec![0, 0], vec![usize::MAX], vec![0, 1]] {
        refused("a plan", || problem.mixed(&[block(rows)]));
    }
    for rows in [vec![2], vec![usize::MAX], vec![0, system.equations()]] {
        refused("a row", || problem.lagrange_matrix(&rows));
    }
    for rows in [vec![], vec![0, 0]] {
        survives("rows", || problem.lagrange_matrix(&rows)).expect("few DOFs");
    }
    let reduction = analyse(&system, &Options::default()).expect("analysed").reduction().expect("reduced");
    for n in [0, 2, 4] {
        refused("K", || reduced(&diagonal(n, 1.0), &f, &reduction, &[1.0]));
        refused("f", || reduced(&k, &vec![0.0; n], &reduction, &[1.0]));
    }
    for values in [vec![], vec![0.0; 2], vec![f64::NAN]] {
        refused("u_p", || reduced(&k, &f, &reduction, &values));
    }
    for bad in BAD {
        refused("K", || reduced(&diagonal(3, bad), &f, &reduction, &[1.0]));
        refused("f", || reduced(&k, &[bad; 3], &reduction, &[1.0]));
    }
    let (none, load) = (diagonal(3, 0.0), [f64::MAX; 3]);
    let loose = Problem::new(&none, &load, &system).expect("finite");
    refused("nothing holds it", || loose.transformation());
    survives("multipliers", || loose.lagrange()).ok();
    survives("springs", || loose.penalty(f64::MAX, 1e-3)).ok();
    survives("loads", || loose.loads_without_effect());
    refused("a singular K", || reduced(&diagonal(3, 0.0), &f, &reduction, &[1.0]));
}

#[test]
fn vectors_and_derivatives_of_what_is_no_number() {
    for x in BAD.into_iter().chain([0.0, f64::MAX, 5e-324]) {
        let a = [x, 0.0, x];
        survives("vectors", || {
            let lifted = vector::lift::<f64>(a);
            let sums = [vector::add(a, lifted), vector::sub(a, a), vector::scale(x, a), vector::cross(a, a)];
            (sums, vector::dot(a, a), vector::norm(a), vector::perpendicular(a))
        });
        let unit = survives("a unit vector", || vector::unit(a));
        let lengths = unit.map(|unit| (vector::norm(unit) - 1.0).abs());
        assert!(if x.is_finite() && x != 0.0 { lengths < Some(1e-15) } else { lengths.is_none() }, "{x}: {unit:?}");
        for k in HUGE {
            assert_eq!(survives("a direction", || Dual::<2>::variable(x, k)).slope, [0.0; 2]);
        }
    }
}

/// A type that states a wrong number of DOFs.
struct Miscounted(Vec<usize>);

/// `u_0 u_1`.
struct Product;

impl Nonlinear for Product {
    const DOFS: usize = 2;
    const EQUATION_NAMES: &'static [&'static str] = &[""];

    fn value<S: Scalar>(&self, u: &[S], c: &mut [S]) {
        c[0] = u[0] * u[1];
    }
}

impl Constraint for Miscounted {
    const NAME: &'static str = "product";
    type Error = std::fmt::Error;

    fn emit(self, sink: &mut EquationSink) -> Result<(), Self::Error> {
        sink.nonlinear("", &self.0, Product);
        Ok(())
    }
}

#[test]
fn types_of_the_user_are_held_to_their_number_of_dofs() {
    for dofs in [vec![], vec![0], vec![0, 1, 2], vec![0, usize::MAX], vec![1, 1]] {
        refused("DOFs", || ConstraintSet::builder(3).add("it", Miscounted(dofs)));
    }
    take(Miscounted(vec![0, 1]));
}

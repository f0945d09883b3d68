use faer::sparse::{SparseColMat, Triplet};
use qless::{Options, analyse};
use qless_constraints::types::{Body, Distance, LinearEquation, OnSphere, PlanarPoint, Revolute};
use qless_constraints::{ConstraintSet, SetBuilder};
use qless_solve::newton::{NewtonOptions, solve};

pub type Outcome<T = ()> = Result<T, Box<dyn std::error::Error>>;

/// Rank of G at u.
pub fn rank(set: &ConstraintSet, u: &[f64]) -> Outcome<usize> {
    Ok(analyse(&set.linearised_at(u, &[])?, &Options::default())?.rank())
}

/// A number in [-0.5, 0.5], the same for a seed.
pub fn random(seed: usize) -> f64 {
    let z = (seed as u64 + 11).wrapping_mul(0x9E37_79B9_7F4A_7C15).rotate_left(29).wrapping_mul(0xD6E8_FEB8_6659_FD93);
    f64::from((z ^ (z >> 32)) as u32) / f64::from(u32::MAX) - 0.5
}

/// Springs to the ground, and from each DOF to the next, with a convective term if K is to be unsymmetric.
pub fn spring_chain(
    dofs: usize,
    ground: impl Fn(usize) -> f64,
    spring: impl Fn(usize) -> f64,
    convection: f64,
) -> Outcome<SparseColMat<usize, f64>> {
    let mut entries: Vec<_> = (0..dofs).map(|i| (i, i, ground(i))).collect();
    for i in 0..dofs - 1 {
        let s = spring(i);
        entries.extend([(i, i, s), (i + 1, i + 1, s), (i, i + 1, convection - s), (i + 1, i, -convection - s)]);
    }
    let entries: Vec<_> = entries.into_iter().map(|(i, j, v)| Triplet::new(i, j, v)).collect();
    Ok(SparseColMat::try_new_from_triplets(dofs, dofs, &entries)?)
}

/// `max |a - b| / max |b|`.
pub fn difference(a: &[f64], b: &[f64]) -> f64 {
    let size = b.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    a.iter().zip(b).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs())) / size
}

/// Three arms of length 1 on the ground at x = 0, 1, 2 that carry a rigid coupler of three points: 6 DOFs.
pub fn parallelogram() -> Outcome<SetBuilder> {
    let mut builder = ConstraintSet::builder(6);
    let top = |i: usize| PlanarPoint::new([2 * i, 2 * i + 1], [i as f64, 1.0]);
    for i in 0..3 {
        let arm = OnSphere { point: top(i), centre: [i as f64, 0.0], radius: None };
        builder.add(format!("arm {}", i + 1), arm)?;
    }
    builder.add("coupler", Distance::new(top(0), top(2)))?;
    for axis in 0..2 {
        let terms = vec![(2 + axis, 1.0), (axis, -0.5), (4 + axis, -0.5)];
        builder.add("middle of the coupler", LinearEquation { terms, rhs: 0.0 })?;
    }
    Ok(builder)
}

/// A hinge: a point and an axis.
pub type Hinge = ([f64; 3], [f64; 3]);

/// A closed ring of hinges. The first body is the ground; each other body has seven DOFs.
pub fn ring(hinges: &[Hinge]) -> Outcome<SetBuilder> {
    ring_of(hinges, 7)
}

/// The same with bodies of seven DOFs, with Euler parameters, or of six, with rotation vectors.
pub fn ring_of(hinges: &[Hinge], width: usize) -> Outcome<SetBuilder> {
    let bodies = hinges.len();
    let mut builder = ConstraintSet::builder(width * (bodies - 1));
    let body = |i: usize| {
        if i.is_multiple_of(bodies) {
            return Body::ground();
        }
        // Between its two hinges.
        let (p, q) = (hinges[i - 1].0, hinges[i % bodies].0);
        let at = std::array::from_fn(|k| f64::midpoint(p[k], q[k]));
        let dofs = |from: usize| std::array::from_fn(|k| width * (i - 1) + from + k);
        if width == 7 {
            Body::with_euler(dofs(0), at, std::array::from_fn(|k| width * (i - 1) + 3 + k))
        } else {
            Body::with_vector(dofs(0), at, dofs(3))
        }
    };
    for (i, &(at, axis)) in hinges.iter().enumerate() {
        builder.add(format!("hinge {}", i + 1), Revolute { a: body(i), b: body(i + 1), at, axis })?;
    }
    Ok(builder)
}

/// Bricard's orthogonal linkage: six hinges on a closed path along the edges of a cube, each perpendicular to both edges.
pub fn bricard() -> Outcome<SetBuilder> {
    let (x, y, z) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
    let corners =
        [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 1.0, 1.0], [0.0, 1.0, 1.0], [0.0, 0.0, 1.0]];
    let axes = [y, z, x, y, z, x];
    ring(&std::array::from_fn::<_, 6, _>(|i| (corners[i], axes[i])))
}

/// A four-bar linkage with parallel hinges.
pub fn four_bar() -> Outcome<SetBuilder> {
    let z = [0.0, 0.0, 1.0];
    ring(&[([0.0; 3], z), ([0.3, 1.0, 0.2], z), ([2.0, 1.4, 0.1], z), ([1.8, 0.0, -0.3], z)])
}

/// A generic consistent configuration: `dof` is moved to `value`, and Newton's method moves the others.
pub fn moved(set: &ConstraintSet, dof: usize, value: f64) -> Outcome<Vec<f64>> {
    Ok(solve(set, &vec![0.0; set.dofs()], &[(dof, value)], &NewtonOptions::default())?.u)
}

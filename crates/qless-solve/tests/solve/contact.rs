//! Contact: the solution of the quadratic program in every unit, and pendulums that come to rest on a floor.

use faer::sparse::{SparseColMat, Triplet};
use qless_constraints::types::{LinearEquation, OnPlane, OnSphere, Plane, Point};
use qless_constraints::{ConstraintSet, Inequalities, InequalityError};
use qless_solve::enforce::Problem;
use qless_solve::equilibrium::{EquilibriumOptions, Start, Target, solve};

use crate::equilibria::Weights;
use crate::linkages::Outcome;

/// Two elastic strips, each a string on springs, lie on top of each other. The upper one is curved and pressed down; its nodes meet the faces
/// of the lower one. Each node has one DOF, its deflection.
#[derive(Clone, Copy, Debug)]
struct Strips {
    upper: usize,
    lower: usize,
    length: f64,
    /// The gap before loading is `x^2 curvature / 2` from the middle.
    curvature: f64,
    stiffness: f64,
    /// On each node of the upper strip, downwards.
    force: f64,
}

/// Deflections and contact forces, and the number of closed gaps in each iteration.
struct Contact {
    u: Vec<f64>,
    gaps: Vec<f64>,
    pressures: Vec<f64>,
    closed: Vec<usize>,
}

impl Strips {
    fn dofs(&self) -> usize {
        self.upper + self.lower
    }

    /// Springs `(DOF, other DOF or the ground, stiffness)` between neighbours and to the ground. The support of the upper strip is soft.
    fn springs(&self) -> Vec<(usize, Option<usize>, f64)> {
        let ground = |i: usize| (i, None, if i < self.upper { 0.01 } else { 1.0 } * self.stiffness);
        let pair = |i: usize| (i, Some(i + 1), self.stiffness);
        let pairs = (0..self.dofs() - 1).filter(|&i| i + 1 != self.upper).map(pair);
        (0..self.dofs()).map(ground).chain(pairs).collect()
    }

    /// Loads on the DOFs.
    fn loads(&self) -> Vec<f64> {
        (0..self.dofs()).map(|i| if i < self.upper { -self.force } else { 0.0 }).collect()
    }

    /// `g_i = u_i - (1 - s) u_a - s u_b + gap_i`: the terms and the gap before loading.
    fn gap(&self, i: usize) -> (Vec<(usize, f64)>, f64) {
        let along = i as f64 / (self.upper - 1) as f64;
        let place = along * (self.lower - 1) as f64;
        let face = (place as usize).min(self.lower - 2);
        let (s, a) = (place - face as f64, self.upper + face);
        let x = (along - 0.5) * self.length;
        (vec![(i, 1.0), (a, s - 1.0), (a + 1, -s)], 0.5 * self.curvature * x * x)
    }

    fn matrix(&self) -> Outcome<SparseColMat<usize, f64>> {
        let entries = |(i, other, k): (usize, Option<usize>, f64)| {
            let own = [Some((i, i, k)), other.map(|j| (j, j, k))];
            own.into_iter().chain([other.map(|j| (i, j, -k)), other.map(|j| (j, i, -k))]).flatten()
        };
        let triplets: Vec<_> =
            self.springs().into_iter().flat_map(entries).map(|(i, j, k)| Triplet::new(i, j, k)).collect();
        Ok(SparseColMat::try_new_from_triplets(self.dofs(), self.dofs(), &triplets)?)
    }

    fn solve(&self) -> Outcome<Contact> {
        let (mut set, mut contact) = (ConstraintSet::builder(self.dofs()).build()?, Inequalities::default());
        for i in 0..self.upper {
            let (terms, gap) = self.gap(i);
            contact.add(&mut set, format!("node {i}"), LinearEquation { terms, rhs: -gap })?;
        }
        let (k, f, mut closed) = (self.matrix()?, self.loads(), Vec::new());
        let (u, multipliers) = contact.solve(&mut set, |set| -> Outcome<_> {
            closed.push(set.equations());
            let system = set.linearised_at(&vec![0.0; self.dofs()], &[])?;
            let solution = Problem::new(&k, &f, &system)?.lagrange()?;
            Ok((solution.u, set.by_constraint(&solution.multipliers)?))
        })?;
        let mut evaluation = set.allocate();
        set.evaluate(&u, &mut evaluation)?;
        let gaps = contact.ids().iter().map(|&id| Ok(set.values_of(id, &evaluation)?[0])).collect::<Outcome<_>>()?;
        let pressure = |&id| -multipliers.of(id).first().copied().unwrap_or(0.0);
        Ok(Contact { pressures: contact.ids().iter().map(pressure).collect(), u, gaps, closed })
    }
}

/// Solves a dense system by Gauss elimination with pivoting.
fn dense(mut a: Vec<Vec<f64>>, mut b: Vec<f64>) -> Vec<f64> {
    let n = b.len();
    for k in 0..n {
        let pivot = (k..n).max_by(|&i, &j| a[i][k].abs().total_cmp(&a[j][k].abs())).unwrap_or(k);
        a.swap(k, pivot);
        b.swap(k, pivot);
        for i in k + 1..n {
            let factor = a[i][k] / a[k][k];
            (k..n).for_each(|j| a[i][j] -= factor * a[k][j]);
            b[i] -= factor * b[k];
        }
    }
    for k in (0..n).rev() {
        b[k] = (b[k] - (k + 1..n).map(|j| a[k][j] * b[j]).sum::<f64>()) / a[k][k];
    }
    b
}

/// Among all sets of closed gaps, the one without negative gaps and pressures. It is unique, since K is positive definite.
fn by_trying_all(strips: &Strips) -> Option<(Vec<f64>, Vec<f64>)> {
    let (n, size) = (strips.dofs(), strips.stiffness);
    for closed in 0..1_usize << strips.upper {
        let active: Vec<usize> = (0..strips.upper).filter(|i| closed >> i & 1 == 1).collect();
        let total = n + active.len();
        let (mut a, mut b) = (vec![vec![0.0; total]; total], strips.loads());
        for (i, other, k) in strips.springs() {
            a[i][i] += k;
            if let Some(j) = other {
                a[j][j] += k;
                a[i][j] -= k;
                a[j][i] -= k;
            }
        }
        // -C^T p, and C u = -gap multiplied by the stiffness, so that all pivots have one size.
        for (row, &i) in (n..).zip(&active) {
            let (terms, gap) = strips.gap(i);
            for (j, v) in terms {
                a[row][j] = v * size;
                a[j][row] = -v * size;
            }
            b.push(-gap * size);
        }
        let x = dense(a, b);
        let mut pressures = vec![0.0; strips.upper];
        active.iter().zip(&x[n..]).for_each(|(&i, &p)| pressures[i] = p * size);
        let gap = |i: usize| {
            let (terms, gap) = strips.gap(i);
            terms.iter().map(|&(j, v)| v * x[j]).sum::<f64>() + gap
        };
        let open = (0..strips.upper).filter(|i| !active.contains(i)).all(|i| gap(i) >= 0.0);
        if open && pressures.iter().all(|&p| p >= 0.0) {
            return Some((x[..n].to_vec(), pressures));
        }
    }
    None
}

fn close(found: &[f64], truth: &[f64]) -> bool {
    let size = truth.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    found.iter().zip(truth).all(|(a, b)| (a - b).abs() <= 1e-10 * size)
}

/// Flat and curved strips, matching and non-matching meshes, light and heavy loads, several units: the solution of the quadratic program,
/// found by trying all active sets.
#[test]
fn contact_is_that_of_the_quadratic_program() -> Outcome {
    let (mut sizes, mut left) = (std::collections::BTreeSet::new(), 0);
    for (upper, lower) in [(7, 5), (6, 6), (8, 3), (5, 11)] {
        for (curvature, force) in [(0.05, 50.0), (0.02, 5.0), (0.2, 400.0), (-0.05, 20.0), (0.1, -3.0)] {
            for [length, unit] in [[1.0, 1.0], [1e6, 1.0], [1e-6, 1e6], [1.0, 1e-6]] {
                let strips = Strips {
                    upper,
                    lower,
                    length: 8.0 * length,
                    curvature: curvature / length,
                    stiffness: 1000.0 * unit / length,
                    force: force * unit,
                };
                let Contact { u, gaps, pressures, closed: history } = strips.solve()?;
                let (truth, forces) = by_trying_all(&strips).ok_or("no active set is right")?;
                assert!(close(&u, &truth) && close(&pressures, &forces), "{upper}, {lower}, {curvature}, {force}");
                let closed = pressures.iter().filter(|&&p| p > 0.0).count();
                assert_eq!(history.last(), Some(&closed));
                let least = 1e-14 * length * curvature.abs();
                assert!(gaps.iter().zip(&pressures).all(|(&gap, &p)| p > 0.0 || gap >= -least));
                sizes.insert(closed);
                left += usize::from(history.windows(2).any(|pair| pair[1] < pair[0]));
            }
        }
    }
    assert!(sizes.contains(&0) && sizes.len() > 3, "all active sets look alike: {sizes:?}");
    assert!(left > 0, "no node ever leaves the active set");
    Ok(())
}

/// Pendulums on springs swing onto a floor and off it: nonlinear equilibria that start from each other, with multipliers that stay with their
/// arms while contacts open and close.
#[test]
fn pendulums_come_to_rest_on_a_floor() -> Outcome {
    for [length, force] in [[1.0, 1.0], [1e-3, 1e3], [1e4, 1e-2]] {
        let nodes = 7;
        let pivot = |i: usize| [length * i as f64, 0.0, 0.0];
        let node = |i: usize| {
            let [x, y, z] = pivot(i);
            Point::new([3 * i, 3 * i + 1, 3 * i + 2], [x + 0.6 * length, y, z - 0.8 * length])
        };
        let mut set = ConstraintSet::builder(3 * nodes).build()?;
        let mut floor = Inequalities::default();
        for i in 0..nodes {
            set.add(format!("arm {i}"), OnSphere { point: node(i), centre: pivot(i), radius: None })?;
            let depth = -length * (0.83 + 0.02 * i as f64);
            let plane = Plane::Fixed { through: [0.0, 0.0, depth], normal: [0.0, 0.1, 1.0] };
            floor.add(&mut set, format!("node {i}"), OnPlane { point: node(i), plane })?;
        }
        let mut model = Weights { springs: vec![force / length; set.dofs()] };
        let (mut start, mut counts) = (Start::at_rest(&set), Vec::new());
        for step in (0..=8).chain((0..8).rev()).chain(1..=8) {
            let down = -0.02 - 0.1 * f64::from(step);
            let loads: Vec<f64> = (0..set.dofs()).map(|j| force * [0.0, 0.02 * down, down][j % 3]).collect();
            let target = Target { loads: &loads, prescribed: &[] };
            let (u, multipliers) = floor.solve(&mut set, |set| -> Outcome<_> {
                let found = solve(&mut model, set, &start, &target, &EquilibriumOptions::default())?;
                start = found.start();
                Ok((found.u, found.multipliers))
            })?;
            let mut evaluation = set.allocate();
            set.evaluate(&u, &mut evaluation)?;
            let mut closed = 0;
            for &id in floor.ids() {
                let (gap, lambda) = (set.values_of(id, &evaluation)?[0], multipliers.of(id));
                closed += lambda.len();
                assert!(gap > -1e-12 * length && lambda.iter().all(|&lambda| lambda <= 0.0 && gap < 1e-9 * length));
            }
            counts.push(closed);
        }
        // Deeper floors are reached by heavier loads, and the way back is the way there.
        assert!(counts[0] == 0 && counts[8] > 4 && counts[..9].is_sorted(), "{counts:?}");
        assert!((0..=8).all(|step| counts[16 - step] == counts[step] && counts[16 + step] == counts[step]));
    }
    Ok(())
}

/// An error of the equilibrium is that of the loop.
#[test]
fn errors_of_the_equilibrium_are_passed_on() -> Outcome {
    let mut set = ConstraintSet::builder(1).build()?;
    let mut floor = Inequalities::default();
    floor.add(&mut set, "floor", LinearEquation { terms: vec![(0, 1.0)], rhs: 0.0 })?;
    let found = floor.solve(&mut set, |set| Ok::<_, InequalityError>((vec![0.0; 2], set.by_constraint(&[])?)));
    assert!(matches!(found, Err(InequalityError::Argument(_))), "{found:?}");
    Ok(())
}

//! Stability of equilibria against second derivatives of closed forms.

use faer::Mat;
use qless_constraints::ConstraintSet;
use qless_constraints::types::{Distance, Equal, LinearEquation, OnSphere, PlanarPoint, Point};
use qless_solve::equilibrium::{
    Assembly, Equilibrium, EquilibriumError, EquilibriumOptions, Model, Stability, Start, Target, solve,
};

use crate::equilibria::{UNITS, Weights};
use crate::linkages::{Outcome, random};

fn asked() -> EquilibriumOptions {
    EquilibriumOptions { stability: true, ..EquilibriumOptions::default() }
}

fn said(directions: usize) -> Stability {
    if directions == 0 { Stability::Stable } else { Stability::Unstable { directions } }
}

/// Linear springs between DOFs and to the ground, and the number of DOFs.
pub struct Springs(pub Vec<(usize, Option<usize>, f64)>, pub usize);

impl Model for Springs {
    fn dofs(&self) -> usize {
        self.1
    }

    fn pattern(&self, entry: &mut dyn FnMut(usize, usize)) {
        for &(i, j, _) in &self.0 {
            let ends = [Some(i), j];
            ends.iter().flatten().for_each(|&a| ends.iter().flatten().for_each(|&b| entry(a, b)));
        }
    }

    fn assemble(&mut self, u: &[f64], out: &mut Assembly) -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
        for &(i, j, k) in &self.0 {
            let pull = k * (u[i] - j.map_or(0.0, |j| u[j]));
            out.force(i, pull);
            out.stiffness(i, i, k);
            if let Some(j) = j {
                out.force(j, -pull);
                [(j, j, k), (i, j, -k), (j, i, -k)].into_iter().for_each(|(a, b, k)| out.stiffness(a, b, k));
            }
        }
        Ok(())
    }
}

/// Negative eigenvalues of a symmetric tridiagonal matrix, by Sturm's sequence; none if one is near zero.
fn negative(diagonal: &[f64], beside: &[f64]) -> Option<usize> {
    let mut before = f64::INFINITY;
    let mut count = 0;
    for (i, d) in diagonal.iter().enumerate() {
        let b = if i == 0 { 0.0 } else { beside[i - 1] };
        before = d - b * b / before;
        if before.abs() < 1e-4 * d.abs().max(b.abs()) {
            return None;
        }
        count += usize::from(before < 0.0);
    }
    Some(count)
}

/// n upright pendulums with weights on top and springs to the ground and to each other: `E'' = tridiag(-s, k - P / L + 2 s, -s)`.
#[test]
fn upright_pendulums() -> Outcome {
    let mut seen = [0; 4];
    for seed in 0..210 {
        let [length, force] = UNITS[seed % UNITS.len()];
        let number = |k: usize| 1.0 + 1.8 * random(1009 * seed + k);
        let n = 1 + seed % 12;
        let (mut springs, mut loads, mut diagonal, mut beside) = (Vec::new(), vec![0.0; 2 * n], Vec::new(), Vec::new());
        let mut builder = ConstraintSet::builder(2 * n);
        for i in 0..n {
            let (arm, weight, k) =
                (length * number(3 * i), force * number(3 * i + 1), 1.2 * force / length * number(3 * i + 2));
            let centre = [5.0 * length * i as f64, -arm];
            let point = PlanarPoint::new([2 * i, 2 * i + 1], [centre[0], 0.0]);
            builder.add(format!("arm {i}"), OnSphere { point, centre, radius: None })?;
            loads[2 * i + 1] = -weight;
            springs.push((2 * i, None, k));
            diagonal.push(k - weight / arm);
            if i > 0 {
                let s = 0.2 * force / length * number(500 + i);
                springs.push((2 * i, Some(2 * i - 2), s));
                diagonal[i] += s;
                diagonal[i - 1] += s;
                beside.push(-s);
            }
        }
        let Some(directions) = negative(&diagonal, &beside) else { continue };
        let set = builder.build()?;
        let target = Target { loads: &loads, prescribed: &[] };
        let found = solve(&mut Springs(springs, 2 * n), &set, &Start::at_rest(&set), &target, &asked())?;
        assert!(found.u.iter().all(|u| u.abs() < 1e-9 * length), "{:?}", found.u);
        assert_eq!(found.stability, Some(said(directions)), "{seed}: {diagonal:?} {beside:?}");
        seen[directions.min(3)] += 1;
    }
    assert!(seen.iter().all(|&count| count >= 10), "{seen:?}");
    Ok(())
}

/// A toggle frame of two rigid bars with its foot on a spring: `E(h) = k (s - s_0)^2 / 2 - F h`, `s = 2 sqrt(L^2 - h^2)`, under the load that
/// makes h an equilibrium. A duplicate tie adds no unstable direction.
#[test]
fn toggle_frames() -> Outcome {
    let mut seen = [0; 2];
    for seed in 0..70 {
        let [length, force] = UNITS[seed % UNITS.len()];
        let (bar, k) = (length, force / length);
        let (h0, h) = (0.5 * length, length * (0.2 + 0.7 * (random(seed) + 0.2)));
        let span = |h: f64| 2.0 * (bar * bar - h * h).sqrt();
        let (first, second) = (-4.0 * h / span(h), -4.0 / span(h) - 16.0 * h * h / span(h).powi(3));
        let load = k * (span(h) - span(h0)) * first;
        let bend = k * (first * first + (span(h) - span(h0)) * second);
        if bend.abs() < 1e-2 * k {
            continue;
        }
        let at = [[0.0, 0.0], [0.5 * span(h0), h0], [span(h0), 0.0]];
        let node = |i: usize| PlanarPoint::new([2 * i, 2 * i + 1], at[i]);
        let mut builder = ConstraintSet::builder(6);
        (0..2).try_for_each(|i| builder.add(format!("bar {i}"), Distance::new(node(i), node(i + 1))).map(drop))?;
        builder.add("level", LinearEquation { terms: vec![(5, 1.0)], rhs: 0.0 })?;
        builder.add("level again", Equal::new([5, 1]))?;
        let set = builder.build()?;
        let mut model = Weights { springs: vec![0.0, 0.0, 0.0, 0.0, k, 0.0] };
        let mut start = Start::at_rest(&set);
        start.u = vec![0.0, 0.0, 0.5 * (span(h) - span(h0)), h - h0, span(h) - span(h0), 0.0];
        let loads = [0.0, 0.0, 0.0, load, 0.0, 0.0];
        let target = Target { loads: &loads, prescribed: &[(0, 0.0), (1, 0.0)] };
        let found = solve(&mut model, &set, &start, &target, &asked())?;
        assert!((found.u[3] - (h - h0)).abs() < 1e-8 * length, "{seed}");
        assert_eq!(found.stability, Some(said(usize::from(bend < 0.0))), "{seed}: {bend:e}");
        seen[usize::from(bend < 0.0)] += 1;
        // With its top held, nothing can become unstable.
        let held = [(0, 0.0), (1, 0.0), (3, found.u[3])];
        let target = Target { prescribed: &held, ..target };
        let found = solve(&mut model, &set, &found.start(), &target, &asked())?;
        assert_eq!(found.stability, Some(Stability::Stable), "{seed}");
    }
    assert!(seen.iter().all(|&count| count >= 10), "{seen:?}");
    Ok(())
}

/// A strut of rigid links hinged by rotational springs under the pressure P: the discrete column. Its critical loads are the eigenvalues of
/// its second difference, `E'' = c D2^T D2 - P / l D1^T D1` in the heights of its joints.
#[test]
fn a_strut_gives_way_in_as_many_ways_as_loads_are_passed() -> Outcome {
    let n = 9;
    for [length, force] in UNITS {
        let (l, spring) = (length / n as f64, force * length);
        // Hinges between links: c / 2 (y_(i-1) - 2 y_i + y_(i+1))^2 / l^2, quadratic in the heights.
        for (mode, factor) in [(0, 0.99), (0, 1.01), (1, 0.99), (1, 1.01), (4, 1.01), (7, 0.99), (7, 1.01)] {
            let critical = 4.0 * spring / l * (std::f64::consts::PI * (mode + 1) as f64 / (2 * n) as f64).sin().powi(2);
            let mut builder = ConstraintSet::builder(2 * (n + 1));
            let node = |i: usize| PlanarPoint::new([2 * i, 2 * i + 1], [l * i as f64, 0.0]);
            (0..n).try_for_each(|i| builder.add(format!("link {i}"), Distance::new(node(i), node(i + 1))).map(drop))?;
            let set = builder.build()?;
            let mut loads = vec![0.0; 2 * (n + 1)];
            loads[2 * n] = -factor * critical;
            let target = Target { loads: &loads, prescribed: &[(0, 0.0), (1, 0.0), (2 * n + 1, 0.0)] };
            let mut model = Hinges { stiffness: spring / (l * l), nodes: n + 1 };
            let found = solve(&mut model, &set, &Start::at_rest(&set), &target, &asked())?;
            let passed = if factor > 1.0 { mode + 1 } else { mode };
            assert_eq!(found.stability, Some(said(passed)), "{length} {force}: {mode} {factor}");
        }
    }
    Ok(())
}

/// `k / 2 sum (y_(i-1) - 2 y_i + y_(i+1))^2`.
struct Hinges {
    stiffness: f64,
    nodes: usize,
}

impl Model for Hinges {
    fn dofs(&self) -> usize {
        2 * self.nodes
    }

    fn pattern(&self, entry: &mut dyn FnMut(usize, usize)) {
        for i in 1..self.nodes - 1 {
            (0..9).for_each(|k| entry(2 * (i + k / 3) - 1, 2 * (i + k % 3) - 1));
        }
    }

    fn assemble(&mut self, u: &[f64], out: &mut Assembly) -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
        for i in 1..self.nodes - 1 {
            let of = [(2 * i - 1, 1.0), (2 * i + 1, -2.0), (2 * i + 3, 1.0)];
            let bend: f64 = of.iter().map(|&(j, a)| a * u[j]).sum();
            for (j, a) in of {
                out.force(j, self.stiffness * a * bend);
                of.iter().for_each(|&(k, b)| out.stiffness(j, k, self.stiffness * a * b));
            }
        }
        Ok(())
    }
}

/// A follower force has no energy; at the critical load the tangent is singular; stability is computed only on request.
#[test]
fn what_has_no_answer() -> Outcome {
    struct Follower;
    impl Model for Follower {
        fn dofs(&self) -> usize {
            2
        }
        fn pattern(&self, entry: &mut dyn FnMut(usize, usize)) {
            (0..4).for_each(|k| entry(k / 2, k % 2));
        }
        fn assemble(&mut self, u: &[f64], out: &mut Assembly) -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
            for (i, k) in [2.0, 3.0].into_iter().enumerate() {
                out.force(i, k * u[i]);
                out.stiffness(i, i, k);
            }
            out.force(0, 0.5 * u[1]);
            out.stiffness(0, 1, 0.5);
            Ok(())
        }
    }
    let free = ConstraintSet::builder(2).build()?;
    let target = Target { loads: &[1.0, 1.0], prescribed: &[] };
    let found: Equilibrium = solve(&mut Follower, &free, &Start::at_rest(&free), &target, &asked())?;
    assert_eq!(found.stability, Some(Stability::NotSymmetric));
    let found = solve(&mut Follower, &free, &Start::at_rest(&free), &target, &EquilibriumOptions::default())?;
    assert_eq!(found.stability, None);
    // All DOFs are prescribed.
    let target = Target { loads: &[1.0, 1.0], prescribed: &[(0, 0.0), (1, 0.0)] };
    let found = solve(&mut Follower, &free, &Start::at_rest(&free), &target, &asked())?;
    assert_eq!(found.stability, Some(Stability::Stable));
    let mut builder = ConstraintSet::builder(2);
    let point = PlanarPoint::new([0, 1], [0.0, 1.0]);
    builder.add("arm", OnSphere { point, centre: [0.0; 2], radius: None })?;
    let set = builder.build()?;
    let target = Target { loads: &[0.0, -1.0], prescribed: &[] };
    let critical = solve(&mut Weights { springs: vec![1.0, 0.0] }, &set, &Start::at_rest(&set), &target, &asked());
    assert!(matches!(critical, Err(EquilibriumError::Unsupported { .. })), "{critical:?}");
    for (k, said) in [(1.0 + 1e-9, Stability::Stable), (1.0 - 1e-9, Stability::Unstable { directions: 1 })] {
        let found = solve(&mut Weights { springs: vec![k, 0.0] }, &set, &Start::at_rest(&set), &target, &asked())?;
        assert!([Some(said), Some(Stability::Undecided)].contains(&found.stability), "{k}: {:?}", found.stability);
    }
    Ok(())
}

/// Points in space with rods (some of them duplicate), ties and springs of either sign, in equilibrium at rest: `f_ext = G^T lambda`. The
/// count agrees with the eigenvalues of `Z^T (K + H) Z` with Z from a singular value decomposition, or is undecided.
#[test]
fn random_mechanisms_are_as_unstable_as_their_eigenvalues() -> Outcome {
    let (mut seen, mut undecided) = ([0; 6], 0);
    for seed in 0..210 {
        let [length, force] = UNITS[seed % UNITS.len()];
        let number = |k: usize| 2.0 * random(4001 * seed + k);
        let points = 2 + seed % 7;
        let n = 3 * points;
        let node = |i: usize| Point::new([3 * i, 3 * i + 1, 3 * i + 2], [0, 1, 2].map(|k| length * number(10 * i + k)));
        let mut builder = ConstraintSet::builder(n);
        for i in 1..points {
            let other = (i as f64 * (0.5 + 0.499 * number(100 + i))) as usize;
            builder.add(format!("rod {i}"), Distance::new(node(other), node(i)))?;
            if i % 3 == 0 {
                builder.add(format!("rod {i} again"), Distance::new(node(i), node(other)))?;
            }
        }
        builder.add("tie", Equal::new([0, n - 1]))?;
        let set = builder.build()?;
        let springs: Vec<f64> = (0..n).map(|j| force / length * (number(200 + j) + 0.3)).collect();
        let (mut evaluation, zeros) = (set.allocate(), vec![0.0; n]);
        let pulls: Vec<f64> = (0..set.equations()).map(|r| 0.5 * force * number(300 + r)).collect();
        set.assemble(&zeros, &pulls, &mut evaluation)?;
        let mut loads = zeros.clone();
        (0..set.equations()).for_each(|r| evaluation.g().row(r).for_each(|(j, v)| loads[j] += v * pulls[r]));
        let target = Target { loads: &loads, prescribed: &[] };
        // Newton's method may find another equilibrium or none.
        let (mut model, start) = (Weights { springs: springs.clone() }, Start::at_rest(&set));
        let Ok(found) = solve(&mut model, &set, &start, &target, &asked()) else { continue };
        set.assemble(&found.u, &found.multipliers.in_rows(&set)?, &mut evaluation)?;
        let (g, h) = (dense(evaluation.g()), dense(evaluation.h()));
        let stiff = Mat::from_fn(n, n, |i, j| h[(i, j)] + if i == j { springs[i] } else { 0.0 });
        let svd = g.svd().map_err(|e| format!("{e:?}"))?;
        let size = svd.S().column_vector();
        let rank = (0..size.nrows()).filter(|&k| size[k] > 1e-9 * size[0]).count();
        let z = svd.V().subcols(rank, n - rank);
        let eigen =
            (z.transpose() * &stiff * z).self_adjoint_eigenvalues(faer::Side::Lower).map_err(|e| format!("{e:?}"))?;
        let scale = eigen.iter().fold(0.0_f64, |most, e| most.max(e.abs()));
        let Some(said) = found.stability else { panic!("it was asked") };
        if eigen.iter().any(|e| e.abs() < 1e-8 * scale) {
            continue;
        }
        let directions = eigen.iter().filter(|e| **e < 0.0).count();
        match said {
            Stability::Undecided => undecided += 1,
            other => assert_eq!(other, self::said(directions), "{seed}: {eigen:?}"),
        }
        seen[directions.min(5)] += 1;
    }
    println!("directions {seen:?}, undecided {undecided}");
    assert!(
        seen.iter().sum::<usize>() > 150 && seen[1..].iter().all(|&count| count > 5) && undecided < 5,
        "{seen:?} {undecided}"
    );
    Ok(())
}

fn dense(a: &qless::Csr) -> Mat<f64> {
    let mut m = Mat::zeros(a.rows(), a.cols());
    (0..a.rows()).for_each(|r| a.row(r).for_each(|(j, v)| m[(r, j)] = v));
    m
}

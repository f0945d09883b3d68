//! Loads, reactions and forces of constraints at rotations are moments in space, for rotation vectors and Euler parameters.

use std::error::Error;

use qless_constraints::types::{Fixed, Spherical};
use qless_constraints::{ConstraintSet, rotation_tangent};
use qless_solve::equilibrium::{Assembly, EquilibriumError, EquilibriumOptions, Model, Start, Target, drive, solve};

use crate::equilibria::Weights;
use crate::linkages::Outcome;
use crate::poses::{KINDS, Kind, Pose, STRIDE, Vector, add, body, cross, dot, norm, place, scale, sub, turn, turned};

/// A force on the tip of an arm, and springs on the rotation DOFs: `E = -F . R s + sum_j k_j u_j^2 / 2`, by differences of E.
struct Arm {
    kind: Kind,
    force: Vector,
    tip: Vector,
    springs: f64,
}

impl Arm {
    fn rotations(&self) -> std::ops::Range<usize> {
        if self.kind == Kind::Vector { 3..6 } else { 3..7 }
    }

    /// `R s` for the rotation DOFs of u; Euler parameters are taken as they are.
    fn turned(&self, u: &[f64], s: Vector) -> Vector {
        let quaternion = match self.kind {
            Kind::Euler => [1.0 + u[3], u[4], u[5], u[6]],
            Kind::Vector => {
                let theta = [u[3], u[4], u[5]];
                if norm(theta) == 0.0 { [1.0, 0.0, 0.0, 0.0] } else { turn(theta, norm(theta)) }
            }
        };
        turned(quaternion, s)
    }

    fn energy(&self, u: &[f64]) -> f64 {
        let springs: f64 = self.rotations().map(|j| 0.5 * self.springs * (1.0 + j as f64 / 5.0) * u[j] * u[j]).sum();
        springs - dot(self.force, self.turned(u, self.tip))
    }

    fn slope(&self, u: &[f64], j: usize) -> f64 {
        let step = 1e-3;
        let at = |k: f64| {
            let mut u = u.to_vec();
            u[j] += k * step;
            self.energy(&u)
        };
        // The error is of order step^6.
        (45.0 * (at(1.0) - at(-1.0)) - 9.0 * (at(2.0) - at(-2.0)) + at(3.0) - at(-3.0)) / (60.0 * step)
    }
}

impl Model for Arm {
    fn dofs(&self) -> usize {
        STRIDE
    }
    fn pattern(&self, entry: &mut dyn FnMut(usize, usize)) {
        self.rotations().for_each(|i| self.rotations().for_each(|j| entry(i, j)));
    }
    fn assemble(&mut self, u: &[f64], out: &mut Assembly) -> Result<(), Box<dyn Error + Send + Sync>> {
        for i in self.rotations() {
            out.force(i, self.slope(u, i));
            for j in self.rotations() {
                let at = |k: f64| {
                    let mut u = u.to_vec();
                    u[j] += k * 1e-3;
                    self.slope(&u, i)
                };
                out.stiffness(i, j, (8.0 * (at(1.0) - at(-1.0)) - at(2.0) + at(-2.0)) / 12e-3);
            }
        }
        Ok(())
    }
}

/// The arm in a ball joint at its own place.
fn jointed(kind: Kind) -> Outcome<ConstraintSet> {
    let mut builder = ConstraintSet::builder(STRIDE);
    let joint = Spherical { a: qless_constraints::types::Body::ground(), b: body(0, kind, [0.0; 3]), at: [0.0; 3] };
    builder.add("joint", joint)?;
    Ok(builder.build()?)
}

fn pose(kind: Kind, theta: Vector) -> Vec<f64> {
    let mut u = vec![0.0; STRIDE];
    place(&mut u, 0, kind, [0.0; 3], Pose { at: [0.0; 3], turn: turn(theta, norm(theta)) });
    u
}

/// A moment among the DOFs of a rotation.
fn moment(kind: Kind, list: &[f64]) -> Vector {
    let first = if kind == Kind::Vector { 3 } else { 4 };
    [list[first], list[first + 1], list[first + 2]]
}

const THETAS: [Vector; 3] = [[0.7, -1.1, 0.4], [-1.9, 0.3, 1.2], [0.1, 0.0, -2.6]];

/// An arm that is held by its rotation: the reaction is the moment of the force, `-(R s) x F`, not `T^T` of it.
#[test]
fn reactions_are_moments() -> Outcome {
    let (force, tip) = ([3.0, -7.0, 5.0], [1.0, 0.4, -2.0]);
    for kind in KINDS {
        let set = jointed(kind)?;
        for theta in THETAS {
            let mut model = Arm { kind, force, tip, springs: 0.0 };
            let u = pose(kind, theta);
            let mut held: Vec<(usize, f64)> = model.rotations().map(|j| (j, u[j])).collect();
            held.extend((kind == Kind::Vector).then_some((6, 0.0)));
            let start = Start { u, ..Start::at_rest(&set) };
            let target = Target { loads: &[0.0; STRIDE], prescribed: &held };
            let found = solve(&mut model, &set, &start, &target, &EquilibriumOptions::default())?;
            let truth = cross(force, model.turned(&found.u, tip));
            let told = moment(kind, &found.reactions);
            assert!(norm(sub(told, truth)) < 1e-8 * norm(truth), "{kind:?}, {theta:?}: {told:?}, {truth:?}");
            if kind == Kind::Vector {
                // The generalised forces are others.
                let t = rotation_tangent(theta);
                let of: Vector = std::array::from_fn(|j| (0..3).map(|i| t[i][j] * truth[i]).sum());
                assert!(norm(sub(of, truth)) > 0.1 * norm(truth));
            }
        }
    }
    Ok(())
}

/// A moment as a load has the power `M . w` of the angular velocity w in space, whatever the parameters of the rotation, and balances springs.
#[test]
fn loads_are_moments() -> Outcome {
    for kind in KINDS {
        let set = jointed(kind)?;
        for (k, axis) in THETAS.into_iter().enumerate() {
            let mut model = Arm { kind, force: [0.0; 3], tip: [0.0; 3], springs: 4.0 };
            // Springs on Euler parameters carry bounded moments only.
            let size = [1.0, 3.0, 0.01][k] * if kind == Kind::Euler { 0.4 } else { 1.0 };
            let load = scale(size, axis);
            let mut loads = vec![0.0; STRIDE];
            let first = if kind == Kind::Vector { 3 } else { 4 };
            loads[first..first + 3].copy_from_slice(&load);
            let held: &[(usize, f64)] = if kind == Kind::Vector { &[(6, 0.0)] } else { &[] };
            let target = Target { loads: &loads, prescribed: held };
            let found = solve(&mut model, &set, &Start::at_rest(&set), &target, &EquilibriumOptions::default())?;
            let last = &found.steps[found.steps.len() - 1];
            assert!(last.iterates.len() <= 10, "{kind:?}: {} iterates", last.iterates.len());
            for j in model.rotations() {
                let step = 1e-5;
                let rates = |k: usize| {
                    let at = |sign: f64| {
                        let mut u = found.u.clone();
                        u[j] += sign * step;
                        if kind == Kind::Euler {
                            let size = (1.0 + u[3]).hypot(u[4]).hypot(u[5]).hypot(u[6]);
                            (4..7).for_each(|j| u[j] /= size);
                            u[3] = (1.0 + u[3]) / size - 1.0;
                        }
                        model.turned(&u, std::array::from_fn(|i| if i == k { 1.0 } else { 0.0 }))
                    };
                    (scale(0.5, add(at(1.0), at(-1.0))), scale(0.5 / step, sub(at(1.0), at(-1.0))))
                };
                let spin = (0..3).map(rates).fold([0.0; 3], |w, (r, rate)| add(w, scale(0.5, cross(r, rate))));
                // The springs pull along the change of the parameters that keeps their length.
                let along: f64 = if kind == Kind::Euler {
                    let p = [1.0 + found.u[3], found.u[4], found.u[5], found.u[6]];
                    let pull: Vec<f64> = (3..7).map(|j| model.slope(&found.u, j)).collect();
                    let share: f64 = pull.iter().zip(p).map(|(f, p)| f * p).sum();
                    pull[j - 3] - share * p[j - 3]
                } else {
                    model.slope(&found.u, j)
                };
                assert!((dot(load, spin) - along).abs() < 1e-7 * norm(load), "{kind:?}, DOF {j}");
            }
        }
        if kind == Kind::Euler {
            let mut model = Arm { kind, force: [0.0; 3], tip: [0.0; 3], springs: 4.0 };
            let loads: Vec<f64> = (0..STRIDE).map(|j| if j == 3 { 1.0 } else { 0.0 }).collect();
            let target = Target { loads: &loads, prescribed: &[] };
            let refused = solve(&mut model, &set, &Start::at_rest(&set), &target, &EquilibriumOptions::default());
            assert!(matches!(refused, Err(EquilibriumError::Moment { dof: 3 })), "{refused:?}");
        }
    }
    Ok(())
}

/// A turned body carries another one by a weld: the force of the weld on the carrier has the moment `(x_b - x_a) x F`.
#[test]
fn forces_of_a_joint_are_moments() -> Outcome {
    for (kinds, theta) in [[KINDS[0]; 2], [KINDS[0], KINDS[1]], [KINDS[1], KINDS[0]]].into_iter().zip(THETAS) {
        let (from, force) = ([[0.3, 0.0, 0.1], [1.5, 0.2, -0.4]], [3.0, -7.0, 5.0]);
        let [a, b] = [0, 1].map(|i| body(i, kinds[i], from[i]));
        let mut builder = ConstraintSet::builder(2 * STRIDE);
        let weld = builder.add("weld", Fixed { a, b, at: [0.9, 0.7, 0.0] })?;
        let mut set = builder.build()?;
        let mut u = vec![0.0; 2 * STRIDE];
        place(&mut u, 0, kinds[0], from[0], Pose { at: from[0], turn: turn(theta, norm(theta)) });
        let mut held: Vec<(usize, f64)> = (0..STRIDE).map(|j| (j, u[j])).collect();
        held.extend((kinds[1] == Kind::Vector).then_some((2 * STRIDE - 1, 0.0)));
        let mut loads = vec![0.0; 2 * STRIDE];
        loads[STRIDE..STRIDE + 3].copy_from_slice(&force);
        let target = Target { loads: &loads, prescribed: &held };
        // Prescribed Euler parameters keep their length only where they start.
        let start = Start { u, ..Start::at_rest(&set) };
        let found = drive(
            &mut Weights { springs: vec![0.0; 2 * STRIDE] },
            &mut set,
            &start,
            &target,
            1.0,
            &EquilibriumOptions::default(),
        )?;
        let x = [0, 1].map(|i| std::array::from_fn(|k| from[i][k] + found.u[STRIDE * i + k]));
        let truth = cross(sub(x[1], x[0]), force);
        let mut evaluation = set.allocate();
        set.evaluate(&found.u, &mut evaluation)?;
        let mut forces = vec![0.0; 2 * STRIDE];
        set.forces_of(weld, &evaluation, &found.multipliers)?.into_iter().for_each(|(j, f)| forces[j] = f);
        let on_a = (moment(kinds[0], &forces), [forces[0], forces[1], forces[2]]);
        assert!(norm(sub(on_a.0, truth)) < 1e-9 * norm(truth), "{:?}, {truth:?}", on_a.0);
        assert!(norm(sub(on_a.1, force)) < 1e-9 * norm(force), "{:?}", on_a.1);
        assert!(norm(moment(kinds[1], &forces[STRIDE..])) < 1e-9 * norm(truth));
        // The support carries the same.
        assert!(norm(add(moment(kinds[0], &found.reactions), truth)) < 1e-9 * norm(truth));
    }
    Ok(())
}

//! Node-to-face contact: gaps `g(u) = C u - b >= 0`, pressures `p >= 0`, `p g = 0`, by an active set.
//!
//! Two elastic strips, each a string on springs, lie on top of each other. The upper one is curved and pressed down; its nodes meet the faces
//! of the lower one. Each upper node has the constraint "the gap is closed", inactive at first. Constraints with a negative gap are activated
//! and those that pull are deactivated, until nothing changes. The result minimises `u^T K u / 2 - f^T u` subject to `g(u) >= 0`.
//!
//! `cargo run -p qless-solve --example contact`

use faer::sparse::{SparseColMat, Triplet};
use qless::Options;
use qless_constraints::types::LinearEquation;
use qless_constraints::{ActiveSystem, ConstraintId, ConstraintSet};
use qless_solve::enforce::Problem;

type Outcome<T = ()> = Result<T, Box<dyn std::error::Error>>;

/// Two strips; each node has one DOF, its deflection. Units of length and force are arbitrary.
#[derive(Clone, Copy, Debug)]
pub struct Strips {
    /// Nodes of the upper strip.
    pub upper: usize,
    /// Nodes of the lower strip, over the same length.
    pub lower: usize,
    /// Length of the strips.
    pub length: f64,
    /// Curvature of the upper strip: the gap before loading is `x^2 curvature / 2` from the middle.
    pub curvature: f64,
    /// Stiffness of each spring, force per length.
    pub stiffness: f64,
    /// Force on each node of the upper strip, downwards.
    pub force: f64,
}

/// Deflections and contact forces.
#[derive(Clone, Debug)]
pub struct Contact {
    /// u, upper nodes first.
    pub u: Vec<f64>,
    /// One gap per upper node.
    pub gaps: Vec<f64>,
    /// One contact force per upper node.
    pub pressures: Vec<f64>,
    /// Rank of the active constraints in each iteration.
    pub ranks: Vec<usize>,
}

impl Strips {
    /// Number of DOFs.
    pub fn dofs(&self) -> usize {
        self.upper + self.lower
    }

    /// Springs `(DOF, other DOF or the ground, stiffness)` between neighbours and to the ground. The support of the upper strip is soft.
    pub fn springs(&self) -> Vec<(usize, Option<usize>, f64)> {
        let ground = |i: usize| (i, None, if i < self.upper { 0.01 } else { 1.0 } * self.stiffness);
        let pair = |i: usize| (i, Some(i + 1), self.stiffness);
        let pairs = (0..self.dofs() - 1).filter(|&i| i + 1 != self.upper).map(pair);
        (0..self.dofs()).map(ground).chain(pairs).collect()
    }

    /// Loads on the DOFs.
    pub fn loads(&self) -> Vec<f64> {
        (0..self.dofs()).map(|i| if i < self.upper { -self.force } else { 0.0 }).collect()
    }

    /// `g_i = u_i - (1 - s) u_a - s u_b + gap_i`: the terms and the gap before loading.
    pub fn gap(&self, i: usize) -> (Vec<(usize, f64)>, f64) {
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

    /// Changes the active set until all gaps and pressures have the right sign.
    ///
    /// # Errors
    /// If the model is not supported, or the active set does not converge.
    pub fn solve(&self) -> Outcome<Contact> {
        let mut builder = ConstraintSet::builder(self.dofs());
        let add = |i: usize| {
            let (terms, gap) = self.gap(i);
            builder.add(format!("node {i}"), LinearEquation { terms, rhs: -gap })
        };
        let nodes = (0..self.upper).map(add).collect::<Result<Vec<ConstraintId>, _>>()?;
        let mut set = builder.build()?;
        nodes.iter().try_for_each(|&node| set.deactivate(node))?;
        let (k, f) = (self.matrix()?, self.loads());
        let (mut evaluation, mut system) = (set.allocate(), ActiveSystem::new(&set, Options::default())?);
        let mut ranks = Vec::new();
        for _ in 0..10 * self.upper {
            set.evaluate(&vec![0.0; self.dofs()], &mut evaluation)?;
            system.update(&set, &evaluation)?;
            ranks.push(system.rank());
            let (u, pressures) = balance(&k, &f, (&set, &evaluation), &nodes)?;
            let gaps: Vec<f64> = (0..self.upper).map(|i| self.gap_at(i, &u)).collect();
            if !change(&mut set, &nodes, &gaps, &pressures)? {
                return Ok(Contact { u, gaps, pressures, ranks });
            }
        }
        Err("the active set does not settle".into())
    }

    fn gap_at(&self, i: usize, u: &[f64]) -> f64 {
        let (terms, gap) = self.gap(i);
        terms.iter().map(|&(j, a)| a * u[j]).sum::<f64>() + gap
    }
}

/// u, and the pressures of all nodes: the multiplier of `K u + C^T lambda = f` pulls, a pressure pushes.
fn balance(
    k: &SparseColMat<usize, f64>,
    f: &[f64],
    (set, evaluation): (&ConstraintSet, &qless_constraints::Evaluation),
    nodes: &[ConstraintId],
) -> Outcome<(Vec<f64>, Vec<f64>)> {
    let system = set.linearised(evaluation, &[])?;
    let solution = Problem::new(k, f, &system)?.lagrange()?;
    let pressure = |&node: &ConstraintId| Ok(set.rows_of(node)?.first().map_or(0.0, |&row| -solution.multipliers[row]));
    let pressures = nodes.iter().map(pressure).collect::<Outcome<Vec<f64>>>()?;
    Ok((solution.u, pressures))
}

/// Activates overlapping nodes and deactivates pulling ones; returns whether any changed.
fn change(set: &mut ConstraintSet, nodes: &[ConstraintId], gaps: &[f64], pressures: &[f64]) -> Outcome<bool> {
    let mut changed = false;
    for ((&node, &gap), &pressure) in nodes.iter().zip(gaps).zip(pressures) {
        let active = set.is_active(node)?;
        if active && pressure < 0.0 {
            set.deactivate(node)?;
        } else if !active && gap < 0.0 {
            set.activate(node)?;
        } else {
            continue;
        }
        changed = true;
    }
    Ok(changed)
}

#[allow(dead_code, reason = "the tests use the rest")]
fn main() -> Outcome {
    let strips = Strips { upper: 9, lower: 6, length: 8.0, curvature: 0.05, stiffness: 1000.0, force: 50.0 };
    let contact = strips.solve()?;
    println!("closed gaps in each iteration: {:?}", contact.ranks);
    for (i, (gap, pressure)) in contact.gaps.iter().zip(&contact.pressures).enumerate() {
        println!("node {i}: gap {gap:9.2e}, contact force {pressure:9.4}");
    }
    Ok(())
}

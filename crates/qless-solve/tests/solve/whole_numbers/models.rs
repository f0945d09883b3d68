//! Small random models of small whole numbers.

use faer::sparse::{SparseColMat, Triplet};
use qless::common::SplitMix64;
use qless::{ConstraintSystem, SystemBuilder};

use super::exact;
use crate::linkages::Outcome;

/// u and the multipliers.
pub type Solution = (Vec<f64>, Vec<f64>);

/// Random numbers, the same in every run.
pub struct Random(SplitMix64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(SplitMix64::new(seed))
    }

    /// From 0 to n - 1.
    pub fn below(&mut self, n: u64) -> usize {
        (self.0.next() % n) as usize
    }

    /// From -most to most.
    fn number(&mut self, most: i128) -> i128 {
        self.below(2 * most as u64 + 1) as i128 - most
    }

    /// As `number`, or zero in one case of two.
    fn sparse(&mut self, most: i128) -> i128 {
        if self.below(2) == 0 { 0 } else { self.number(most) }
    }
}

#[derive(Clone)]
pub struct Model {
    pub name: String,
    pub k: Vec<Vec<i128>>,
    pub f: Vec<i128>,
    pub c: Vec<Vec<i128>>,
    pub b: Vec<i128>,
    pub prescribed: Vec<Option<i128>>,
}

/// The floating-point model that a solver gets.
pub struct Given {
    pub k: SparseColMat<usize, f64>,
    pub f: Vec<f64>,
    pub system: ConstraintSystem,
}

fn stiffness(random: &mut Random, kind: usize, n: usize) -> Vec<Vec<i128>> {
    let mut k = vec![vec![0; n]; n];
    match kind {
        0 | 1 => {
            for _ in 0..n {
                // Springs between two DOFs, to the ground, or along any direction.
                let mut v = vec![0; n];
                if kind == 0 {
                    v[random.below(n as u64)] += 1;
                    v[random.below(n as u64)] -= 1;
                } else {
                    v.iter_mut().for_each(|v| *v = random.sparse(2));
                }
                (0..n).for_each(|i| (0..n).for_each(|j| k[i][j] += 2 * v[i] * v[j]));
            }
        }
        2 => (0..n).for_each(|i| (0..=i).for_each(|j| (k[i][j], k[j][i]) = [random.sparse(4); 2].into())),
        3 => k.iter_mut().flatten().for_each(|v| *v = random.sparse(4)),
        4 => {
            for (i, j) in (0..n).flat_map(|i| (0..i).map(move |j| (i, j))) {
                let v = random.number(3);
                (k[i][j], k[j][i]) = (v, -v);
            }
            (0..n).for_each(|i| k[i][i] = random.number(2).max(0));
        }
        _ => (0..n).for_each(|i| k[i][i] = random.sparse(4)),
    }
    k
}

/// Equations of one to three DOFs, and sums of others.
fn equations(random: &mut Random, m: usize, n: usize) -> (Vec<Vec<i128>>, Vec<i128>) {
    let (mut c, mut b): (Vec<Vec<i128>>, Vec<i128>) = (Vec::new(), Vec::new());
    for i in 0..m {
        if i > 0 && random.below(3) == 0 {
            let (p, q, x, y) = (random.below(i as u64), random.below(i as u64), random.number(3), random.number(3));
            c.push((0..n).map(|j| x * c[p][j] + y * c[q][j]).collect());
            b.push(x * b[p] + y * b[q] + i128::from(random.below(50) == 0));
            continue;
        }
        let mut row = vec![0; n];
        (0..=random.below(3)).for_each(|_| row[random.below(n as u64)] = random.number(3));
        b.push(if row.iter().all(|v| *v == 0) { 0 } else { random.sparse(3) });
        c.push(row);
    }
    (c, b)
}

pub fn model(seed: usize) -> Model {
    let mut random = Random::new(seed as u64 * 7919 + 13);
    let n = 1 + random.below(8);
    let kind = random.below(6);
    let k = stiffness(&mut random, kind, n);
    let m = random.below(n as u64 + 2);
    let (c, b) = equations(&mut random, m, n);
    let prescribed = (0..n).map(|_| (random.below(7) == 0).then(|| random.number(2))).collect();
    let f = (0..n).map(|_| random.number(5)).collect();
    let kinds = ["springs", "semidefinite", "indefinite", "unsymmetric", "skew", "diagonal"];
    Model { name: format!("{seed}, {}", kinds[kind]), k, f, c, b, prescribed }
}

impl Model {
    pub fn free(&self) -> Vec<usize> {
        (0..self.f.len()).filter(|&j| self.prescribed[j].is_none()).collect()
    }

    pub fn less_prescribed(&self, row: &[i128], rhs: i128) -> i128 {
        rhs - row.iter().zip(&self.prescribed).map(|(v, u)| v * u.unwrap_or(0)).sum::<i128>()
    }

    /// The rank of the equations on the free DOFs, and whether they contradict each other.
    pub fn rank(&self) -> Option<(usize, bool)> {
        let free = self.free();
        let row = |(row, &b): (&Vec<i128>, &i128)| {
            free.iter().map(|&j| row[j]).chain([self.less_prescribed(row, b)]).collect()
        };
        let rows: Vec<Vec<i128>> = self.c.iter().zip(&self.b).map(row).collect();
        let (pivots, _) = exact::echelon(&rows, free.len() + 1)?;
        let conflict = pivots.contains(&free.len());
        Some((pivots.len() - usize::from(conflict), conflict))
    }

    /// u and the multipliers of the given equations; none if they are not determined.
    pub fn solution(&self, kept: &[usize]) -> Result<Option<Solution>, exact::TooLarge> {
        let free = self.free();
        let of_dof = |&i: &usize| {
            let forces = free.iter().map(|&j| self.k[i][j]).chain(kept.iter().map(|&r| self.c[r][i]));
            forces.chain([self.less_prescribed(&self.k[i], self.f[i])]).collect()
        };
        let of_row = |&r: &usize| {
            let gap = free.iter().map(|&j| self.c[r][j]).chain(kept.iter().map(|_| 0));
            gap.chain([self.less_prescribed(&self.c[r], self.b[r])]).collect()
        };
        let rows: Vec<Vec<i128>> = free.iter().map(of_dof).chain(kept.iter().map(of_row)).collect();
        let Some(x) = exact::solution(&rows)? else { return Ok(None) };
        let mut u: Vec<f64> = self.prescribed.iter().map(|u| u.unwrap_or(0) as f64).collect();
        free.iter().zip(&x).for_each(|(&j, &x)| u[j] = x);
        let mut lambda = vec![0.0; self.c.len()];
        kept.iter().zip(&x[free.len()..]).for_each(|(&r, &x)| lambda[r] = x);
        Ok(Some((u, lambda)))
    }

    /// The model in other units of length and force.
    pub fn given(&self, length: f64, force: f64) -> Outcome<Given> {
        self.given_in(length, force, &vec![1.0; self.f.len()])
    }

    /// As `given`, with a unit of each DOF as well.
    pub fn given_in(&self, length: f64, force: f64, units: &[f64]) -> Outcome<Given> {
        let n = self.f.len();
        let stiffness = |i: usize, j: usize| self.k[i][j] as f64 * force / length / (units[i] * units[j]);
        let entries = (0..n).flat_map(|i| (0..n).map(move |j| (i, j))).filter(|&(i, j)| self.k[i][j] != 0);
        let entries: Vec<_> = entries.map(|(i, j)| Triplet::new(i, j, stiffness(i, j))).collect();
        let mut builder = SystemBuilder::new(n);
        for (row, &b) in self.c.iter().zip(&self.b) {
            let terms = row.iter().enumerate().filter(|(_, v)| **v != 0);
            builder.equation(terms.map(|(j, &v)| (j, v as f64 / units[j])), b as f64 * length);
        }
        for (j, u) in self.prescribed.iter().enumerate().filter_map(|(j, u)| u.map(|u| (j, u))) {
            builder.prescribe(j, u as f64 * length * units[j]);
        }
        Ok(Given {
            k: SparseColMat::try_new_from_triplets(n, n, &entries)?,
            f: self.f.iter().zip(units).map(|(&f, unit)| f as f64 * force / unit).collect(),
            system: builder.build()?,
        })
    }
}

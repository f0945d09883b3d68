use std::error::Error;

use qless_constraints::ConstraintSet;
use qless_constraints::types::{MacroStrain, Periodic, PlanarPoint};
use qless_solve::equilibrium::{Assembly, Equilibrium, EquilibriumOptions, Model, Start, Target, solve};

use crate::equilibria::{UNITS, assert_quadratic};
use crate::linkages::Outcome;

type Matrix = [[f64; 2]; 2];

fn matrix(entry: impl Fn(usize, usize) -> f64) -> Matrix {
    [0, 1].map(|i| [0, 1].map(|j| entry(i, j)))
}

fn product(a: Matrix, b: Matrix) -> Matrix {
    matrix(|i, j| a[i][0] * b[0][j] + a[i][1] * b[1][j])
}

fn transposed(a: Matrix) -> Matrix {
    matrix(|i, j| a[j][i])
}

/// `S = lambda tr(E) I + 2 mu E`, and `W = S : E / 2` (St. Venant and Kirchhoff), in plane strain.
fn stress(e: Matrix, [lambda, mu]: [f64; 2]) -> Matrix {
    matrix(|i, j| 2.0 * mu * e[i][j] + if i == j { lambda * (e[0][0] + e[1][1]) } else { 0.0 })
}

fn green(f: Matrix) -> Matrix {
    let c = product(transposed(f), f);
    matrix(|i, j| 0.5 * (c[i][j] - if i == j { 1.0 } else { 0.0 }))
}

fn energy_density(f: Matrix, moduli: [f64; 2]) -> f64 {
    let (e, s) = (green(f), stress(green(f), moduli));
    0.5 * (0..4).map(|k| e[k / 2][k % 2] * s[k / 2][k % 2]).sum::<f64>()
}

/// A square of n by n elements with four nodes, of thickness 1; the last four DOFs are the macroscopic displacement gradient.
struct Cell {
    n: usize,
    side: f64,
    /// Moduli of each element.
    moduli: Vec<[f64; 2]>,
}

impl Cell {
    fn node(&self, i: usize, j: usize) -> usize {
        i * (self.n + 1) + j
    }

    fn nodes(&self) -> usize {
        (self.n + 1).pow(2)
    }

    fn at(&self, i: usize, j: usize) -> PlanarPoint {
        let (node, h) = (self.node(i, j), self.side / self.n as f64);
        PlanarPoint::new([2 * node, 2 * node + 1], [h * i as f64, h * j as f64])
    }

    fn corners(&self, element: usize) -> [usize; 4] {
        let (i, j) = (element / self.n, element % self.n);
        [self.node(i, j), self.node(i + 1, j), self.node(i + 1, j + 1), self.node(i, j + 1)]
    }

    /// Calls `at` at each integration point with the gradients of shapes, F and the weight.
    fn integrate(&self, element: usize, u: &[f64], mut at: impl FnMut([[f64; 2]; 4], Matrix, f64)) {
        let (h, g) = (self.side / self.n as f64, 1.0 / 3.0_f64.sqrt());
        let corners = self.corners(element);
        for [x, y] in [[-g, -g], [g, -g], [g, g], [-g, g]] {
            let signs = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
            let slopes = signs.map(|[s, t]: [f64; 2]| [s * (1.0 + t * y) / (2.0 * h), t * (1.0 + s * x) / (2.0 * h)]);
            let f = matrix(|i, j| {
                (0..4).map(|a| u[2 * corners[a] + i] * slopes[a][j]).sum::<f64>() + if i == j { 1.0 } else { 0.0 }
            });
            at(slopes, f, 0.25 * h * h);
        }
    }

    fn energy(&self, u: &[f64]) -> f64 {
        let mut sum = 0.0;
        for element in 0..self.n * self.n {
            self.integrate(element, u, |_, f, weight| sum += weight * energy_density(f, self.moduli[element]));
        }
        sum
    }

    fn ties(&self) -> Outcome<ConstraintSet> {
        let first = 2 * self.nodes();
        let strain = MacroStrain::Dofs([[first, first + 1], [first + 2, first + 3]]);
        let mut builder = ConstraintSet::builder(first + 4);
        for k in 0..=self.n {
            builder.add(format!("x {k}"), Periodic { a: self.at(0, k), b: self.at(self.n, k), strain })?;
            builder.add(format!("y {k}"), Periodic { a: self.at(k, 0), b: self.at(k, self.n), strain })?;
        }
        Ok(builder.build()?)
    }

    /// The cell under a macroscopic displacement gradient.
    fn strained(&mut self, gradient: Matrix) -> Outcome<(ConstraintSet, Equilibrium)> {
        let (set, first) = (self.ties()?, 2 * self.nodes());
        let mut prescribed = vec![(0, 0.0), (1, 0.0)];
        prescribed.extend((0..4).map(|k| (first + k, gradient[k / 2][k % 2])));
        let loads = vec![0.0; set.dofs()];
        let target = Target { loads: &loads, prescribed: &prescribed };
        let found = solve(self, &set, &Start::at_rest(&set), &target, &EquilibriumOptions::default())?;
        Ok((set, found))
    }

    /// `P V` from the reactions at the macroscopic gradient, and from the multipliers: `-sum lambda_i (X_b - X_a)_j`.
    fn stresses(&self, set: &ConstraintSet, found: &Equilibrium) -> Outcome<[Matrix; 2]> {
        let reactions = matrix(|i, j| found.reactions[2 * self.nodes() + 2 * i + j]);
        let mut sum = [[0.0; 2]; 2];
        for (row, lambda) in found.multipliers.in_rows(set)?.iter().enumerate() {
            let label = set.label(row)?;
            let (along, component) = (usize::from(label.starts_with('y')), usize::from(label.ends_with('y')));
            sum[component][along] -= lambda * self.side;
        }
        Ok([reactions, sum])
    }
}

impl Model for Cell {
    fn dofs(&self) -> usize {
        2 * self.nodes() + 4
    }

    fn pattern(&self, entry: &mut dyn FnMut(usize, usize)) {
        for element in 0..self.n * self.n {
            let corners = self.corners(element);
            for (i, j) in (0..64).map(|k| (k / 8, k % 8)) {
                entry(2 * corners[i / 2] + i % 2, 2 * corners[j / 2] + j % 2);
            }
        }
    }

    fn coordinate(&self, dof: usize) -> f64 {
        if dof < 2 * self.nodes() { self.side } else { 1.0 }
    }

    fn assemble(&mut self, u: &[f64], out: &mut Assembly) -> Result<(), Box<dyn Error + Send + Sync>> {
        for element in 0..self.n * self.n {
            let (corners, moduli) = (self.corners(element), self.moduli[element]);
            self.integrate(element, u, |slopes, f, weight| {
                let s = stress(green(f), moduli);
                let p = product(f, s);
                for a in 0..8 {
                    let (of_a, i) = (slopes[a / 2], a % 2);
                    out.force(2 * corners[a / 2] + i, weight * (p[i][0] * of_a[0] + p[i][1] * of_a[1]));
                    for b in 0..8 {
                        let df = matrix(|k, j| if k == b % 2 { slopes[b / 2][j] } else { 0.0 });
                        let half = product(transposed(f), df);
                        let ds = stress(matrix(|k, j| 0.5 * (half[k][j] + half[j][k])), moduli);
                        let (first, second) = (product(df, s), product(f, ds));
                        let dp = [0, 1].map(|j| first[i][j] + second[i][j]);
                        let k = weight * (dp[0] * of_a[0] + dp[1] * of_a[1]);
                        out.stiffness(2 * corners[a / 2] + i, 2 * corners[b / 2] + b % 2, k);
                    }
                }
            });
        }
        Ok(())
    }
}

const GRADIENT: Matrix = [[0.3, 0.25], [0.1, -0.1]];

/// `|a - b|` relative to the largest entry of b.
fn off(a: Matrix, b: Matrix) -> f64 {
    let entries = || (0..4).map(|k| (k / 2, k % 2));
    let size = entries().map(|(i, j)| b[i][j].abs()).fold(0.0, f64::max);
    entries().map(|(i, j)| (a[i][j] - b[i][j]).abs()).fold(0.0, f64::max) / size
}

/// With one material the strain is uniform: the energy is `W(F) V`, and `P = F S` from reactions and from multipliers.
#[test]
fn a_homogeneous_cell_is_strained_homogeneously() -> Outcome {
    for [length, force] in UNITS {
        // The thickness is one unit of length, so that moduli scale with the length only.
        let unit = force / length;
        let moduli = [1.5 * unit, 0.8 * unit];
        let mut cell = Cell { n: 4, side: length, moduli: vec![moduli; 16] };
        let (set, found) = cell.strained(GRADIENT)?;
        let f = matrix(|i, j| GRADIENT[i][j] + if i == j { 1.0 } else { 0.0 });
        let energy = energy_density(f, moduli) * length * length;
        assert!((cell.energy(&found.u) / energy - 1.0).abs() < 1e-10, "{} {energy}", cell.energy(&found.u));
        let p = product(f, stress(green(f), moduli));
        let truth = matrix(|i, j| p[i][j] * length * length);
        for found in cell.stresses(&set, &found)? {
            assert!(off(found, truth) < 1e-9, "{length} {force}: {found:?} {truth:?}");
        }
        assert_eq!(found.redundant.len(), 2);
    }
    Ok(())
}

/// With stiff inclusions, P is the derivative of the energy of the cell by the macroscopic gradient (Hill), by central differences of other
/// solutions.
#[test]
fn the_stress_of_a_cell_with_inclusions_is_that_of_its_energy() -> Outcome {
    for [length, force] in UNITS {
        let unit = force / length;
        let n = 6;
        let moduli = |e: usize| if (e * e) % 5 == 1 { [30.0 * unit, 20.0 * unit] } else { [1.5 * unit, 0.8 * unit] };
        let mut cell = Cell { n, side: length, moduli: (0..n * n).map(moduli).collect() };
        let (set, found) = cell.strained(GRADIENT)?;
        assert_quadratic(&format!("cell, units {length} {force}"), &found, 1e4);
        let step = 1e-5;
        let mut energy = |i: usize, j: usize, sign: f64| -> Outcome<f64> {
            let mut gradient = GRADIENT;
            gradient[i][j] += sign * step;
            let found = cell.strained(gradient)?.1;
            Ok(cell.energy(&found.u))
        };
        let mut slopes = [[0.0; 2]; 2];
        for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            slopes[i][j] = (energy(i, j, 1.0)? - energy(i, j, -1.0)?) / (2.0 * step);
        }
        for stress in cell.stresses(&set, &found)? {
            assert!(off(stress, slopes) < 1e-7, "{length} {force}: {stress:?} {slopes:?}");
        }
    }
    Ok(())
}

//! `RBE3`: the reference moves as the weighted mean of grid points, `u_r = A_r S^-1 sum w_k a_k^T u_k` with `S = sum
//! w_k a_k^T a_k`.
//!
//! a_k is the motion row of connected component k and w_k its weight; A_r holds the rows of the reference components.
//! The weight of a rotation is multiplied by L^2, where L is the mean distance of the grid points from the reference;
//! this makes the result independent of the unit of length. With a `UM` list, the equations are solved for the
//! components in it, which does not change their meaning.

use rustc_hash::FxHashMap;

use super::body::{MotionRow, Pose, clean, product};
use super::components::Components;
use super::dense::{DenseFactor, solved_for};
use super::row::{Poses, Row};
use super::vector::{Vector, length, minus, plus, scaled};
use crate::deck::{CardFault, Dof, Problem};

/// Components of some grid points with the same weight.
#[derive(Clone, Debug, PartialEq)]
pub struct Group {
    pub weight: f64,
    pub components: Components,
    pub nodes: Vec<u32>,
}

/// The element, as on its card.
#[derive(Clone, Debug, PartialEq)]
pub struct Mean {
    pub reference: u32,
    pub components: Components,
    pub groups: Vec<Group>,
    /// Components to solve for (`UM`); may be empty.
    pub dependent: Vec<(u32, Components)>,
}

impl Mean {
    /// One equation for each component of the reference, solved for the `UM` components if there are any.
    pub fn rows(&self, poses: &impl Poses) -> Result<Vec<Row>, Problem> {
        let reference = poses.pose(self.reference)?;
        let body = ConnectedBody::new(self, &reference, poses)?;
        let row = |component| {
            let dof = Dof { node: self.reference, component };
            let undetermined = CardFault::MeanUndetermined { node: dof.node, component };
            body.mean(&reference, component).map(|terms| Row::new(dof, terms)).ok_or(undetermined)
        };
        let rows: Vec<Row> = self.components.iter().map(row).collect::<Result<_, _>>()?;
        if self.dependent.is_empty() {
            return Ok(rows);
        }
        let named = |&(node, set): &(u32, Components)| set.iter().map(move |component| Dof { node, component });
        let dependent: Vec<Dof> = self.dependent.iter().flat_map(|part| named(part).collect::<Vec<_>>()).collect();
        solved_for(&rows, &dependent, body.size)
    }
}

/// Connected components with their motion rows about their centre; rotations are converted to lengths.
struct ConnectedBody {
    dofs: Vec<(Dof, MotionRow, f64)>,
    centre: Vector,
    size: f64,
    /// Factor of `D S D`, where D scales the diagonal to ones: rotations may weigh far more than translations.
    normal: DenseFactor,
    scale: MotionRow,
}

impl ConnectedBody {
    fn new(element: &Mean, reference: &Pose, poses: &impl Poses) -> Result<Self, Problem> {
        let nodes = element.nodes(poses)?;
        let count = nodes.len() as f64;
        let centre = nodes.iter().fold([0.0; 3], |sum, (_, pose)| plus(sum, scaled(pose.position, 1.0 / count)));
        let from = |point: Vector| nodes.iter().map(move |(_, pose)| length(minus(pose.position, point)));
        let size = from(centre).fold(0.0, f64::max);
        let arm = from(reference.position).sum::<f64>() / count;
        let unit = |length: f64| if length > 0.0 { length } else { 1.0 };
        let mut body = Self {
            dofs: Vec::new(),
            centre,
            size: unit(size),
            normal: DenseFactor::new(0, Vec::new()),
            scale: [1.0; 6],
        };
        let poses: FxHashMap<u32, Pose> = nodes.into_iter().collect();
        for (dof, weight) in element.weights()? {
            let weight = if dof.component > 3 { weight * unit(arm).powi(2) } else { weight };
            body.dofs.push((dof, body.row(&poses[&dof.node], dof.component), weight));
        }
        let s = body.normal_matrix();
        body.scale = std::array::from_fn(|i| if s[7 * i] > 0.0 { 1.0 / s[7 * i].sqrt() } else { 1.0 });
        let scaled = s.iter().enumerate().map(|(k, value)| value * body.scale[k / 6] * body.scale[k % 6]);
        body.normal = DenseFactor::new(6, scaled.collect());
        Ok(body)
    }

    /// Motion row with rotations converted to lengths.
    fn row(&self, pose: &Pose, component: u8) -> MotionRow {
        let [a, b, c, d, e, f] = pose.row(component, self.centre);
        [a, b, c, d / self.size, e / self.size, f / self.size]
    }

    /// Matrix S, by rows.
    fn normal_matrix(&self) -> Vec<f64> {
        let mut s = vec![0.0; 36];
        for (_, row, weight) in &self.dofs {
            for i in 0..6 {
                (0..6).for_each(|j| s[6 * i + j] += weight * row[i] * row[j]);
            }
        }
        s
    }

    /// Coefficients of the connected components for one component of the reference; `None` if they do not determine
    /// it.
    fn mean(&self, reference: &Pose, component: u8) -> Option<Vec<(Dof, f64)>> {
        let scaled = |row: &MotionRow| -> MotionRow { std::array::from_fn(|i| row[i] * self.scale[i]) };
        let mut motion = self.normal.solve(&scaled(&self.row(reference, component)))?;
        let largest = motion.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
        motion.iter_mut().for_each(|x| *x = clean(*x, largest));
        Some(self.dofs.iter().map(|(dof, row, weight)| (*dof, weight * product(&scaled(row), &motion))).collect())
    }
}

impl Mean {
    /// Connected grid points, each once, in the order of the card.
    fn nodes(&self, poses: &impl Poses) -> Result<Vec<(u32, Pose)>, Problem> {
        let mut seen = rustc_hash::FxHashSet::default();
        let nodes = self.groups.iter().flat_map(|group| &group.nodes).filter(|node| seen.insert(**node));
        let nodes: Vec<_> = nodes.map(|&node| poses.pose(node).map(|pose| (node, pose))).collect::<Result<_, _>>()?;
        if nodes.is_empty() || self.components.is_empty() { Err(CardFault::NothingConnected.into()) } else { Ok(nodes) }
    }

    /// Weights of the connected components; repeated components add up.
    pub(super) fn weights(&self) -> Result<Vec<(Dof, f64)>, Problem> {
        let mut places = FxHashMap::default();
        let mut weights: Vec<(Dof, f64)> = Vec::new();
        for group in &self.groups {
            for &node in &group.nodes {
                for component in group.components.iter() {
                    if node == self.reference && self.components.contains(component) {
                        return Err(CardFault::OnBothSides { node, component }.into());
                    }
                    let dof = Dof { node, component };
                    let place = *places.entry(dof).or_insert_with(|| {
                        weights.push((dof, 0.0));
                        weights.len() - 1
                    });
                    weights[place].1 += group.weight;
                }
            }
        }
        Ok(weights)
    }
}

/// The mean over the reference's own components only: `u_r = S^-1 sum w_k a_k^T u_k` with `S = sum w_k a_k^T a_k`,
/// where a_k has only their columns. Without rotations among them it is the weighted mean, without lever arms.
/// MYSTRAN's `RBE3` works this way.
pub fn partial_rows(element: &Mean, poses: &impl Poses) -> Result<Vec<Row>, Problem> {
    let reference = poses.pose(element.reference)?;
    let own: Vec<u8> = element.components.iter().collect();
    let mut connected: Vec<(Dof, f64, Vec<f64>)> = Vec::new();
    for (dof, weight) in element.weights()? {
        let row: MotionRow = poses.pose(dof.node)?.seen_from(&reference).row(dof.component, [0.0; 3]);
        connected.push((dof, weight, own.iter().map(|&component| row[component as usize - 1]).collect()));
    }
    let (factor, scale) = partial_normal(&connected, own.len());
    let row = |(i, &component): (usize, &u8)| {
        let mut unit = vec![0.0; own.len()];
        unit[i] = scale[i];
        let undetermined = || CardFault::MeanUndetermined { node: element.reference, component };
        let motion = Some(&factor).filter(|factor| factor.is_regular()).and_then(|factor| factor.solve(&unit));
        let motion = motion.ok_or_else(undetermined)?;
        let largest = motion.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
        let motion: Vec<f64> = motion.iter().zip(&scale).map(|(x, d)| clean(*x, largest) * d).collect();
        let share = |row: &[f64]| row.iter().zip(&motion).map(|(a, x)| a * x).sum::<f64>();
        let terms = connected.iter().map(|(dof, weight, row)| (*dof, weight * share(row)));
        Ok(Row::new(Dof { node: element.reference, component }, terms))
    };
    own.iter().enumerate().map(row).collect()
}

/// Factor of `D S D`, whose diagonal is 1, and D.
fn partial_normal(connected: &[(Dof, f64, Vec<f64>)], n: usize) -> (DenseFactor, Vec<f64>) {
    let mut s = vec![0.0; n * n];
    for (_, weight, row) in connected {
        (0..n * n).for_each(|k| s[k] += weight * row[k / n] * row[k % n]);
    }
    let scale: Vec<f64> = (0..n).map(|i| s[(n + 1) * i]).map(|x| if x > 0.0 { 1.0 / x.sqrt() } else { 1.0 }).collect();
    let scaled = (0..n * n).map(|k| s[k] * scale[k / n] * scale[k % n]).collect();
    (DenseFactor::new(n, scaled), scale)
}

#[cfg(test)]
mod tests {
    use super::super::axes::BASIC_AXES;
    use super::super::row::samples::{Irregular, rigid_residual};
    use super::*;

    fn set(digits: &str) -> Components {
        Components::parse(digits.as_bytes()).expect("components")
    }

    fn mean(refc: &str, groups: &[(f64, &str, &[u32])]) -> Mean {
        let group = |&(weight, digits, nodes): &(f64, &str, &[u32])| Group {
            weight,
            components: set(digits),
            nodes: nodes.to_vec(),
        };
        Mean { reference: 9, components: set(refc), groups: groups.iter().map(group).collect(), dependent: Vec::new() }
    }

    /// Node k on a unit square about node 9, with global axes.
    struct SquareMatrix;

    impl Poses for SquareMatrix {
        fn pose(&self, node: u32) -> Result<Pose, Problem> {
            let position = match node {
                1 => [1.0, 1.0, 0.0],
                2 => [-1.0, 1.0, 0.0],
                3 => [-1.0, -1.0, 0.0],
                4 => [1.0, -1.0, 0.0],
                _ => [0.0; 3],
            };
            Ok(Pose { position, axes: BASIC_AXES })
        }
    }

    #[test]
    fn the_middle_of_a_square_moves_as_the_mean_of_its_corners() {
        let rows = mean("16", &[(2.0, "123", &[1, 2, 3, 4])]).rows(&SquareMatrix).expect("rows");
        let terms = |row: usize| {
            rows[row].terms.iter().map(|&(dof, value)| (dof.node, dof.component, value)).collect::<Vec<_>>()
        };
        assert_eq!(terms(0), [(9, 1, 1.0), (1, 1, -0.25), (2, 1, -0.25), (3, 1, -0.25), (4, 1, -0.25)]);
        let turn = [(9, 6, 1.0), (1, 1, 0.125), (1, 2, -0.125), (2, 1, 0.125), (2, 2, 0.125)];
        assert_eq!(terms(1)[..5], turn);
    }

    #[test]
    fn rigid_motions_leave_no_residual() {
        let groups: [(f64, &str, &[u32]); 4] =
            [(2.3, "123", &[1, 2]), (12.0, "23", &[3]), (0.4, "456", &[4, 5]), (0.5, "136", &[1, 6])];
        let mut element = mean("123456", &groups);
        let rows = element.rows(&Irregular).expect("rows");
        assert_eq!(rows.len(), 6);
        assert!(rigid_residual(&rows, &Irregular) < 1e-12, "{}", rigid_residual(&rows, &Irregular));
        element.dependent = vec![(1, set("12")), (9, set("135")), (4, set("5"))];
        let rows = element.rows(&Irregular).expect("rows");
        assert!(rigid_residual(&rows, &Irregular) < 1e-12, "{}", rigid_residual(&rows, &Irregular));
        let slaves: Vec<_> = rows.iter().map(|row| row.terms[0]).collect();
        let slave = |node, component| (Dof { node, component }, 1.0);
        assert_eq!(slaves, [slave(1, 1), slave(1, 2), slave(9, 1), slave(9, 3), slave(9, 5), slave(4, 5)]);
        let others = rows.iter().flat_map(|row| &row.terms[1..]);
        assert_eq!(others.filter(|term| slaves.iter().any(|slave| slave.0 == term.0)).count(), 0);
    }

    /// Nodes 1 and 2 on either side of node 9, at distance `L`.
    struct Beam(f64);

    impl Poses for Beam {
        fn pose(&self, node: u32) -> Result<Pose, Problem> {
            let x = [(1, self.0), (2, -self.0)].into_iter().find_map(|(id, x)| (id == node).then_some(x));
            Ok(Pose { position: [x.unwrap_or(0.0), 0.0, 0.0], axes: BASIC_AXES })
        }
    }

    /// With `S = 2 (L^2 + L^2)`, a rotation has coefficient 1/4 in any unit of length, and a deflection `L / S`.
    #[test]
    fn rotations_weigh_the_same_in_every_unit_of_length() {
        for size in [1e-9, 1.0, 1000.0, 1e9] {
            let rows = mean("6", &[(3.0, "123456", &[1, 2])]).rows(&Beam(size)).expect("a row");
            let expected = [(9, 6, 1.0), (1, 2, -0.25 / size), (1, 6, -0.25), (2, 2, 0.25 / size), (2, 6, -0.25)];
            assert_eq!(rows[0].terms.len(), expected.len());
            for (&(dof, value), (node, component, wanted)) in rows[0].terms.iter().zip(expected) {
                assert_eq!(dof, Dof { node, component });
                assert!((value - wanted).abs() < 1e-14 * wanted.abs(), "{dof}: {value} for {wanted}");
            }
        }
    }

    #[test]
    fn one_point_determines_no_rotation() {
        let undetermined = CardFault::MeanUndetermined { node: 9, component: 6 };
        assert_eq!(mean("16", &[(1.0, "123", &[5])]).rows(&SquareMatrix), Err(undetermined.into()));
        assert_eq!(mean("123", &[(1.0, "123", &[5])]).rows(&SquareMatrix).map(|rows| rows.len()), Ok(3));
        assert_eq!(mean("1", &[(1.0, "123", &[])]).rows(&SquareMatrix), Err(CardFault::NothingConnected.into()));
        let twice = CardFault::OnBothSides { node: 9, component: 1 };
        assert_eq!(mean("1", &[(1.0, "123", &[9, 1])]).rows(&SquareMatrix), Err(twice.into()));
    }

    #[test]
    fn um_has_to_be_solvable() {
        let mut element = mean("12", &[(1.0, "123", &[1, 2, 3, 4])]);
        element.dependent = vec![(1, set("3")), (2, set("1"))];
        assert_eq!(element.rows(&SquareMatrix), Err(CardFault::UmSingular.into()));
        element.dependent = vec![(1, set("1"))];
        assert_eq!(element.rows(&SquareMatrix), Err(CardFault::UmCount { found: 1, expected: 2 }.into()));
    }
}

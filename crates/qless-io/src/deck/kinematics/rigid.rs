//! Rigid elements: `u_m = A_m A_n^-1 u_n`, where A holds the motion rows of the dependent (m) and of six independent (n)
//! components.
//!
//! `RBE2` has its six at one grid point, `RBAR` at two, `RBE1` at up to six. If all are at one point, A_n is
//! orthogonal and needs no factor.

use super::body::{MotionRow, Pose, clean};
use super::components::Components;
use super::dense::DenseFactor;
use super::row::{Poses, Row};
use super::vector::{Vector, length, minus, plus, scaled};
use crate::deck::{CardFault, Dof, Problem};

/// Components of grid points, in the order of the card.
pub type Side = Vec<(u32, Components)>;

/// A rigid element.
#[derive(Clone, Debug, PartialEq)]
pub struct Rigid {
    /// Independent components; six in all.
    pub independent: Side,
    pub dependent: Side,
}

impl Rigid {
    /// One equation for each dependent component, in the order of the card.
    pub fn rows(&self, poses: &impl Poses) -> Result<Vec<Row>, Problem> {
        self.check()?;
        match self.independent[..] {
            [(node, Components::ALL)] => self.about_one_point(node, poses),
            _ => self.general(poses),
        }
    }

    fn check(&self) -> Result<(), Problem> {
        let found = self.independent.iter().map(|(_, set)| set.len()).sum();
        if found != 6 {
            return Err(CardFault::IndependentCount { found }.into());
        }
        let both = |&(node, set): &(u32, Components)| {
            let shared = |&&(m, other): &&(u32, Components)| m == node && !other.and(set).is_empty();
            self.independent.iter().find(shared).and_then(|(_, other)| other.and(set).iter().next().map(|c| (node, c)))
        };
        match self.dependent.iter().find_map(both) {
            Some((node, component)) => Err(CardFault::OnBothSides { node, component }.into()),
            None if self.dependent.is_empty() => Err(CardFault::NothingConnected.into()),
            None => Ok(()),
        }
    }

    fn about_one_point(&self, node: u32, poses: &impl Poses) -> Result<Vec<Row>, Problem> {
        let centre = poses.pose(node)?;
        self.each_dependent(poses, |pose, component| {
            let row = pose.seen_from(&centre).row(component, [0.0; 3]);
            row.into_iter().zip(1..).map(|(value, component)| (Dof { node, component }, value)).collect()
        })
    }

    fn general(&self, poses: &impl Poses) -> Result<Vec<Row>, Problem> {
        let body = IndependentBody::new(&self.independent, poses)?;
        self.each_dependent(poses, |pose, component| body.depends(pose, component))
    }

    /// One row for each dependent component, with the given coefficients.
    fn each_dependent(
        &self,
        poses: &impl Poses,
        coefficients: impl Fn(&Pose, u8) -> Vec<(Dof, f64)>,
    ) -> Result<Vec<Row>, Problem> {
        let mut rows = Vec::with_capacity(self.dependent.iter().map(|(_, set)| set.len()).sum());
        for &(node, set) in &self.dependent {
            let pose = poses.pose(node)?;
            rows.extend(set.iter().map(|component| Row::new(Dof { node, component }, coefficients(&pose, component))));
        }
        Ok(rows)
    }
}

/// Independent components, with A_n^T factored. The size of the body converts rotations to lengths.
struct IndependentBody {
    components: Vec<Dof>,
    origin: Vector,
    size: f64,
    factor: DenseFactor,
}

impl IndependentBody {
    fn new(independent: &Side, poses: &impl Poses) -> Result<Self, Problem> {
        let placed: Vec<_> = independent
            .iter()
            .map(|&(node, set)| poses.pose(node).map(|pose| (node, set, pose)))
            .collect::<Result<_, _>>()?;
        let origin =
            placed.iter().fold([0.0; 3], |sum, (.., pose)| plus(sum, scaled(pose.position, 1.0 / placed.len() as f64)));
        let farthest = placed.iter().map(|(.., pose)| length(minus(pose.position, origin))).fold(0.0, f64::max);
        let size = if farthest > 0.0 { farthest } else { 1.0 };
        let mut body = Self { components: Vec::new(), origin, size, factor: DenseFactor::new(0, Vec::new()) };
        let mut transposed = vec![0.0; 36];
        for (node, set, pose) in placed {
            for component in set.iter() {
                let column = body.components.len();
                body.row(&pose, component)
                    .into_iter()
                    .enumerate()
                    .for_each(|(k, value)| transposed[6 * k + column] = value);
                body.components.push(Dof { node, component });
            }
        }
        body.factor = DenseFactor::new(6, transposed);
        if body.factor.is_regular() { Ok(body) } else { Err(CardFault::IndependentSingular.into()) }
    }

    /// Motion row with components and motions converted to lengths.
    fn row(&self, pose: &Pose, component: u8) -> MotionRow {
        let [a, b, c, d, e, f] = pose.row(component, self.origin);
        let unit = if component > 3 { self.size } else { 1.0 };
        [a, b, c, d / self.size, e / self.size, f / self.size].map(|x| x * unit)
    }

    /// Coefficients of the independent components for a dependent one.
    fn depends(&self, pose: &Pose, component: u8) -> Vec<(Dof, f64)> {
        // A nonsingular factor solves every system.
        let solution = self.factor.solve(&self.row(pose, component)).unwrap_or_default();
        let largest = solution.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
        let length = |at: u8| if at > 3 { self.size } else { 1.0 };
        let value = |(&at, x): (&Dof, f64)| (at, clean(x, largest) * length(at.component) / length(component));
        self.components.iter().zip(solution).map(value).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::row::samples::{Irregular, rigid_residual};
    use super::*;

    fn set(digits: &str) -> Components {
        Components::parse(digits.as_bytes()).expect("components")
    }

    fn side(parts: &[(u32, &str)]) -> Side {
        parts.iter().map(|&(node, digits)| (node, set(digits))).collect()
    }

    #[test]
    fn rigid_motions_leave_no_residual() {
        for independent in [
            side(&[(1, "123456")]),
            side(&[(1, "234"), (2, "123")]),
            side(&[(1, "123"), (2, "23"), (3, "3")]),
            side(&[(1, "12"), (2, "12"), (3, "56")]),
        ] {
            let element = Rigid { independent, dependent: side(&[(4, "123456"), (5, "246"), (6, "1")]) };
            let rows = element.rows(&Irregular).expect("rows");
            assert_eq!(rows.len(), 10);
            assert!(rigid_residual(&rows, &Irregular) < 1e-12, "{}", rigid_residual(&rows, &Irregular));
            assert_eq!(rows[7].terms[0], (Dof { node: 5, component: 4 }, 1.0));
        }
    }

    #[test]
    fn an_arm_along_an_axis_couples_few_components() {
        let element = Rigid { independent: side(&[(1, "123456")]), dependent: side(&[(2, "123456")]) };
        let rows = element.rows(&Straight).expect("rows");
        let couples = |row: usize| rows[row].terms[1..].iter().map(|(at, a)| (at.component, *a)).collect::<Vec<_>>();
        assert_eq!(couples(0), [(1, -1.0)]);
        assert_eq!(couples(1), [(2, -1.0), (6, -2.0)]);
        assert_eq!(couples(2), [(3, -1.0), (5, 2.0)]);
        assert_eq!(couples(5), [(6, -1.0)]);
    }

    #[test]
    fn wrong_splits_are_refused() {
        let refused = |independent: &[(u32, &str)], dependent: &[(u32, &str)]| {
            Rigid { independent: side(independent), dependent: side(dependent) }.rows(&Straight).expect_err("refused")
        };
        assert_eq!(refused(&[(1, "12345")], &[(2, "1")]), CardFault::IndependentCount { found: 5 }.into());
        assert_eq!(refused(&[(1, "123"), (2, "123")], &[(2, "4")]), CardFault::IndependentSingular.into());
        assert_eq!(refused(&[(1, "123456")], &[(1, "3")]), CardFault::OnBothSides { node: 1, component: 3 }.into());
        assert_eq!(refused(&[(1, "123456")], &[]), CardFault::NothingConnected.into());
    }

    /// Node k at x = 2 (k - 1), with global axes.
    struct Straight;

    impl Poses for Straight {
        fn pose(&self, node: u32) -> Result<Pose, Problem> {
            Ok(Pose { position: [f64::from(node - 1) * 2.0, 0.0, 0.0], axes: super::super::axes::BASIC_AXES })
        }
    }
}

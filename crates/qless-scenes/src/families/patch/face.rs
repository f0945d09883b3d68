//! Shape functions of a face, and the parameters `(xi, eta)` of a point.
//!
//! Quadrilaterals are bilinear on `0 <= xi, eta <= 1`, triangles linear on the half with `xi + eta <= 1`.

/// A face: the nodes at its corners, in order around it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in super::super) enum PatchFace {
    Triangle([usize; 3]),
    Quad([usize; 4]),
}

/// Value and derivatives of a shape function.
type Function = [f64; 3];

/// Limit for the steps of Newton's method, which takes one on a triangle and about five on a quadrilateral.
const STEPS: usize = 30;
/// Newton's method ends after a step smaller than this, on a face of size one.
const STILL: f64 = 1e-13;

impl PatchFace {
    pub(in super::super) fn nodes(&self) -> &[usize] {
        match self {
            Self::Triangle(nodes) => nodes,
            Self::Quad(nodes) => nodes,
        }
    }

    /// The same face with renumbered nodes.
    pub(in super::super) fn renumbered(&self, number: impl Fn(usize) -> usize) -> Self {
        match self {
            Self::Triangle(nodes) => Self::Triangle(nodes.map(number)),
            Self::Quad(nodes) => Self::Quad(nodes.map(number)),
        }
    }

    /// `[N_k, dN_k / dxi, dN_k / deta]` for each corner k. A triangle has three corners, and its fourth function is zero.
    pub(in super::super) fn functions(&self, [xi, eta]: [f64; 2]) -> [Function; 4] {
        match self {
            Self::Triangle(_) => [[1.0 - xi - eta, -1.0, -1.0], [xi, 1.0, 0.0], [eta, 0.0, 1.0], [0.0; 3]],
            Self::Quad(_) => {
                let (p, q) = (1.0 - xi, 1.0 - eta);
                [[p * q, -q, -p], [xi * q, q, -xi], [xi * eta, eta, xi], [p * eta, -eta, p]]
            }
        }
    }

    /// `(xi, eta)` of a point by Newton's method; `None` if it does not converge, which can happen far outside the face.
    pub(super) fn parameters(&self, corners: &[[f64; 2]; 4], point: [f64; 2]) -> Option<[f64; 2]> {
        // Differences from the point keep all digits for faces far from the origin.
        let arms = corners.map(|corner| [corner[0] - point[0], corner[1] - point[1]]);
        let mut at = [1.0 / 3.0; 2];
        for _ in 0..STEPS {
            let functions = self.functions(at);
            let sum = |what: usize, axis: usize| {
                functions.iter().zip(&arms).map(|(function, arm)| function[what] * arm[axis]).sum::<f64>()
            };
            let step = solve([0, 1].map(|axis| [sum(1, axis), sum(2, axis)]), [0, 1].map(|axis| -sum(0, axis)));
            at = [at[0] + step[0], at[1] + step[1]];
            if step.iter().all(|step| step.abs() < STILL) {
                return Some(at);
            }
        }
        None
    }

    /// Distance of the parameters from the border of the face; negative outside.
    pub(super) fn depth(&self, [xi, eta]: [f64; 2]) -> f64 {
        match self {
            Self::Triangle(_) => xi.min(eta).min(1.0 - xi - eta),
            Self::Quad(_) => xi.min(1.0 - xi).min(eta).min(1.0 - eta),
        }
    }
}

/// Solves two equations with the rows `(a, b)` and `(c, d)` by Cramer's rule.
fn solve([[a, b], [c, d]]: [[f64; 2]; 2], [p, q]: [f64; 2]) -> [f64; 2] {
    let determinant = a * d - b * c;
    [(p * d - b * q) / determinant, (a * q - p * c) / determinant]
}

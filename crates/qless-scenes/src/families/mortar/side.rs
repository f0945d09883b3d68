//! The mesh of one side of an interface along one axis: elements with the ends `0 = x_0 < x_1 < ... < x_n = 1`.

use crate::error::within;
use crate::{Rng, SceneError};

/// Degree of the Lagrange functions of an element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Degree {
    /// Two nodes per element, with the functions `1 - t`, `t`.
    Linear = 1,
    /// Three nodes per element, one in the middle, with the functions `(1 - t)(1 - 2 t)`, `4 t (1 - t)`, `t (2 t - 1)`.
    Quadratic = 2,
}

/// A mesh of the interval `[0, 1]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Side {
    pub(super) ends: Vec<f64>,
    pub(super) degree: Degree,
}

/// Least length of an element. Shorter elements would lose digits in the integrals.
const SHORTEST: f64 = 1.0 / (1 << 30) as f64;

impl Side {
    /// Elements between neighbouring `ends`; the first end is 0 and the last is 1.
    ///
    /// # Errors
    /// [`SceneError::Size`] for fewer than two ends; [`SceneError::Mesh`] unless they ascend from 0 to 1 by at least 2^-30.
    pub fn new(ends: Vec<f64>, degree: Degree) -> Result<Self, SceneError> {
        within("ends of elements", ends.len(), 2, 1 << 27)?;
        let last = ends.len() - 1;
        let right = |&node: &usize| match node {
            0 => ends[0] == 0.0,
            _ => ends[node] - ends[node - 1] >= SHORTEST && (node < last || ends[last] == 1.0),
        };
        match (0..=last).find(|node| !right(node)) {
            Some(node) => Err(SceneError::Mesh { node, found: ends[node] }),
            None => Ok(Self { ends, degree }),
        }
    }

    /// Elements of equal length, with ends at `k / elements`.
    ///
    /// # Errors
    /// [`SceneError::Size`] without elements.
    pub fn uniform(elements: usize, degree: Degree) -> Result<Self, SceneError> {
        Self::new(spaced(elements)?, degree)
    }

    /// [`Side::uniform`] with every inner end moved by up to 0.3 of an element's length.
    ///
    /// # Errors
    /// As [`Side::uniform`].
    pub fn jittered(elements: usize, degree: Degree, seed: u64) -> Result<Self, SceneError> {
        let (mut rng, mut ends) = (Rng::new(seed), spaced(elements)?);
        for end in ends.iter_mut().take(elements).skip(1) {
            *end += 0.3 * rng.real() / elements as f64;
        }
        Self::new(ends, degree)
    }

    /// [`Side::uniform`] with one more end, a tenth of an element behind the middle end: one element is ten times shorter.
    ///
    /// # Errors
    /// As [`Side::uniform`].
    pub fn with_short_element(elements: usize, degree: Degree) -> Result<Self, SceneError> {
        let (mut ends, middle) = (spaced(elements)?, elements / 2);
        ends.insert(middle + 1, (middle as f64 + 0.1) / elements as f64);
        Self::new(ends, degree)
    }

    /// Number of elements.
    pub fn elements(&self) -> usize {
        self.ends.len() - 1
    }

    /// Number of nodes.
    pub(super) fn count(&self) -> usize {
        self.elements() * (self.degree as usize) + 1
    }

    /// Positions of the nodes, ascending, including the middle nodes of quadratic elements.
    pub fn nodes(&self) -> Vec<f64> {
        let middle = |pair: &[f64]| f64::midpoint(pair[0], pair[1]);
        match self.degree {
            Degree::Linear => self.ends.clone(),
            Degree::Quadratic => self.ends.windows(2).flat_map(|pair| [pair[0], middle(pair)]).chain([1.0]).collect(),
        }
    }

    /// Node and value of each function of an element at the local coordinate `t` from 0 to 1.
    pub(super) fn functions(&self, element: usize, t: f64) -> impl Iterator<Item = (usize, f64)> {
        let values = match self.degree {
            Degree::Linear => [1.0 - t, t, 0.0],
            Degree::Quadratic => [(1.0 - t) * (1.0 - 2.0 * t), 4.0 * t * (1.0 - t), t * (2.0 * t - 1.0)],
        };
        let degree = self.degree as usize;
        values.into_iter().take(degree + 1).enumerate().map(move |(k, value)| (degree * element + k, value))
    }
}

fn spaced(elements: usize) -> Result<Vec<f64>, SceneError> {
    within("elements", elements, 1, 1 << 27)?;
    Ok((0..=elements).map(|k| k as f64 / elements as f64).collect())
}

//! Surfaces `x(s, t)` for `(s, t)` in `[0, 1]^2`. They use only the four basic operations, so the bits are the same on every machine.

use crate::families::AXES;

/// A surface about two metres wide, inclined to x, y and z.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Surface {
    /// `(p, q, 0)` with `p = 2 s - 1`, `q = 2 t - 1`.
    Plane,
    /// A cylinder over 106 degrees, `(2 a / (1 + a^2), q, (1 - a^2) / (1 + a^2))` with `a = p / 2`, `p = 2 s - 1`, `q = 2 t - 1`.
    Cylinder,
    /// Part of a sphere, by stereographic projection: `(p, q, 1 - r^2) / (1 + r^2)` with `r^2 = (p^2 + q^2) / 4`, `p = 2 s - 1`,
    /// `q = 2 t - 1`.
    Sphere,
    /// Hills and valleys `0.1 T_3(p) T_3(q)`, with `T_3(p) = 4 p^3 - 3 p`, `p = 2 s - 1`, `q = 2 t - 1`.
    Waves,
}

impl Surface {
    /// The point at `(s, t)`.
    pub(super) fn at(self, place: [f64; 2]) -> [f64; 3] {
        let [p, q] = place.map(|along| 2.0 * along - 1.0);
        let local = match self {
            Self::Plane => [p, q, 0.0],
            Self::Cylinder => {
                let square = p * p / 4.0;
                [p / (1.0 + square), q, (1.0 - square) / (1.0 + square)]
            }
            Self::Sphere => {
                let square = (p * p + q * q) / 4.0;
                [p, q, 1.0 - square].map(|x| x / (1.0 + square))
            }
            Self::Waves => [p, q, 0.1 * wave(p) * wave(q)],
        };
        AXES.map(|axis| axis.map(|c| c / 3.0)).map(|axis| axis[0] * local[0] + axis[1] * local[1] + axis[2] * local[2])
    }
}

fn wave(p: f64) -> f64 {
    p * (4.0 * p * p - 3.0)
}

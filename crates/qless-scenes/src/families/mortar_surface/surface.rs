//! `x(s, t)` for `(s, t)` in `[0, 1]^2`, without any function but the four operations: the same bits on every machine.

/// A patch in space, some two metres wide, askew to all axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Surface {
    /// `(p, q, 0)` with `p = 2 s - 1`, `q = 2 t - 1`.
    Plane,
    /// 106 degrees of a cylinder, `(p, q, (1 - a^2) / (1 + a^2))` with `a = p / 2` and `2 a / (1 + a^2)` for p.
    Cylinder,
    /// Part of a sphere, by stereographic projection: `(p, q, 1 - r^2) / (1 + r^2)` with `r^2 = (p^2 + q^2) / 4`.
    Sphere,
    /// Hills and valleys `0.1 T_3(p) T_3(q)`, `T_3(p) = 4 p^3 - 3 p`.
    Waves,
}

/// Orthonormal: no axis of a patch is an axis of space.
const ASKEW: [[f64; 3]; 3] =
    [[2.0 / 3.0, -1.0 / 3.0, 2.0 / 3.0], [2.0 / 3.0, 2.0 / 3.0, -1.0 / 3.0], [-1.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0]];

impl Surface {
    /// The point of the surface.
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
        ASKEW.map(|axis| axis[0] * local[0] + axis[1] * local[1] + axis[2] * local[2])
    }
}

fn wave(p: f64) -> f64 {
    p * (4.0 * p * p - 3.0)
}

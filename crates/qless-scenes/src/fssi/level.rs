//! The seven mesh levels of Table 1 and the meshes that meet its counts.

use super::Mesh;

/// A mesh refinement level of the paper's Table 1, in percent of its reference mesh.
///
/// | level | equations | redundant | DOFs that occur (ties) | columns, layers | far | rings x sectors | wall |
/// | --- | --- | --- | --- | --- | --- | --- | --- |
/// | 50 % | 7,580 | 168 | 11,288 | 35, 14 | 23, 9 | 23 x 20 | 16 |
/// | 60 % | 10,300 | 192 | 15,592 | 43, 16 | 26, 10 | 18 x 28 | 19 |
/// | 70 % | 13,808 | 216 | 21,204 | 49, 18 | 30, 11 | 15 x 52 | 17 |
/// | 80 % | 17,408 | 240 | 26,480 | 51, 20 | 30, 12 | 18 x 68 | 22 |
/// | 90 % | 22,360 | 276 | 33,832 | 63, 23 | 37, 14 | 28 x 44 | 29 |
/// | 100 % | 26,888 | 288 | 41,372 | 71, 24 | 41, 15 | 28 x 56 | 31 |
/// | 110 % | 31,832 | 300 | 48,528 | 79, 25 | 44, 15 | 27 x 76 | 26 |
///
/// The layers follow from the redundant equations (12 each); the rest was searched for among the meshes
/// whose total is exact, for about three quarters of the equations on the sides and 1.5 DOFs per equation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Level {
    /// 50 %, the coarsest.
    P50,
    /// 60 %.
    P60,
    /// 70 %.
    P70,
    /// 80 %.
    P80,
    /// 90 %.
    P90,
    /// 100 %, the reference mesh.
    P100,
    /// 110 %, the finest.
    P110,
}

impl Level {
    /// All levels, coarse to fine.
    pub const ALL: [Self; 7] = [Self::P50, Self::P60, Self::P70, Self::P80, Self::P90, Self::P100, Self::P110];

    /// 50 to 110.
    pub fn percent(self) -> usize {
        50 + 10 * self as usize
    }

    /// Table 1's "No. of given constraints".
    pub fn equations(self) -> usize {
        [7580, 10_300, 13_808, 17_408, 22_360, 26_888, 31_832][self as usize]
    }

    /// Table 1's "No. of consistent over-constraints".
    pub fn redundant(self) -> usize {
        [168, 192, 216, 240, 276, 288, 300][self as usize]
    }

    /// The mesh with this level's counts.
    ///
    /// ```
    /// use qless_scenes::fssi::Level;
    /// for level in Level::ALL {
    ///     assert_eq!(level.mesh().equations(), level.equations());
    ///     assert_eq!(level.mesh().redundant(), level.redundant());
    /// }
    /// ```
    pub fn mesh(self) -> Mesh {
        let [columns, layers, far_columns, far_layers, rings, sectors, wall] = [
            [35, 14, 23, 9, 23, 20, 16],
            [43, 16, 26, 10, 18, 28, 19],
            [49, 18, 30, 11, 15, 52, 17],
            [51, 20, 30, 12, 18, 68, 22],
            [63, 23, 37, 14, 28, 44, 29],
            [71, 24, 41, 15, 28, 56, 31],
            [79, 25, 44, 15, 27, 76, 26],
        ][self as usize];
        Mesh { columns, layers, far_columns, far_layers, rings, sectors, wall }
    }
}

//! The meshes of the model: `m = 12 columns layers + 3 rings sectors + wall sectors` equations, `12 layers` of them redundant.

use crate::SceneError;
use crate::error::within;

/// Numbers of nodes of the model's meshes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mesh {
    /// Near-field nodes along each horizontal side of the box, corners included.
    pub columns: usize,
    /// Near-field nodes from the surface to the bottom.
    pub layers: usize,
    /// Far-field nodes along each horizontal side.
    pub far_columns: usize,
    /// Far-field nodes from the surface to the bottom.
    pub far_layers: usize,
    /// Rings of nodes of the tank's ring foundation.
    pub rings: usize,
    /// Nodes per ring, a multiple of 4.
    pub sectors: usize,
    /// Rings of nodes on the wetted wall; the lowest is the foundation's outermost.
    pub wall: usize,
}

impl Mesh {
    /// m, the number of equations.
    pub fn equations(&self) -> usize {
        let ties = 12_usize.saturating_mul(self.columns).saturating_mul(self.layers);
        let around = self.rings.saturating_mul(3).saturating_add(self.wall).saturating_mul(self.sectors);
        ties.saturating_add(around)
    }

    /// Number of redundant equations, from the edges that are tied twice: 4 edges x layers x 3.
    pub fn redundant(&self) -> usize {
        self.layers.saturating_mul(12)
    }

    /// Number of redundant mortar rows: 12 x layers on a nested mesh, otherwise 12 x (layers - far layers), at least 0.
    pub fn redundant_mortar(&self) -> usize {
        let layers = if self.is_nested() { self.layers } else { self.layers.saturating_sub(self.far_layers) };
        layers.saturating_mul(12)
    }

    /// The 110 % mesh refined or coarsened to about `equations` equations, from some 300 to tens of millions.
    ///
    /// ```
    /// use qless_scenes::fssi::Mesh;
    /// let four_times = Mesh::with_equations(4 * 31_832);
    /// assert_eq!((four_times.equations(), four_times.redundant()), (126_728, 600));
    /// ```
    #[must_use]
    pub fn with_equations(equations: usize) -> Self {
        let base = Level::P110.mesh();
        let factor = (equations as f64 / base.equations() as f64).sqrt();
        let stretch = |count: usize, least: usize| ((count as f64 * factor).round() as usize).max(least);
        let columns = stretch(base.columns - 1, 6) + 1;
        Self {
            columns,
            layers: stretch(base.layers, 3),
            far_columns: without_nesting(columns, stretch(base.far_columns - 1, 2) + 1),
            far_layers: stretch(base.far_layers, 2),
            rings: stretch(base.rings, 2),
            sectors: 4 * stretch(base.sectors / 4, 2),
            wall: stretch(base.wall, 1),
        }
    }

    /// The same mesh with `far_columns` such that every second near-field column coincides with a far-field column.
    ///
    /// An even number of `columns` is increased by one.
    #[must_use]
    pub fn nested(self) -> Self {
        let far_columns = self.columns / 2 + 1;
        Self { columns: far_columns.saturating_mul(2) - 1, far_columns, ..self }
    }

    /// The same near field, with a far field that is about three times coarser horizontally and a fifth finer over the depth.
    #[must_use]
    pub fn deep(self) -> Self {
        let far_columns = without_nesting(self.columns, self.columns / 16 * 5 + self.columns % 16 * 5 / 16 + 1);
        Self { far_columns, far_layers: self.layers.saturating_add(self.layers / 5 + 1), ..self }
    }

    /// Whether every far-field column coincides with a near-field one, so that far-field functions are combinations of near-field ones.
    pub fn is_nested(&self) -> bool {
        self.far_columns > 1 && self.columns > 0 && (self.columns - 1).is_multiple_of(self.far_columns - 1)
    }

    /// Checks that the model can be built: the tank stands on inner cells of the soil's surface, and each mesh has cells.
    ///
    /// # Errors
    /// [`SceneError::Size`] or [`SceneError::NotMultiple`] for the first invalid number.
    pub fn check(&self) -> Result<(), SceneError> {
        let most = 1 << 14;
        within("columns", self.columns, 7, most)?;
        within("layers", self.layers, 2, most)?;
        within("far_columns", self.far_columns, 2, most)?;
        within("far_layers", self.far_layers, 2, most)?;
        within("rings", self.rings, 2, most)?;
        within("sectors", self.sectors, 4, most)?;
        within("wall", self.wall, 1, most)?;
        let sectors = SceneError::NotMultiple { what: "sectors", found: self.sectors, of: 4 };
        if self.sectors.is_multiple_of(4) { Ok(()) } else { Err(sectors) }
    }
}

/// The least number of far-field columns, from `far` up, for which the mesh is not nested.
fn without_nesting(columns: usize, far: usize) -> usize {
    (far.max(3)..=columns.saturating_add(1)).find(|far| !(columns - 1).is_multiple_of(far - 1)).unwrap_or(far)
}

/// A level of mesh refinement in the paper's Table 1, in percent of the reference mesh.
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
/// The layers follow from the redundant equations (12 for each layer). The other numbers were chosen among the meshes with the exact
/// total, for about three quarters of the equations on the sides and 1.5 DOFs per equation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Level {
    /// 50 % of the reference mesh, the coarsest level.
    P50,
    /// 60 % of the reference mesh.
    P60,
    /// 70 % of the reference mesh.
    P70,
    /// 80 % of the reference mesh.
    P80,
    /// 90 % of the reference mesh.
    P90,
    /// 100 %, the reference mesh.
    P100,
    /// 110 % of the reference mesh, the finest level.
    P110,
}

impl Level {
    /// All levels, coarse to fine.
    pub const ALL: [Self; 7] = [Self::P50, Self::P60, Self::P70, Self::P80, Self::P90, Self::P100, Self::P110];

    /// The level in percent, 50 to 110.
    pub fn percent(self) -> usize {
        50 + 10 * self as usize
    }

    /// Number of equations of the level, "No. of given constraints" in the paper's Table 1.
    pub fn equations(self) -> usize {
        [7580, 10_300, 13_808, 17_408, 22_360, 26_888, 31_832][self as usize]
    }

    /// Number of redundant equations of the level, "No. of consistent over-constraints" in the paper's Table 1.
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

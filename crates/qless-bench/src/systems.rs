//! Systems with a known rank, by family and in ascending size.

use qless_scenes::families::{MortarSurface, Near, Surface, Windows, cycle, grid_2d, ladder, near, path, planted, rve};
use qless_scenes::fssi::{Level, Mesh, mortar, tie};
use qless_scenes::{Scene, SceneError};

use super::linkages::{bricard, four_bar};

/// Systems of one kind.
pub struct Family {
    pub name: &'static str,
    pub cases: Vec<BenchCase>,
}

/// One system, generated on demand.
pub struct BenchCase {
    pub family: &'static str,
    pub size: String,
    make: Box<dyn Fn() -> BuiltSystem>,
}

type BuiltSystem = Result<Scene, Box<dyn std::error::Error>>;

impl BenchCase {
    /// Generates the system; an error is returned as text.
    pub fn scene(&self) -> Result<Scene, String> {
        (self.make)().map_err(|error| format!("{} {}: {error}", self.family, self.size))
    }
}

/// The family of the paper's Table 1.
pub const TIE: &str = "tie";
/// Both couplings of the model of Table 1, on all its levels.
pub const TABLE_1: [&str; 2] = [TIE, "mortar"];

/// All families, or only those with the names in `only`. With `short`, each has only its smallest systems, and mortar, which takes long to
/// generate, is left out unless it is named.
pub fn families(short: bool, only: &[String]) -> Vec<Family> {
    let mut families: Vec<Family> = table_1().into_iter().chain(sized()).chain(extremes()).collect();
    families.retain(|family| only.is_empty() || only.iter().any(|name| name == family.name));
    if short {
        families.retain(|family| family.name != TABLE_1[1] || !only.is_empty());
        families.iter_mut().for_each(|family| family.cases.truncate(if family.name == TIE { 2 } else { 1 }));
    }
    families
}

fn table_1() -> [Family; 2] {
    TABLE_1.map(|name| {
        let case = |level: Level| coupled(name, format!("{} %", level.percent()), level.mesh());
        Family { name, cases: Level::ALL.map(case).into() }
    })
}

/// The coupled model of Table 1 on meshes that are coarser than the paper's.
pub fn below_table_1(family: &'static str) -> Vec<BenchCase> {
    let case = |equations: usize| {
        let mesh = Mesh::with_equations(equations);
        coupled(family, format!("{} equations", mesh.equations()), mesh)
    };
    [300, 600, 1_200, 2_500, 5_000].map(case).into()
}

fn coupled(family: &'static str, size: String, mesh: Mesh) -> BenchCase {
    let scene: fn(&Mesh, u64) -> Result<Scene, SceneError> = if family == TIE { tie } else { mortar };
    BenchCase { family, size, make: Box::new(move || Ok(scene(&mesh, 1)?)) }
}

fn sized() -> [Family; 10] {
    [
        family("chain", &[1_000, 100_000], |n| Ok(path(n)?)),
        family("ring", &[1_000, 100_000], |n| Ok(cycle(n, 0.0)?)),
        family("grid", &[20, 60], |n| Ok(grid_2d(n, n)?)),
        family("periodic cube", &[4, 8, 16], |n| Ok(rve(n)?)),
        family("windows, many combinations", &[20, 60], |n| {
            Ok(Windows { extent: [n, n, 1], d: 1, window: 4, stride: 2, rows: 2, combos: n * n / 10 }.scene(1)?)
        }),
        family("curved mortar", &[500, 2_000], |n| Ok(MortarSurface::with_equations(Surface::Sphere, n).scene(1)?)),
        family("mortar on waves", &[500, 2_000], |n| Ok(MortarSurface::with_equations(Surface::Waves, n).scene(1)?)),
        family("planted", &[200, 1_000], |n| Ok(planted(n, n + n / 2, n / 10, 1, false)?)),
        family("four-bar linkages", &[1, 100], four_bar),
        family("Bricard linkages", &[1, 100], bricard),
    ]
}

/// Rows and units scaled by powers of two, coefficients that grow along a chain, and nearly dependent rows.
fn extremes() -> [Family; 6] {
    let planted = |n: usize| planted(n, n + n / 2, n / 10, 2, false);
    [
        family("rows scaled 2^40", &[200], move |n| Ok(planted(n)?.scale_rows(40, 3)?.0)),
        family("units 2^20", &[200], move |n| Ok(planted(n)?.scale_dofs(&units(n + n / 2))?)),
        family("range 2^n", &[30, 300], |n| Ok(ladder(n)?)),
        family("near 1e-3", &[30], |n| Ok(near(n / 3, 1e-3, Near::Shared)?)),
        family("near 1e-5", &[30], |n| Ok(near(n / 3, 1e-5, Near::Shared)?)),
        family("near 1e-7", &[30], |n| Ok(near(n / 3, 1e-7, Near::Shared)?)),
    ]
}

/// Units from `2^-10` to `2^10`, not sorted.
fn units(count: usize) -> Vec<f64> {
    (0..count).map(|j| f64::powi(2.0, (j * 8 % 21) as i32 - 10)).collect()
}

fn family(name: &'static str, sizes: &[usize], scene: impl Fn(usize) -> BuiltSystem + Copy + 'static) -> Family {
    let case = |&n: &usize| BenchCase { family: name, size: n.to_string(), make: Box::new(move || scene(n)) };
    Family { name, cases: sizes.iter().map(case).collect() }
}

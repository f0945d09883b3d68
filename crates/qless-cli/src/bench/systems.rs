//! Systems with a known rank, by family and in ascending size.

use qless_scenes::families::{Near, cycle, grid_2d, near, path, planted, rve};
use qless_scenes::fssi::{Level, mortar, tie};
use qless_scenes::{Scene, SceneError};

/// Systems of one kind.
pub struct Family {
    pub name: &'static str,
    pub scenes: Vec<(String, Result<Scene, SceneError>)>,
}

/// The family of the paper's Table 1.
pub const TIE: &str = "tie";

/// All families, or the smallest of each.
pub fn families(short: bool) -> Vec<Family> {
    let levels: &[Level] = if short { &Level::ALL[..2] } else { &Level::ALL };
    let named = |level: &Level| format!("{} %", level.percent());
    let ties = levels.iter().map(|level| (named(level), tie(&level.mesh(), 1))).collect();
    let mut families = vec![Family { name: TIE, scenes: ties }];
    if !short {
        families.push(family("mortar", vec![("50 %".into(), mortar(&Level::P50.mesh(), 1))]));
    }
    let sizes = |all: &[usize]| if short { all[..1].to_vec() } else { all.to_vec() };
    let each = |all: &[usize], scene: &dyn Fn(usize) -> Result<Scene, SceneError>| {
        sizes(all).into_iter().map(|n| (n.to_string(), scene(n))).collect::<Vec<_>>()
    };
    families.extend([
        family("chain", each(&[1_000, 100_000], &|n| path(n))),
        family("ring", each(&[1_000, 100_000], &|n| cycle(n, 0.0))),
        family("grid", each(&[20, 60], &|n| grid_2d(n, n))),
        family("periodic cube", each(&[4, 8, 16], &rve)),
        family("planted", each(&[200, 1_000], &|n| planted(n, n + n / 2, n / 10, 1, false))),
    ]);
    for (name, eps) in [("near 1e-3", 1e-3), ("near 1e-5", 1e-5), ("near 1e-7", 1e-7)] {
        families.push(family(name, vec![("30".into(), near(10, eps, Near::Shared))]));
    }
    families
}

fn family(name: &'static str, scenes: Vec<(String, Result<Scene, SceneError>)>) -> Family {
    Family { name, scenes }
}

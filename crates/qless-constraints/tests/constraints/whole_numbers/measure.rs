//! The share of u by which it is off, as [`qless_constraints::enforce::Solution::accuracy`] defines it, made once more from its words.

use super::models::Model;

/// The connected part of each DOF, none for prescribed ones, and its unit of energy.
pub struct Measure<'a> {
    model: &'a Model,
    part: Vec<Option<usize>>,
    unit: Vec<f64>,
}

impl<'a> Measure<'a> {
    pub fn new(model: &'a Model, kept: &[usize]) -> Self {
        let free = model.free();
        let (part, unit) = (parts(model, &free, kept), units(model, &free, kept));
        Self { model, part, unit }
    }

    /// The largest of all parts; a part at rest is measured by what its loads do to its stiffness.
    pub fn off(&self, found: &[f64], right: &[f64], length: f64) -> f64 {
        let free = self.model.free();
        let of_part = |name: usize| {
            let own = || free.iter().copied().filter(|&j| self.part[j] == Some(name));
            let largest = |value: &dyn Fn(usize) -> f64| own().map(value).fold(0.0, f64::max);
            let off = largest(&|j| (found[j] / length - right[j]).abs() / self.unit[j]);
            let moved = largest(&|j| right[j].abs() / self.unit[j]);
            let is_stiff = own().any(|i| own().any(|j| self.model.k[i][j] != 0));
            let load =
                |j: usize| self.model.less_prescribed(&self.model.k[j], self.model.f[j]).abs() as f64 * self.unit[j];
            let size = if is_stiff { moved.max(largest(&load)) } else { moved };
            if off > 0.0 { off / size } else { 0.0 }
        };
        free.iter().map(|&j| of_part(self.part[j].unwrap_or(j))).fold(0.0, f64::max)
    }
}

fn parts(model: &Model, free: &[usize], kept: &[usize]) -> Vec<Option<usize>> {
    let mut part: Vec<Option<usize>> = (0..model.f.len()).map(|j| free.contains(&j).then_some(j)).collect();
    let joined = |i: usize, j: usize| {
        model.k[i][j] != 0 || model.k[j][i] != 0 || kept.iter().any(|&r| model.c[r][i] != 0 && model.c[r][j] != 0)
    };
    for _ in free {
        for (&i, &j) in free.iter().flat_map(|i| free.iter().map(move |j| (i, j))) {
            if joined(i, j) {
                let name = part[i].min(part[j]);
                (part[i], part[j]) = (name, name);
            }
        }
    }
    part
}

/// `1 / sqrt |K_jj|`, balanced; where there is none, from equations.
fn units(model: &Model, free: &[usize], kept: &[usize]) -> Vec<f64> {
    let size = |i: usize, j: usize| model.k[i][j].abs().max(model.k[j][i].abs()) as f64;
    let largest = |row: &dyn Fn(usize) -> f64| free.iter().map(|&j| row(j)).fold(0.0, f64::max);
    let mut unit = vec![0.0_f64; model.f.len()];
    for &j in free {
        let most = if model.k[j][j] == 0 { largest(&|i| size(i, j)) } else { size(j, j) };
        unit[j] = if most > 0.0 { most.sqrt().recip() } else { 0.0 };
    }
    for _ in 0..3 {
        let most: Vec<f64> = free.iter().map(|&j| largest(&|i| unit[i] * size(i, j) * unit[j])).collect();
        free.iter().zip(most).filter(|(_, most)| *most > 0.0).for_each(|(&j, most)| unit[j] /= most.sqrt());
    }
    let mut of_rows = vec![0.0_f64; model.c.len()];
    for _ in free {
        let set = |own: &mut f64, most: f64| {
            if *own == 0.0 && most > 0.0 {
                *own = most.recip();
            }
        };
        kept.iter().for_each(|&r| set(&mut of_rows[r], largest(&|j| model.c[r][j].abs() as f64 * unit[j])));
        let of_dof = |j: usize| kept.iter().map(|&r| model.c[r][j].abs() as f64 * of_rows[r]).fold(0.0, f64::max);
        free.iter().for_each(|&j| set(&mut unit[j], of_dof(j)));
    }
    unit.into_iter().map(|unit| if unit > 0.0 { unit } else { 1.0 }).collect()
}

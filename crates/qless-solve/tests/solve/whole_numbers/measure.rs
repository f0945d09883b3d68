//! The relative error of u as [`qless_solve::enforce::Solution::accuracy`] defines it, implemented independently.

use super::models::Model;

/// Part, unit of energy and unit group of each DOF; numbers of two groups cannot be compared.
pub struct Measure<'a> {
    model: &'a Model,
    kept: &'a [usize],
    part: Vec<Option<usize>>,
    unit: Vec<f64>,
    kind: Vec<usize>,
}

impl<'a> Measure<'a> {
    pub fn new(model: &'a Model, kept: &'a [usize]) -> Self {
        let free = model.free();
        let (part, unit) = (parts(model, &free, kept), units(model, &free, kept));
        Self { model, kept, part, unit, kind: kinds(model, &free, kept) }
    }

    /// Size of a zero DOF without a known unit, by the terms of its equations.
    fn of_terms(&self, j: usize, right: &[f64]) -> f64 {
        let terms = |r: usize| {
            let of_dofs = self.model.c[r].iter().zip(right).map(|(&c, u)| (c as f64 * u).abs());
            of_dofs.sum::<f64>() + self.model.b[r].abs() as f64
        };
        let rows = self.kept.iter().filter(|&&r| self.model.c[r][j] != 0);
        rows.map(|&r| terms(r) / self.model.c[r][j].abs() as f64 / self.unit[j]).fold(0.0, f64::max)
    }

    /// The largest error over all parts and groups. If u of a group is zero, the effect of its loads on their own stiffness counts.
    pub fn off(&self, found: &[f64], right: &[f64], length: f64) -> f64 {
        let free = self.model.free();
        let of_kind = |name: usize, kind: usize| {
            let of_part = || free.iter().copied().filter(|&j| self.part[j] == Some(name));
            let own = || of_part().filter(|&j| self.kind[j] == kind);
            let largest = |value: &dyn Fn(usize) -> f64| own().map(value).fold(0.0, f64::max);
            let off = largest(&|j| (found[j] / length - right[j]).abs() / self.unit[j]);
            let moved = largest(&|j| right[j].abs() / self.unit[j]);
            let is_stiff = of_part().any(|i| of_part().any(|j| self.model.k[i][j] != 0));
            let load =
                |j: usize| self.model.less_prescribed(&self.model.k[j], self.model.f[j]).abs() as f64 * self.unit[j];
            let loads = of_part().filter(|&j| kind == 0 && self.kind[j] == 0).map(load).fold(0.0, f64::max);
            let of_terms = if kind != 0 && moved == 0.0 { self.of_terms(kind - 1, right) } else { 0.0 };
            let size = if is_stiff { moved.max(loads) } else { moved }.max(of_terms);
            if off > 0.0 { off / size } else { 0.0 }
        };
        // If the loads of such a group are zero as well, only rounding of other groups is left.
        let all = free.iter().map(|&j| of_kind(self.part[j].unwrap_or(j), self.kind[j]));
        all.filter(|off| off.is_finite()).fold(0.0, f64::max)
    }
}

/// 0 for DOFs whose unit is known from a diagonal entry of their part of K, or from an equation if they have no stiffness. Others are groups
/// of their own.
fn kinds(model: &Model, free: &[usize], kept: &[usize]) -> Vec<usize> {
    let joined = |i: usize, j: usize| model.k[i][j] != 0 || model.k[j][i] != 0;
    let is_stiff = free.iter().any(|&i| free.iter().any(|&j| joined(i, j)));
    let mut known: Vec<bool> = (0..model.f.len()).map(|j| !is_stiff || model.k[j][j] != 0).collect();
    for _ in free {
        for &j in free {
            let by_k = free.iter().any(|&i| known[i] && joined(i, j));
            let unknown_to_k = !free.iter().any(|&i| joined(i, j));
            let of_row = |&&r: &&usize| model.c[r][j] != 0 && free.iter().any(|&i| known[i] && model.c[r][i] != 0);
            known[j] |= by_k || (unknown_to_k && kept.iter().any(|r| of_row(&r)));
        }
    }
    (0..model.f.len()).map(|j| if known[j] { 0 } else { j + 1 }).collect()
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

/// `1 / sqrt |K_jj|`, balanced; from equations if K has no entry.
fn units(model: &Model, free: &[usize], kept: &[usize]) -> Vec<f64> {
    let size = |i: usize, j: usize| model.k[i][j].abs().max(model.k[j][i].abs()) as f64;
    let largest = |row: &dyn Fn(usize) -> f64| free.iter().map(|&j| row(j)).fold(0.0, f64::max);
    let mut unit = vec![0.0_f64; model.f.len()];
    free.iter().filter(|&&j| model.k[j][j] != 0).for_each(|&j| unit[j] = size(j, j).sqrt().recip());
    for _ in free {
        let most: Vec<f64> = free.iter().map(|&j| largest(&|i| unit[i] * size(i, j))).collect();
        let new = free.iter().zip(most).filter(|(j, most)| unit[**j] == 0.0 && *most > 0.0);
        new.collect::<Vec<_>>().into_iter().for_each(|(&j, most)| unit[j] = most.recip());
    }
    for &j in free {
        let most = largest(&|i| size(i, j));
        unit[j] = if unit[j] == 0.0 && most > 0.0 { most.sqrt().recip() } else { unit[j] };
    }
    for _ in 0..20 {
        let most: Vec<f64> = free.iter().map(|&j| largest(&|i| unit[i] * size(i, j) * unit[j])).collect();
        if most.iter().all(|most| *most == 0.0 || (1.0 / 1.5..=1.5).contains(most)) {
            break;
        }
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

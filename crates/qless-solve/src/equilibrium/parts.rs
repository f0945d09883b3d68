//! Connected parts of a model: DOFs that are connected by entries of K, equations or rotations. Prescribed DOFs do not connect parts.
//!
//! Results of a part depend on that part alone. Parts are ordered by their lowest DOFs. An equation that has only prescribed DOFs is a part
//! of its own; such parts come last, ordered by their rows.

use qless::common::DisjointSets;
use qless_constraints::{ConstraintSet, Evaluation};

use super::model::Assembly;
use crate::newton::{EquationParts, join_all};

/// Marks a prescribed DOF.
const NONE: u32 = u32::MAX;

/// One part.
#[derive(Default)]
pub struct EquilibriumPart {
    /// Its DOFs, ascending.
    pub free: Vec<usize>,
    /// Its equations, ascending.
    pub rows: Vec<usize>,
    /// Prescribed DOFs in its stiffness or equations, ascending.
    pub prescribed: Vec<usize>,
}

pub struct EquilibriumParts {
    pub list: Vec<EquilibriumPart>,
    /// Prescribed DOFs that belong to no part.
    pub untouched: EquilibriumPart,
    of_dof: Vec<u32>,
    of_row: Vec<u32>,
    place: Vec<u32>,
    /// Parts of the equations alone, without stiffness.
    pub of_equations: EquationParts,
}

impl EquilibriumParts {
    pub fn new(assembly: &Assembly, set: &ConstraintSet, evaluation: &Evaluation, prescribed: &[(usize, f64)]) -> Self {
        let n = set.dofs();
        let mut is_prescribed = vec![false; n];
        prescribed.iter().for_each(|&(j, _)| is_prescribed[j] = true);
        let mut roots = joined(assembly, set, evaluation, &is_prescribed);
        let (mut list, mut place): (Vec<EquilibriumPart>, _) = (Vec::new(), vec![NONE; n]);
        let mut of_dof = vec![NONE; n];
        for j in (0..n).filter(|&j| !is_prescribed[j]) {
            let root = roots.root(j);
            if root == j {
                of_dof[j] = list.len() as u32;
                list.push(EquilibriumPart::default());
            }
            of_dof[j] = of_dof[root];
            let free = &mut list[of_dof[j] as usize].free;
            place[j] = free.len() as u32;
            free.push(j);
        }
        let g = evaluation.g();
        let mut of_row = Vec::with_capacity(g.rows());
        for r in 0..g.rows() {
            let part = g.row(r).map(|(j, _)| of_dof[j]).find(|&part| part != NONE);
            let part = part.unwrap_or(list.len() as u32);
            list.resize_with(list.len().max(part as usize + 1), EquilibriumPart::default);
            list[part as usize].rows.push(r);
            of_row.push(part);
        }
        list.iter_mut().for_each(|part| part.collect_prescribed(assembly, evaluation, &is_prescribed));
        let mut touched: Vec<bool> = is_prescribed.iter().map(|prescribed| !prescribed).collect();
        list.iter().flat_map(|part| &part.prescribed).for_each(|&j| touched[j] = true);
        let rest = (0..n).filter(|&j| !touched[j]).collect();
        let untouched = EquilibriumPart { prescribed: rest, ..EquilibriumPart::default() };
        Self { list, untouched, of_dof, of_row, place, of_equations: EquationParts::new(g, prescribed, &[]) }
    }

    pub fn of_row(&self, r: usize) -> usize {
        self.of_row[r] as usize
    }

    /// Index of a DOF within a part; none if it is prescribed or in another part.
    pub fn place(&self, part: usize, j: usize) -> Option<usize> {
        (self.of_dof[j] as usize == part).then(|| self.place[j] as usize)
    }
}

impl EquilibriumPart {
    /// Collects its prescribed DOFs.
    fn collect_prescribed(&mut self, assembly: &Assembly, evaluation: &Evaluation, is_prescribed: &[bool]) {
        let g = evaluation.g();
        let of_row = |&r: &usize| g.row(r).map(|(j, _)| j).filter(|&j| is_prescribed[j]);
        let of_k = self.free.iter().flat_map(|&i| assembly.row(i).map(|(j, _)| j)).filter(|&j| is_prescribed[j]);
        self.prescribed = of_k.chain(self.rows.iter().flat_map(of_row)).collect();
        self.prescribed.sort_unstable();
        self.prescribed.dedup();
    }
}

/// Connected components of the free DOFs.
fn joined(assembly: &Assembly, set: &ConstraintSet, evaluation: &Evaluation, is_prescribed: &[bool]) -> DisjointSets {
    let (mut sets, g) = (DisjointSets::new(is_prescribed.len()), evaluation.g());
    (0..g.rows()).for_each(|r| join_all(&mut sets, g.row(r).map(|(j, _)| j).filter(|&j| !is_prescribed[j])));
    for i in (0..is_prescribed.len()).filter(|&i| !is_prescribed[i]) {
        let of_k = assembly.row(i).map(|(j, _)| j);
        join_all(&mut sets, std::iter::once(i).chain(of_k).filter(|&j| !is_prescribed[j]));
    }
    let vectors = set.rotation_vectors().into_iter().filter(|vector| vector.iter().all(|&j| !is_prescribed[j]));
    vectors.for_each(|vector| join_all(&mut sets, vector));
    sets
}

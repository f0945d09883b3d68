//! The blocks of the paper's section 3.1: connected components, each factored separately.

use qless::{ConstraintSystem, Csr};

/// One block: C and its transpose.
pub struct FigureBlock {
    /// C by columns, the input of a backend: row j of this matrix is column j of C.
    pub c: Csr,
    /// `C^T` by columns, so row i is equation i.
    pub transposed: Csr,
    /// Right-hand sides of the equations of the block.
    pub rhs: Vec<f64>,
}

/// The blocks of C without its prescribed DOFs, ordered by their first equation. Equations without a free DOF are in no block.
pub fn blocks(system: &ConstraintSystem) -> Vec<FigureBlock> {
    let c = free(system);
    let mut place = vec![usize::MAX; c.cols()];
    parts(&c).iter().map(|rows| block(&c, system.rhs(), rows, &mut place)).collect()
}

/// C without the entries of prescribed DOFs.
fn free(system: &ConstraintSystem) -> Csr {
    let mut is_free = vec![true; system.dofs()];
    system.prescribed().iter().for_each(|&(j, _)| is_free[j] = false);
    let all = system.matrix();
    let mut c = Csr::empty(all.cols());
    (0..all.rows()).for_each(|i| c.push_row(all.row(i).filter(|&(j, _)| is_free[j])).expect("a row of C"));
    c
}

/// The equations of each connected component, ascending.
fn parts(c: &Csr) -> Vec<Vec<usize>> {
    let by_dof = c.transpose().expect("C has few enough columns");
    let mut seen = vec![false; c.rows()];
    let mut is_spread = vec![false; c.cols()];
    let mut parts = Vec::new();
    for first in (0..c.rows()).filter(|&i| c.row(i).len() > 0) {
        if std::mem::replace(&mut seen[first], true) {
            continue;
        }
        let mut part = vec![first];
        let mut next = 0;
        while next < part.len() {
            for (j, _) in c.row(part[next]).filter(|&(j, _)| !std::mem::replace(&mut is_spread[j], true)) {
                part.extend(by_dof.row(j).map(|(i, _)| i).filter(|&i| !std::mem::replace(&mut seen[i], true)));
            }
            next += 1;
        }
        part.sort_unstable();
        parts.push(part);
    }
    parts
}

/// The block of the equations `rows`; `place` is a work array with one number for each DOF.
fn block(c: &Csr, rhs: &[f64], rows: &[usize], place: &mut [usize]) -> FigureBlock {
    let mut dofs: Vec<usize> = rows.iter().flat_map(|&i| c.row(i).map(|(j, _)| j)).collect();
    dofs.sort_unstable();
    dofs.dedup();
    dofs.iter().enumerate().for_each(|(at, &j)| place[j] = at);
    let mut transposed = Csr::empty(dofs.len());
    rows.iter()
        .for_each(|&i| transposed.push_row(c.row(i).map(|(j, v)| (place[j], v))).expect("places ascend as DOFs do"));
    let c = transposed.transpose().expect("C has few enough columns");
    FigureBlock { c, transposed, rhs: rows.iter().map(|&i| rhs[i]).collect() }
}

#[cfg(test)]
mod tests {
    use qless::SystemBuilder;

    use super::blocks;

    /// A prescribed DOF does not connect equations; the last equation has no free DOF.
    #[test]
    fn blocks_share_no_free_dof() {
        let mut builder = SystemBuilder::new(6);
        builder.equation([(0, 1.0), (5, 2.0)], 1.0);
        builder.equation([(1, 3.0), (2, 4.0), (5, 1.0)], 2.0);
        builder.equation([(0, 5.0), (3, 6.0)], 3.0);
        builder.equation([(5, 1.0)], 0.0);
        builder.prescribe(5, 0.0);
        let found = blocks(&builder.build().expect("valid"));
        let shape = |k: usize| (found[k].c.cols(), found[k].c.rows(), found[k].rhs.clone());
        assert_eq!((found.len(), shape(0), shape(1)), (2, (2, 2, vec![1.0, 3.0]), (1, 2, vec![2.0])));
        assert_eq!(found[0].transposed.row(1).collect::<Vec<_>>(), [(0, 5.0), (1, 6.0)]);
        assert!(found.iter().all(|block| block.c.transpose().as_ref() == Ok(&block.transposed)));
    }
}

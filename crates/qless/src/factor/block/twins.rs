//! Blocks with the same matrix are factored once.
//!
//! Ties, mortar couplings and periodicity of a vector field repeat one matrix for each component, with the DOFs in another order:
//! `C = diag(A P1, A P2, A P3)`. What is found for A holds for all of them; only names and right-hand sides differ. A has its columns in an
//! order that depends on their entries alone, so that the result for a block does not depend on the other blocks.

use std::collections::HashMap;
use std::hash::{DefaultHasher, Hasher};
use std::sync::Arc;

use rayon::prelude::*;

use super::gathered::{Block, FactorContext};
use super::triangle::{BlockVectors, Triangle};
use super::{Found, diagnose};
use crate::Csr;
use crate::factor::backend::BackendError;
use crate::presolve::basis::{BlockCertificate, BlockDependent, Diagnosed, LateTerms, Vectors};

/// Diagnoses blocks in the caller's pool, each matrix once. The results are in the order of the blocks.
pub(crate) fn diagnose_all(
    blocks: &mut [Block],
    means: FactorContext,
) -> Result<Vec<(Diagnosed, Triangle)>, BackendError> {
    let columns: Vec<SortedColumns> = blocks.par_iter().map(SortedColumns::of).collect();
    let groups = groups(blocks, &columns);
    let diagnose_group = |group: &Vec<usize>| {
        let twins: Vec<&Block> = group.iter().map(|&k| &blocks[k]).collect();
        let mut common = common(&twins, &columns[group[0]]);
        diagnose(&mut common, means).map(|found| (common.units, found))
    };
    let found: Result<Vec<_>, _> = match groups.as_slice() {
        few @ ([] | [_]) => few.iter().map(diagnose_group).collect(),
        many => many.par_iter().map(diagnose_group).collect(),
    };
    let found = found?;
    let mut of_block = vec![(0, 0); blocks.len()];
    for (group, twins) in groups.iter().enumerate() {
        twins.iter().enumerate().for_each(|(place, &k)| of_block[k] = (group, place));
    }
    let all = blocks.par_iter_mut().zip(columns).zip(of_block);
    Ok(all.map(|((block, columns), (group, place))| translated(block, &columns.order, place, &found[group])).collect())
}

/// The columns of a block in an order that depends on their entries alone.
struct SortedColumns {
    order: Vec<usize>,
    /// The matrix of the block, transposed.
    entries: Csr,
    hash: u64,
}

impl SortedColumns {
    fn of(block: &Block) -> Self {
        let entries = block.matrix.transposed();
        let mut order: Vec<usize> = (0..block.matrix.cols).collect();
        let content = |j: usize| entries.row(j).map(|(i, v)| (i, v.to_bits()));
        order.sort_by(|&a, &b| content(a).cmp(content(b)));
        let mut hasher = DefaultHasher::new();
        for (i, bits) in order.iter().flat_map(|&j| content(j)) {
            hasher.write_usize(i);
            hasher.write_u64(bits);
        }
        let hash = hasher.finish();
        Self { order, entries, hash }
    }
}

/// Groups the blocks with equal matrices; each group lists indices of blocks.
fn groups(blocks: &[Block], columns: &[SortedColumns]) -> Vec<Vec<usize>> {
    let mut by_hash: HashMap<u64, Vec<usize>> = HashMap::new();
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for k in 0..blocks.len() {
        let same_hash = by_hash.entry(columns[k].hash).or_default();
        let is_twin = |first: usize| are_twins([&blocks[k], &blocks[first]], [&columns[k], &columns[first]]);
        if let Some(&group) = same_hash.iter().find(|&&group| is_twin(groups[group][0])) {
            groups[group].push(k);
        } else {
            same_hash.push(groups.len());
            groups.push(vec![k]);
        }
    }
    groups
}

/// Returns true if a diagnosis reads the same matrix, and the same data of its rows and DOFs, from both blocks.
fn are_twins([a, b]: [&Block; 2], columns: [&SortedColumns; 2]) -> bool {
    let is_same = |(&i, &j): (&usize, &usize)| {
        a.units[i] == b.units[j] && columns[0].entries.row(i).eq(columns[1].entries.row(j))
    };
    a.matrix.cols == b.matrix.cols
        && a.exponents == b.exponents
        && a.certain == b.certain
        && a.errors == b.errors
        && columns[0].order.iter().zip(&columns[1].order).all(is_same)
}

/// The common matrix of twins, with the right-hand sides of all; rows and DOFs are named by their places.
fn common(twins: &[&Block], columns: &SortedColumns) -> Block {
    let first = twins[0];
    let mut by_column = Csr::empty(first.matrix.rows());
    columns.order.iter().for_each(|&j| by_column.append(columns.entries.row(j)));
    let matrix = by_column.transposed();
    let effective = twins.iter().map(|twin| twin.effective[0].clone()).collect();
    let random = twins.iter().map(|twin| twin.random[0].clone()).collect();
    let units = columns.order.iter().map(|&j| first.units[j]).collect();
    Block {
        rows: (0..first.rows.len() as u32).collect(),
        exponents: first.exponents.clone(),
        dofs: (0..first.dofs.len() as u32).collect(),
        units,
        balanced: vec![0; first.dofs.len()],
        matrix,
        prescribed: first.prescribed.clone(),
        fixed: first.fixed.clone(),
        rhs: first.rhs.clone(),
        effective,
        certain: first.certain.clone(),
        errors: first.errors.clone(),
        random,
    }
}

/// Translates the diagnosis of the common matrix to the names of one of its blocks.
fn translated(
    block: &mut Block,
    columns: &[usize],
    place: usize,
    (units, found): &(Vec<i32>, Found),
) -> (Diagnosed, Triangle) {
    let Found { rows, vectors: BlockVectors { motions, solutions } } = found;
    let mut of_block = vec![0; units.len()];
    columns.iter().zip(units).for_each(|(&j, &unit)| of_block[j] = unit);
    if of_block.iter().all(|&unit| unit == 0) {
        block.restore_units();
    } else if of_block != block.units {
        block.set_units(of_block);
    }
    let own = |common: &Vec<f64>| {
        let mut own = vec![0.0; common.len()];
        columns.iter().zip(common).for_each(|(&j, &v)| own[j] = v);
        own
    };
    let Vectors { sample, particular, .. } = &solutions[place];
    let vectors =
        Vectors { moves: motions.moves.each_ref().map(own), sample: own(sample), particular: own(particular) };
    let names: Arc<[u32]> = block.rows.as_slice().into();
    let dependent = |d: &BlockDependent| BlockDependent {
        row: names[d.row as usize],
        because: named(&d.because, &names),
        mismatches: vec![d.mismatches[place]],
        ..*d
    };
    let diagnosed = Diagnosed {
        kept: rows.kept.iter().map(|&i| names[i]).collect(),
        order: rows.order.iter().map(|&k| k as u32).collect(),
        dependent: rows.dependent.iter().map(dependent).collect(),
        nearness: rows.nearness,
        vectors,
    };
    (diagnosed, rows.triangle.clone())
}

/// A certificate with the names of rows instead of their places in the common matrix. Places and names ascend, so the order of the terms
/// stays.
fn named(certificate: &BlockCertificate, names: &Arc<[u32]>) -> BlockCertificate {
    match certificate {
        BlockCertificate::Known(terms) => BlockCertificate::Known(with_names(terms, names)),
        BlockCertificate::Late(terms, k) => {
            let (terms, names) = (Arc::clone(terms), Arc::clone(names));
            BlockCertificate::Late(Arc::new(NamedTerms { terms, names }), *k)
        }
    }
}

fn with_names(terms: &[(u32, f64)], names: &[u32]) -> Vec<(u32, f64)> {
    terms.iter().map(|&(place, y)| (names[place as usize], y)).collect()
}

/// Late certificates of a common matrix, with the names of one of its blocks.
#[derive(Debug)]
struct NamedTerms {
    terms: Arc<dyn LateTerms>,
    names: Arc<[u32]>,
}

impl LateTerms for NamedTerms {
    fn terms(&self, k: usize) -> Vec<(u32, f64)> {
        with_names(&self.terms.terms(k), &self.names)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::factor::backend::faer::Faer;
    use crate::presolve::eliminated::Mismatch;

    /// `[1 2 3; 1 2 3; 1 0 1]` with its columns in an order; the second row has a right-hand side of its own.
    fn block(order: [usize; 3], first_row: u32, second_side: f64) -> Block {
        let mut matrix = Csr::empty(3);
        for row in [[1.0, 2.0, 3.0], [1.0, 2.0, 3.0], [1.0, 0.0, 1.0]] {
            matrix.append((0..3).map(|j| (j, row[order[j]])).filter(|&(_, v)| v != 0.0));
        }
        let side = |value: f64| Mismatch { value, size: value.abs(), error: 0.0 };
        Block {
            rows: (first_row..first_row + 3).collect(),
            exponents: vec![0; 3],
            dofs: (0..3).collect(),
            units: vec![0; 3],
            balanced: vec![0; 3],
            matrix,
            prescribed: Vec::new(),
            fixed: Csr { cols: 0, start: vec![0; 4], col: Vec::new(), val: Vec::new() },
            rhs: vec![1.0, second_side, 0.0],
            effective: vec![[1.0, second_side, 0.0].map(side).to_vec()],
            certain: vec![1.0; 3],
            errors: vec![f64::EPSILON; 3],
            random: vec![vec![0.5; 3]],
        }
    }

    #[test]
    fn blocks_with_the_same_matrix_share_a_factor_but_not_their_mismatches() {
        let mut blocks = [block([0, 1, 2], 0, 1.0), block([2, 0, 1], 10, 4.0), block([1, 1, 1], 20, 1.0)];
        let means = FactorContext::new(&Faer, 1e-10, true, usize::MAX);
        let found = diagnose_all(&mut blocks, means).expect("small");
        let factors = found.iter().map(|(_, triangle)| &triangle.factor).collect::<Vec<_>>();
        assert!(Arc::ptr_eq(factors[0], factors[1]) && !Arc::ptr_eq(factors[0], factors[2]));
        let of = |k: usize| found[k].0.dependent.iter().map(|d| (d.row, d.mismatches[0].value)).collect::<Vec<_>>();
        assert_eq!((of(0), of(1)), (vec![(1, 0.0)], vec![(11, 3.0)]));
        assert_eq!(found[1].0.kept, [10, 12]);
    }
}

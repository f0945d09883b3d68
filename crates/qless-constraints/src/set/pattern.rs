//! The pattern of H: "all pair lists are combined and sorted, duplicates are eliminated".

use super::block::Block;

/// Calls `entry` with row, column and number of all entries of a constraint: `(j, k)` and, off the diagonal, `(k, j)`.
pub fn entries(block: &dyn Block, i: usize, entry: &mut dyn FnMut(u32, u32, usize)) {
    block.pairs(i, &mut |j, k, number| {
        entry(j, k, number);
        if j != k {
            entry(k, j, number);
        }
    });
}

/// Compressed rows of all entries, sorted, none twice.
pub fn pattern(blocks: &[Box<dyn Block>], dofs: usize) -> (Vec<usize>, Vec<u32>) {
    let each = |entry: &mut dyn FnMut(u32, u32, usize)| {
        for block in blocks {
            (0..block.items()).for_each(|i| entries(block.as_ref(), i, entry));
        }
    };
    let mut next = vec![0_usize; dofs + 1];
    each(&mut |j, _, _| next[j as usize + 1] += 1);
    (0..dofs).for_each(|j| next[j + 1] += next[j]);
    let raw = next.clone();
    let mut all = vec![0_u32; raw[dofs]];
    each(&mut |j, k, _| {
        all[next[j as usize]] = k;
        next[j as usize] += 1;
    });
    let (mut start, mut col) = (vec![0], Vec::new());
    for j in 0..dofs {
        let row = &mut all[raw[j]..raw[j + 1]];
        row.sort_unstable();
        col.extend(row.chunk_by(|a, b| a == b).map(|same| same[0]));
        start.push(col.len());
    }
    (start, col)
}

/// The place of a column that is there.
pub fn position(cols: &[u32], k: u32) -> usize {
    cols.partition_point(|&col| col < k)
}

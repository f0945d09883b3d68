//! Blocks: connected components of the graph of rows and free DOFs, factored separately (section 3.1).

use crate::presolve::rows::Row;

/// The rows of each block, ascending; blocks in order of their first row.
pub(crate) fn split(rows: &[Row], core: &[u32], is_free: &[bool]) -> Vec<Vec<u32>> {
    let mut owner = vec![u32::MAX; is_free.len()];
    let mut parent: Vec<u32> = (0..core.len() as u32).collect();
    for (k, &i) in core.iter().enumerate() {
        for j in rows[i as usize].entries.iter().map(|entry| entry.dof).filter(|&j| is_free[j as usize]) {
            match owner[j as usize] {
                u32::MAX => owner[j as usize] = k as u32,
                other => join(&mut parent, other, k as u32),
            }
        }
    }
    let mut number = vec![u32::MAX; core.len()];
    let mut blocks: Vec<Vec<u32>> = Vec::new();
    for (k, &i) in core.iter().enumerate() {
        let root = find(&mut parent, k as u32) as usize;
        if number[root] == u32::MAX {
            number[root] = blocks.len() as u32;
            blocks.push(Vec::new());
        }
        blocks[number[root] as usize].push(i);
    }
    blocks
}

fn find(parent: &mut [u32], mut k: u32) -> u32 {
    while parent[k as usize] != k {
        parent[k as usize] = parent[parent[k as usize] as usize];
        k = parent[k as usize];
    }
    k
}

fn join(parent: &mut [u32], a: u32, b: u32) {
    let (a, b) = (find(parent, a), find(parent, b));
    parent[a.max(b) as usize] = a.min(b);
}

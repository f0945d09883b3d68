//! Lists of indices: the sparsity pattern of A by columns, as given, and by rows, as the fronts assemble it.

use crate::Error;

/// Marks the absence of a front, row or column.
pub(crate) const NONE: u32 = u32::MAX;

/// Largest count of rows, columns or entries. COLAMD has signed 32-bit indices, and a work array with over twice the entries.
const MOST: usize = i32::MAX as usize / 3;

/// Lists of indices in one array: list i is `index[start[i]..start[i + 1]]`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Lists {
    pub start: Vec<usize>,
    pub index: Vec<u32>,
}

impl Lists {
    pub fn new() -> Self {
        Self { start: vec![0], index: Vec::new() }
    }

    pub fn len(&self) -> usize {
        self.start.len() - 1
    }

    pub fn list(&self, i: usize) -> &[u32] {
        &self.index[self.start[i]..self.start[i + 1]]
    }

    /// Ends the list whose indices were just pushed to `index`.
    pub fn close(&mut self) {
        self.start.push(self.index.len());
    }

    /// Transposed lists: list i of the result, for i < `count`, holds every j whose list contains i, ascending.
    pub fn transposed(&self, count: usize) -> Self {
        let mut start = vec![0; count + 1];
        self.index.iter().for_each(|&i| start[i as usize + 1] += 1);
        (0..count).for_each(|i| start[i + 1] += start[i]);
        let (mut next, mut index) = (start.clone(), vec![0; self.index.len()]);
        for j in 0..self.len() {
            for &i in self.list(j) {
                index[next[i as usize]] = j as u32;
                next[i as usize] += 1;
            }
        }
        Self { start, index }
    }
}

/// An error if there are more than [`MOST`] rows, columns or entries.
pub(crate) fn countable(rows: usize, cols: usize, entries: usize) -> Result<(), Error> {
    if rows.max(cols).max(entries) > MOST { Err(Error::TooLarge { rows, cols, entries }) } else { Ok(()) }
}

/// The pattern by columns, if the arrays are valid.
pub(crate) fn checked(rows: usize, cols: usize, start: &[usize], index: &[u32]) -> Result<Lists, Error> {
    countable(rows, cols, index.len())?;
    if start.len() != cols + 1 {
        return Err(Error::Length { what: "start", found: start.len(), expected: cols + 1 });
    }
    if start[cols] != index.len() {
        return Err(Error::Length { what: "index", found: index.len(), expected: start[cols] });
    }
    let fault = |column: usize| fault(rows, start[column], start[column + 1], index).map(|what| (column, what));
    match (0..cols).find_map(fault) {
        _ if start[0] != 0 => Err(Error::Pattern { column: 0, what: "it does not start at 0" }),
        Some((column, what)) => Err(Error::Pattern { column, what }),
        None => Ok(Lists { start: start.to_vec(), index: index.to_vec() }),
    }
}

fn fault(rows: usize, from: usize, to: usize, index: &[u32]) -> Option<&'static str> {
    if from > to || to > index.len() {
        return Some("it ends before it starts");
    }
    let column = &index[from..to];
    if column.windows(2).any(|pair| pair[0] >= pair[1]) {
        return Some("its row indices do not ascend");
    }
    column.last().filter(|&&row| row as usize >= rows).map(|_| "a row index is beyond the rows")
}

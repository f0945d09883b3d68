//! Chooses the edits of cards that make equations independent, so that no equation need be rewritten.
//!
//! An edit leaves out a card, or one slave node of a divisible card, such as a grid point of an `RBE2`. An edit is permitted only if the
//! equations that remain imply all equations that it removes.
//!
//! Let `row_k = sum_i c_ki row_i` be the certificates of the dependent equations k, and N the matrix with `N_kk = 1` and `N_ik = -c_ki`.
//! Its columns span all linear dependencies of the equations. The equations of a set D are implied by the others if and only if the rows of
//! D in N are linearly independent. Edits are tried one by one: first those of equations with faults, then from the end of the deck.
//! Dependencies that share equations form a group. If the edits drop fewer equations of a group than it has dependent ones, they are
//! ignored, and its equations are chosen without regard to cards.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};

use qless::Analysis;
use qless::common::DisjointSets;
use rustc_hash::{FxHashMap, FxHashSet};

use super::Removed;
use crate::deck::{Model, Origin};

/// Limit on the number of dependent equations. With more, no edits are searched for: the search must not take longer than the analysis.
const DEPENDENT: usize = 1_000_000;
/// Limit on the number of operations of a search, for the same reason: it must not take longer than the analysis.
const OPERATIONS: usize = 50_000_000;

/// The stored rows are subtracted from a new row. A number that is then below this fraction of the largest original number of the row is a
/// rounding error.
const ROUNDING: f64 = 1e-9;

/// A key for the text line of an equation: equations with the same key come from the same line. An Abaqus part is read once for each
/// instance, so equations of several instances share lines.
pub fn text_of(model: &Model, origin: Origin) -> (u32, u32) {
    let card = if model.has_instances() { model.cards.nth(origin.card).file } else { origin.card };
    (card, origin.line)
}

/// Identifies an edit: the key of a text line, and a node if the edit leaves out only this node of the card, else 0.
pub type EditKey = ((u32, u32), u32);

/// The edit that drops equation `i`. It leaves out the whole card; if `by_node` is true and the card is divisible, it leaves out only the
/// slave node of the equation.
pub fn edit_of(model: &Model, i: usize, by_node: bool) -> EditKey {
    let origin = model.nth(i).origin;
    let node = if by_node && model.cards.is_divisible(origin.card) { slave_node(model, i) } else { 0 };
    (text_of(model, origin), node)
}

fn slave_node(model: &Model, i: usize) -> u32 {
    model.nth(i).columns.first().map_or(0, |&j| model.dofs[j as usize].node)
}

/// The slave nodes of a card that loses only some of them.
#[derive(Default)]
pub struct ShorterCard {
    /// The nodes that remain, in the order of the card.
    pub left: Vec<u32>,
    /// The nodes that the card loses.
    pub lost: Vec<u32>,
}

impl ShorterCard {
    /// The nodes that the card loses, for a comment.
    pub fn lost_names(&self) -> String {
        const NAMED: usize = 8;
        let names: Vec<String> = self.lost.iter().take(NAMED).map(u32::to_string).collect();
        names.join(", ") + if self.lost.len() > NAMED { ", ..." } else { "" }
    }
}

/// The cards that lose some of their slave nodes but not all, by file and line.
pub fn shortened(model: &Model, removed: &[Removed]) -> BTreeMap<(u32, u32), ShorterCard> {
    let gone: FxHashSet<usize> = removed.iter().map(|removed| removed.equation).collect();
    let place = |i: usize| {
        let origin = model.nth(i).origin;
        (model.cards.nth(origin.card).file, origin.line)
    };
    let mut cards: BTreeMap<_, ShorterCard> = gone.iter().map(|&i| (place(i), ShorterCard::default())).collect();
    for i in 0..model.equations() {
        let Some(card) = cards.get_mut(&place(i)) else { continue };
        let (side, node) = (if gone.contains(&i) { &mut card.lost } else { &mut card.left }, slave_node(model, i));
        if side.last() != Some(&node) {
            side.push(node);
        }
    }
    cards.retain(|_, card| !card.left.is_empty());
    cards
}

/// Chooses equations to keep, given as rows of the analysis, such that edits of cards drop as many equations as are dependent. `edit` gives
/// the edit of an equation, or `None` if its card must not change. Edits of equations with the largest `gain` are tried first. `None` if no
/// edit helps.
pub fn kept_by_edits(
    model: &Model,
    rows: &[usize],
    analysis: &Analysis,
    edit: impl Fn(usize) -> Option<EditKey>,
    gain: impl Fn(usize) -> u8,
) -> Option<Vec<usize>> {
    let dependencies = Dependencies::collect(model, rows, analysis)?;
    let mut edits: BTreeMap<_, Vec<usize>> = BTreeMap::new();
    let keys = rows.iter().enumerate().filter_map(|(row, &i)| Some((row, edit(i)?)));
    keys.for_each(|(row, key)| edits.entry(key).or_default().push(row));
    let mut edits: Vec<Vec<usize>> = edits.into_values().collect();
    edits.retain(|edit| edit.iter().all(|row| dependencies.rows.contains_key(row)));
    edits.sort_by_key(|edit| (edit.iter().map(|&row| gain(rows[row])).max(), edit.last().copied()));
    let mut echelon = Echelon::new(dependencies.count);
    let dropped: FxHashSet<usize> =
        edits.iter().rev().filter(|edit| echelon.extend(&dependencies, edit)).flatten().copied().collect();
    let kept = dependencies.kept(&dropped);
    (!kept.is_empty() && echelon.operations < OPERATIONS).then_some(kept)
}

/// The nonzero rows of the matrix N of dependencies (see the head of this file), by row of the analysis. Each equation counts as divided by
/// its largest coefficient.
struct Dependencies {
    rows: FxHashMap<usize, Vec<(usize, f64)>>,
    count: usize,
}

impl Dependencies {
    /// Reads the certificates of the dependent equations. `None` if there are no dependent equations or more than [`DEPENDENT`], or if a
    /// certificate cannot be computed.
    fn collect(model: &Model, numbers: &[usize], analysis: &Analysis) -> Option<Self> {
        let size = |row: usize| model.nth(numbers[row]).coefficients.iter().fold(0.0_f64, |most, a| most.max(a.abs()));
        let dependent: Vec<usize> = analysis.dependent().iter().map(|one| one.row).collect();
        let mut rows: FxHashMap<usize, Vec<(usize, f64)>> = FxHashMap::default();
        for (k, &row) in dependent.iter().enumerate().take(DEPENDENT) {
            rows.entry(row).or_default().push((k, 1.0));
            for term in analysis.because(row).ok()? {
                rows.entry(term.row).or_default().push((k, -term.coefficient * size(term.row) / size(row)));
            }
        }
        (1..=DEPENDENT).contains(&dependent.len()).then_some(Self { rows, count: dependent.len() })
    }

    /// The equations to keep. Dependencies that share equations form a group. An equation is kept by this choice only if its group loses as
    /// many equations by edits as it has dependencies.
    fn kept(&self, dropped: &FxHashSet<usize>) -> Vec<usize> {
        let mut sets = DisjointSets::new(self.count);
        self.rows.values().for_each(|row| row.iter().for_each(|(k, _)| sets.join(row[0].0, *k)));
        let part_of = sets.numbered().0;
        let mut excess: FxHashMap<u32, isize> = FxHashMap::default();
        part_of.iter().for_each(|&part| *excess.entry(part).or_default() += 1);
        let part = |row: &usize| part_of[self.rows[row][0].0];
        dropped.iter().for_each(|row| *excess.entry(part(row)).or_default() -= 1);
        self.rows.keys().copied().filter(|row| excess[&part(row)] == 0 && !dropped.contains(row)).collect()
    }
}

/// Linearly independent rows in echelon form. Each row comes with the column of its pivot, and is reduced by the rows before it.
struct Echelon {
    rows: Vec<(usize, Vec<(usize, f64)>)>,
    /// For each column, the index in `rows` of the row that has its pivot there.
    of_pivot: Vec<Option<usize>>,
    /// The row that is being reduced: its value in each column, and in `columns` the columns that have or had an entry.
    values: Vec<Option<f64>>,
    columns: Vec<usize>,
    operations: usize,
}

impl Echelon {
    fn new(count: usize) -> Self {
        let (of_pivot, values) = (vec![None; count], vec![None; count]);
        Self { rows: Vec::new(), of_pivot, values, columns: Vec::new(), operations: 0 }
    }

    /// Adds the rows of all equations of an edit. If they are linearly dependent, adds none and returns false.
    fn extend(&mut self, dependencies: &Dependencies, edit: &[usize]) -> bool {
        let before = self.rows.len();
        let is_added = edit.iter().all(|row| self.push(&dependencies.rows[row]));
        if !is_added {
            for (pivot, _) in self.rows.drain(before..) {
                self.of_pivot[pivot] = None;
            }
        }
        is_added
    }

    /// Adds a row if it is linearly independent of the stored rows; returns whether it is.
    fn push(&mut self, row: &[(usize, f64)]) -> bool {
        let size = row.iter().fold(0.0_f64, |most, (_, a)| most.max(a.abs()));
        if self.operations >= OPERATIONS {
            return false;
        }
        let mut row = self.remainder(row);
        row.retain(|(_, a)| a.abs() > ROUNDING * size);
        // The pivot is the number with the largest absolute value. If several are equal, it is the one in the last column.
        let largest =
            (0..row.len()).max_by(|&p, &q| row[p].1.abs().total_cmp(&row[q].1.abs()).then(row[p].0.cmp(&row[q].0)));
        let Some(largest) = largest else { return false };
        row.swap(0, largest);
        self.of_pivot[row[0].0] = Some(self.rows.len());
        self.rows.push((row[0].0, row));
        true
    }

    /// Subtracts multiples of the stored rows from a row, so that it has no entry at their pivots. A stored row has no entry at the pivots
    /// of the rows before it, so one pass in their order suffices. `next` holds the indices of stored rows that must still be subtracted.
    fn remainder(&mut self, row: &[(usize, f64)]) -> Vec<(usize, f64)> {
        let mut next = BinaryHeap::new();
        row.iter().for_each(|&(j, a)| self.add(j, a, &mut next));
        while let Some(Reverse(at)) = next.pop() {
            let reduced = std::mem::take(&mut self.rows[at].1);
            let factor = self.values[reduced[0].0].replace(0.0).unwrap_or_default() / reduced[0].1;
            reduced[1..].iter().for_each(|&(j, a)| self.add(j, -factor * a, &mut next));
            self.operations += reduced.len();
            self.rows[at].1 = reduced;
        }
        let Self { values, columns, .. } = self;
        columns.drain(..).filter_map(|j| Some((j, values[j].take()?))).collect()
    }

    /// Adds a number to column j of the row. If the row had no entry there and j is the pivot column of a stored row, adds that row to
    /// `next`.
    fn add(&mut self, j: usize, part: f64, next: &mut BinaryHeap<Reverse<usize>>) {
        if let Some(value) = &mut self.values[j] {
            *value += part;
            return;
        }
        self.values[j] = Some(part);
        self.columns.push(j);
        next.extend(self.of_pivot[j].map(Reverse));
    }
}

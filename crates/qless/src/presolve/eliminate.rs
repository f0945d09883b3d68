//! Elimination without fill: `row_k <- row_k - (a_kj / a_pj) row_p` wherever that adds no net entry.
//!
//! A pivot (p, j) adds none if row p has one free DOF (j is fixed: a generated boundary condition), if it has two
//! (`a u_i + c u_j = d`: chains, cycles, trees of equal DOFs), or if DOF j occurs in at most two remaining rows.
//! Long chains go in linear time, iteratively. A row whose free part vanishes is dependent. In connected parts of which much
//! is left, DOFs in few rows are eliminated with some fill, in the manner of Markowitz (1957).
//!
//! Every coefficient carries a bound of its rounding error, and every row the size of the largest part that went into it.
//! What cancels to the first is zero; a row all below `tolerance` times the second is dependent too; a row below
//! [`SUSPECT`] times it is left to the backend, whose rank is checked.

use std::collections::VecDeque;

use super::gather::Gathered;
use super::rows::{Entry, Row, bound};
use crate::input::components::components;
use crate::input::scale::ldexp;

/// A row whose remaining part is smaller than this, relative to what went into it, is no pivot.
pub(crate) const SUSPECT: f64 = 1e-3;
/// A pivot is at least this fraction of the entries that it eliminates, which bounds the multipliers, ...
const THRESHOLD: f64 = 0.1;
/// ... and at least a fraction of its own row, the strictest first, which bounds the growth of T as long as it can be.
/// The first levels make no fill; the others follow only while the core is [`LARGE`].
const LEVELS: [Level; 6] = [
    Level { rows: 2, of_row: 1.0 },
    Level { rows: 2, of_row: 0.1 },
    Level { rows: 2, of_row: 1e-3 },
    Level { rows: 3, of_row: 1.0 },
    Level { rows: 5, of_row: 1.0 },
    Level { rows: 8, of_row: 1.0 },
];
const WITHOUT_FILL: usize = 3;

/// Most that coefficients along a way from slave to slave may multiply to: with it numbers of T could grow, and lose digits.
const PATH: f64 = 1e3;

/// A row with more free DOFs is no pivot for others: each time all of it would go over.
const LONG: u32 = 64;

/// A connected part with more rows than this is worth some fill: factoring it costs more than eliminating from it.
const LARGE: usize = 800;

/// Most entries that one pivot may touch, `(row length - 1) (rows - 1)`, where there is fill.
const MARKOWITZ: u32 = 48;

/// Which DOFs may be eliminated: in at most so many rows, with at least this size relative to their pivot row.
struct Level {
    rows: u32,
    of_row: f64,
}

/// One pivot: the row as it was when it became the equation of its slave.
#[derive(Clone, Debug)]
pub(crate) struct Step {
    /// Index into the rows given.
    pub row: u32,
    /// The slave.
    pub dof: u32,
    /// Its coefficient.
    pub pivot: f64,
    /// The other entries of the row.
    pub others: Vec<(u32, f64)>,
    pub rhs: f64,
    /// As [`Row::reach`].
    pub reach: f64,
}

/// A row without a free part.
#[derive(Clone, Debug)]
pub(crate) struct Dead {
    pub row: u32,
    /// What was dropped to call it dependent, relative to its parts; 0 if no more than rounding was.
    pub dropped: f64,
    /// As [`Row::reach`].
    pub reach: f64,
    /// `b - C_p u_p` minus the same of its certificate.
    pub mismatch: Mismatch,
}

/// How far the right-hand side of a dependent row is from that of its certificate.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Mismatch {
    pub value: f64,
    /// Largest part that went into it.
    pub size: f64,
    /// Bound of its rounding error.
    pub error: f64,
}

impl Mismatch {
    pub fn of(row: &Row) -> Self {
        Self { value: row.effective, size: row.effective_size, error: row.effective_error }
    }

    /// All times `2^exponent`.
    pub fn scaled(self, exponent: i32) -> Self {
        let Self { value, size, error } = self;
        Self { value: ldexp(value, exponent), size: ldexp(size, exponent), error: ldexp(error, exponent) }
    }

    /// Subtracts `factor` times another right-hand side.
    pub fn subtract(&mut self, factor: f64, other: Self) {
        let part = (factor * other.size).abs();
        self.value -= factor * other.value;
        self.size = self.size.max(part);
        self.error += factor.abs() * other.error + f64::EPSILON * part;
    }
}

/// What elimination leaves.
#[derive(Default)]
pub(crate) struct Eliminated {
    /// The user's row of each row given.
    pub names: Vec<u32>,
    pub steps: Vec<Step>,
    /// For each row given, the steps subtracted from it and the factors, in order of time.
    pub factors: Vec<Vec<(u32, f64)>>,
    pub dead: Vec<Dead>,
    /// Rows left for the backend, ascending.
    pub core: Vec<u32>,
    /// The rows as they are now; only those of the core still have entries.
    pub rows: Vec<Row>,
}

impl Eliminated {
    /// Of groups of rows that share no free DOF, together: rows by the user's number, as if they had been eliminated at once.
    pub fn join(mut groups: Vec<Self>) -> Self {
        if groups.len() < 2 {
            return groups.pop().unwrap_or_default();
        }
        let mut order: Vec<(u32, usize, usize)> = Vec::new();
        for (g, group) in groups.iter().enumerate() {
            order.extend(group.names.iter().enumerate().map(|(i, &name)| (name, g, i)));
        }
        order.sort_unstable();
        let mut number: Vec<Vec<u32>> = groups.iter().map(|group| vec![0; group.names.len()]).collect();
        order.iter().zip(0..).for_each(|(&(_, g, i), k)| number[g][i] = k);
        let mut first = vec![0_u32];
        groups.iter().for_each(|group| first.push(first[first.len() - 1] + group.steps.len() as u32));
        let mut all = Self::default();
        for &(name, g, i) in &order {
            all.names.push(name);
            let mut factors = std::mem::take(&mut groups[g].factors[i]);
            factors.iter_mut().for_each(|(step, _)| *step += first[g]);
            all.factors.push(factors);
            all.rows.push(std::mem::take(&mut groups[g].rows[i]));
        }
        for (group, number) in groups.into_iter().zip(&number) {
            let renamed = |row: u32| number[row as usize];
            all.steps.extend(group.steps.into_iter().map(|step| Step { row: renamed(step.row), ..step }));
            all.dead.extend(group.dead.into_iter().map(|dead| Dead { row: renamed(dead.row), ..dead }));
            all.core.extend(group.core.into_iter().map(renamed));
        }
        all.core.sort_unstable();
        all
    }

    /// The rows of the core that are connected, part by part; `is_free` by the DOFs of the result.
    pub fn components(&self, is_free: &[bool]) -> Vec<Vec<u32>> {
        let free = |i: u32| self.rows[i as usize].entries.iter().map(|e| e.dof).filter(|&j| is_free[j as usize]);
        components(&self.core, is_free.len(), free)
    }
}

#[derive(Clone, Copy, PartialEq)]
enum State {
    Active,
    Done,
    /// Too small for a pivot here: for the backend.
    Held,
}

struct Elimination<'a> {
    out: Eliminated,
    state: Vec<State>,
    is_free: &'a [bool],
    /// Rows that may hold a DOF: a superset without order; `count` is exact.
    holders: Vec<Vec<u32>>,
    count: Vec<u32>,
    /// For each DOF the largest product of coefficients along a way from a slave to it.
    path: Vec<f64>,
    /// Largest coefficient of a free DOF in each row; no number where the row has changed since it was last asked for.
    largest: Vec<f64>,
    short_rows: VecDeque<u32>,
    /// DOFs in at most two rows; those whose coefficients are too small in their rows wait in the next queue.
    rare_dofs: [VecDeque<u32>; LEVELS.len()],
    /// Rows that are neither pivots nor dependent; while filling, those of the part that is worked on.
    active: usize,
    filling: bool,
    tolerance: f64,
}

/// Eliminates as far as no fill arises. Rows of `held` (by the user's row) are no pivots, but are closed if empty.
/// DOFs of the result are local ones.
pub(crate) fn eliminate(gathered: Gathered, tolerance: f64, held: &[bool]) -> Eliminated {
    let Gathered { names, dofs, free: is_free, rows } = gathered;
    let m = rows.len();
    let mut work = Elimination {
        out: Eliminated { rows, factors: vec![Vec::new(); m], ..Eliminated::default() },
        state: names.iter().map(|&i| if held[i as usize] { State::Held } else { State::Active }).collect(),
        is_free: &is_free,
        holders: vec![Vec::new(); dofs.len()],
        count: vec![0; dofs.len()],
        path: vec![1.0; dofs.len()],
        largest: vec![f64::NAN; m],
        short_rows: (0..m as u32).collect(),
        rare_dofs: Default::default(),
        active: m,
        filling: false,
        tolerance,
    };
    work.count();
    work.close_empty();
    work.run();
    work.fill();
    work.finish(names, &dofs)
}

impl Elimination<'_> {
    fn count(&mut self) {
        for (i, row) in self.out.rows.iter_mut().enumerate() {
            row.free = 0;
            for j in row.entries.iter().map(|entry| entry.dof).filter(|&j| self.is_free[j as usize]) {
                row.free += 1;
                self.count[j as usize] += 1;
                self.holders[j as usize].push(i as u32);
            }
        }
        self.rare_dofs[0].extend((0..self.count.len() as u32).filter(|&j| self.count[j as usize] <= 2));
    }

    fn run(&mut self) {
        loop {
            if let Some(i) = self.short_rows.pop_front() {
                self.try_row(i);
            } else if let Some((level, j)) = self.next_dof() {
                self.try_dof(j, level);
            } else {
                return;
            }
        }
    }

    /// Goes on with some fill in each connected part that is large, which no other part has a say in.
    fn fill(&mut self) {
        if self.active <= LARGE {
            return;
        }
        let left: Vec<u32> = (0..self.state.len() as u32).filter(|&i| self.state[i as usize] != State::Done).collect();
        let parts = components(&left, self.count.len(), |i| {
            self.out.rows[i as usize].entries.iter().map(|entry| entry.dof).filter(|&j| self.is_free[j as usize])
        });
        self.filling = true;
        for part in parts.into_iter().filter(|part| part.len() > LARGE) {
            let entries = |&i: &u32| self.out.rows[i as usize].entries.iter().map(|entry| entry.dof);
            let mut dofs: Vec<u32> = part.iter().flat_map(entries).filter(|&j| self.is_free[j as usize]).collect();
            dofs.sort_unstable();
            dofs.dedup();
            self.active = part.len();
            dofs.into_iter().for_each(|j| self.enqueue(j, WITHOUT_FILL));
            self.run();
            self.rare_dofs.iter_mut().for_each(VecDeque::clear);
        }
    }

    fn next_dof(&mut self) -> Option<(usize, u32)> {
        let levels = if self.filling && self.active > LARGE { LEVELS.len() } else { WITHOUT_FILL };
        self.rare_dofs[..levels].iter_mut().enumerate().find_map(|(level, queue)| Some((level, queue.pop_front()?)))
    }

    /// Queues a DOF at the first level, from `least` on, that its count allows.
    fn enqueue(&mut self, j: u32, least: usize) {
        let levels = if self.filling { LEVELS.len() } else { WITHOUT_FILL };
        let count = self.count[j as usize];
        if let Some(level) = (least..levels).find(|&level| count <= LEVELS[level].rows) {
            self.rare_dofs[level].push_back(j);
        }
    }

    fn close_empty(&mut self) {
        for i in 0..self.out.rows.len() as u32 {
            if self.out.rows[i as usize].free == 0 {
                self.settle(i);
            }
        }
    }

    fn finish(mut self, names: Vec<u32>, dofs: &[u32]) -> Eliminated {
        self.out.names = names;
        let left = |&i: &u32| self.state[i as usize] != State::Done;
        self.out.core = (0..self.out.rows.len() as u32).filter(left).collect();
        for (row, state) in self.out.rows.iter_mut().zip(&self.state) {
            row.forget_table();
            if *state == State::Done {
                row.entries = Vec::new();
            }
            row.entries.iter_mut().for_each(|entry| entry.dof = dofs[entry.dof as usize]);
        }
        for step in &mut self.out.steps {
            step.dof = dofs[step.dof as usize];
            step.others.iter_mut().for_each(|(j, _)| *j = dofs[*j as usize]);
        }
        self.out
    }

    fn try_row(&mut self, i: u32) {
        if self.state[i as usize] != State::Active || self.out.rows[i as usize].free > 2 || self.settle(i) {
            return;
        }
        let row = &self.out.rows[i as usize];
        let free: Vec<_> = row.entries.iter().copied().filter(|entry| self.is_free[entry.dof as usize]).collect();
        let dof = match *free.as_slice() {
            [one] => one.dof,
            [one, two] => self.better_of(one, two),
            _ => return,
        };
        self.pivot(i, dof);
    }

    /// Of `a u_i + c u_j` eliminates the larger coefficient, or, where both will do, the DOF in far fewer rows.
    fn better_of(&self, one: Entry, two: Entry) -> u32 {
        let (large, small) = if two.value.abs() > one.value.abs() { (two, one) } else { (one, two) };
        let cheaper = self.count[large.dof as usize] > 4 * self.count[small.dof as usize];
        if cheaper && small.value.abs() >= THRESHOLD * large.value.abs() { small.dof } else { large.dof }
    }

    /// Closes a row without free part; holds one that is too small for a pivot. True if the row is out of play.
    fn settle(&mut self, i: u32) -> bool {
        let left = self.largest(i);
        let row = &self.out.rows[i as usize];
        if left > SUSPECT * row.size {
            return false;
        }
        if left > self.tolerance * row.size {
            self.state[i as usize] = State::Held;
            return true;
        }
        let free = row.entries.iter().filter(|entry| self.is_free[entry.dof as usize]);
        let left = free.filter(|entry| entry.is_certain()).map(|entry| entry.value.abs()).fold(row.dropped, f64::max);
        let dropped = if row.size > 0.0 { left / row.size } else { 0.0 };
        self.out.dead.push(Dead { row: i, dropped, reach: row.reach, mismatch: Mismatch::of(row) });
        self.retire(i);
        true
    }

    fn retire(&mut self, i: u32) {
        self.state[i as usize] = State::Done;
        self.active -= 1;
        let entries = std::mem::take(&mut self.out.rows[i as usize].entries);
        for j in entries.iter().map(|entry| entry.dof).filter(|&j| self.is_free[j as usize]) {
            self.leave(j);
        }
        self.out.rows[i as usize].entries = entries;
    }

    fn leave(&mut self, dof: u32) {
        self.count[dof as usize] -= 1;
        self.enqueue(dof, 0);
    }

    fn try_dof(&mut self, j: u32, level: usize) {
        let count = self.count[j as usize];
        if count == 0 || count > LEVELS[level].rows {
            return self.enqueue(j, level + 1);
        }
        let mut holders = self.holding(j);
        holders.sort_unstable_by_key(|&(i, _)| (self.out.rows[i as usize].free, i));
        let Some(&(i, _)) = holders.iter().find(|&&(i, v)| self.may_pivot((i, j), v, &holders, LEVELS[level].of_row))
        else {
            return self.enqueue(j, level + 1);
        };
        if level >= WITHOUT_FILL && (self.out.rows[i as usize].free - 1) * (count - 1) > MARKOWITZ {
            return;
        }
        if !self.settle(i) {
            self.pivot(i, j);
        }
    }

    /// Rows in play that hold a DOF, with its coefficient; forgets the others.
    fn holding(&mut self, j: u32) -> Vec<(u32, f64)> {
        let mut list = std::mem::take(&mut self.holders[j as usize]);
        list.sort_unstable();
        list.dedup();
        let found = list.iter().filter(|&&i| self.state[i as usize] != State::Done).filter_map(|&i| {
            let row = &self.out.rows[i as usize];
            row.position(j).map(|k| (i, row.entries[k].value))
        });
        let found: Vec<_> = found.collect();
        list.clear();
        list.extend(found.iter().map(|&(i, _)| i));
        self.holders[j as usize] = list;
        found
    }

    fn may_pivot(&mut self, (i, j): (u32, u32), value: f64, holders: &[(u32, f64)], of_row: f64) -> bool {
        let is_short = self.out.rows[i as usize].free <= LONG || holders.len() == 1;
        if self.state[i as usize] != State::Active || !is_short {
            return false;
        }
        let largest = self.largest(i);
        value.abs() >= of_row * largest
            && self.path[j as usize] * largest <= PATH * value.abs()
            && holders.iter().all(|&(_, v)| value.abs() >= THRESHOLD * v.abs())
    }

    /// Largest coefficient of a free DOF in a row.
    fn largest(&mut self, i: u32) -> f64 {
        if self.largest[i as usize].is_nan() {
            let entries = self.out.rows[i as usize].entries.iter();
            let free = entries.filter(|entry| self.is_free[entry.dof as usize]);
            self.largest[i as usize] = free.map(|entry| entry.value.abs()).fold(0.0, f64::max);
        }
        self.largest[i as usize]
    }

    /// Row i becomes the equation of DOF j, which leaves all other rows.
    fn pivot(&mut self, i: u32, j: u32) {
        let targets = self.holding(j);
        self.retire(i);
        let mut row = std::mem::take(&mut self.out.rows[i as usize]);
        let position = row.entries.iter().position(|e| e.dof == j).expect("the pivot row holds the pivot DOF");
        let pivot = row.entries.swap_remove(position);
        for (k, value) in targets.into_iter().filter(|&(k, _)| k != i) {
            self.subtract(k, j, value / pivot.value, &pivot, &row);
        }
        self.count[j as usize] = 0;
        self.holders[j as usize] = Vec::new();
        let way = self.path[j as usize] / pivot.value.abs();
        for entry in &row.entries {
            let path = &mut self.path[entry.dof as usize];
            *path = path.max(way * entry.value.abs());
        }
        let others = row.entries.iter().map(|entry| (entry.dof, entry.value)).collect();
        self.out.steps.push(Step { row: i, dof: j, pivot: pivot.value, others, rhs: row.rhs, reach: row.reach });
    }

    /// `row_k <- row_k - factor row`, where `row` no longer holds the pivot.
    fn subtract(&mut self, k: u32, j: u32, factor: f64, pivot: &Entry, row: &Row) {
        self.out.factors[k as usize].push((self.out.steps.len() as u32, factor));
        self.largest[k as usize] = f64::NAN;
        let target = &mut self.out.rows[k as usize];
        // Relative error of the factor: that of the pivot, of the entry, and one rounding.
        let mut relative = f64::from(pivot.error) / pivot.value.abs() + f64::EPSILON;
        if let Some(position) = target.position(j) {
            let gone = target.remove(position);
            target.free -= 1;
            relative += f64::from(gone.error) / gone.value.abs();
        }
        let mut mismatch = Mismatch::of(target);
        mismatch.subtract(factor, Mismatch::of(row));
        target.rhs -= factor * row.rhs;
        target.reach = target.reach.max(factor.abs() * row.reach);
        (target.effective, target.effective_size, target.effective_error) =
            (mismatch.value, mismatch.size, mismatch.error + relative * (factor * row.effective).abs());
        for entry in &row.entries {
            let part = factor * entry.value;
            self.add(k, entry.dof, -part, relative * part.abs() + factor.abs() * f64::from(entry.error));
        }
        if self.out.rows[k as usize].free <= 2 {
            self.short_rows.push_back(k);
        }
    }

    fn add(&mut self, k: u32, l: u32, value: f64, error: f64) {
        let free = self.is_free[l as usize];
        let row = &mut self.out.rows[k as usize];
        row.size = row.size.max(value.abs());
        if value.abs() < f64::MIN_POSITIVE {
            // A product that left the range of doubles was no zero.
            row.dropped = row.dropped.max(f64::MIN_POSITIVE);
        }
        if let Some(position) = row.position(l) {
            if row.add(position, value, error) {
                row.remove(position);
                if free {
                    row.free -= 1;
                    self.leave(l);
                }
            }
            return;
        }
        row.insert(Entry { dof: l, value, error: bound(error) });
        if free {
            row.free += 1;
            self.count[l as usize] += 1;
            self.holders[l as usize].push(k);
        }
    }
}

//! Chooses slaves at nodes with local axes (`*TRANSFORM`) that ccx accepts.
//!
//! ccx rewrites an equation at such a node in the global axes and takes a global direction `d` as its slave. For a slave along the local
//! axis `e_s`, it tries the directions `s, s + 1, s + 2` (modulo 3). It takes the first one that no earlier equation of this node has taken
//! and in which the component of `e_s` is at least 1e-5. The coefficient of this direction is `sum_c l_c e_c . d`, where `l_c` are the
//! coefficients of the equation in local axes. ccx does not check this coefficient before the choice, and stops if it is zero. This module
//! therefore chooses other local slaves S for the equations E of a node and replaces E by `L_S^-1 E`, where `L_S` holds the coefficients of
//! E at S.

use std::collections::BTreeMap;

use crate::deck::calculix::definitions;
use crate::deck::kinematics::body::Poses;
use crate::deck::kinematics::vector::Vector;
use crate::deck::plan::{CleanError, Plan, Written};
use crate::deck::{Deck, Dof};

/// A component of a local axis below this counts as zero in ccx.
const LEAST: f64 = 1e-5;
/// A coefficient below this counts as zero if the equation has the coefficient 1 at its local slave.
const ZERO: f64 = 1e-6;

/// The equations of a plan, with slaves that ccx accepts.
pub fn with_slaves_for_ccx(deck: &Deck, plan: &Plan) -> Result<Vec<Written>, CleanError> {
    let mut written = plan.written.clone();
    let mut of_node: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    for (i, equation) in written.iter().enumerate() {
        let node = equation.slave.node;
        if deck.model.nodes_with_axes.contains(&node) && (1..=3).contains(&equation.slave.component) {
            of_node.entry(node).or_default().push(i);
        }
    }
    if of_node.is_empty() {
        return Ok(written);
    }
    let definitions = definitions(deck)?;
    for (node, equations) in of_node {
        let pose = definitions.pose(node).map_err(|problem| refused(deck, node, &problem.to_string()))?;
        let own = TransformedNode { deck, number: node, axes: pose.axes };
        own.choose_slaves(&equations, &mut written)?;
    }
    Ok(written)
}

fn refused(deck: &Deck, node: u32, why: &str) -> CleanError {
    let why = format!("its slaves at node {}, which has local axes: {why}", deck.model.node_name(node));
    CleanError::Fixed { place: deck.model.files[0].display().to_string(), why }
}

/// A node with local axes: `axes[c]` is axis c in global coordinates.
struct TransformedNode<'a> {
    deck: &'a Deck,
    number: u32,
    axes: [Vector; 3],
}

impl TransformedNode<'_> {
    /// Replaces the equations by combinations of them with other slaves if ccx would not accept them as they are.
    fn choose_slaves(&self, equations: &[usize], written: &mut [Written]) -> Result<(), CleanError> {
        let rows: Vec<[f64; 3]> = equations.iter().map(|&i| self.coefficients(&written[i])).collect();
        let slaves: Vec<usize> = equations.iter().map(|&i| usize::from(written[i].slave.component) - 1).collect();
        if self.are_accepted(&rows, &slaves) {
            return Ok(());
        }
        let is_one_layer = equations.iter().all(|&i| written[i].cases == written[equations[0]].cases);
        let others = choices(slaves.len()).into_iter().filter(|others| is_one_layer && self.is_free(others));
        let found = others.filter_map(|others| Some((inverse(&rows, &others)?, others)));
        let fitting = found.filter(|(by, others)| self.are_accepted(&product(by, &rows), others));
        let Some((by, others)) = fitting.min_by(|a, b| size(&a.0).total_cmp(&size(&b.0))) else {
            let why = "ccx would take directions in which their equations have no coefficient; remove *TRANSFORM there";
            return Err(refused(self.deck, self.number, why));
        };
        let old: Vec<Written> = equations.iter().map(|&i| written[i].clone()).collect();
        for (k, &i) in equations.iter().enumerate() {
            let slave = Dof { node: self.number, component: others[k] as u8 + 1 };
            written[i] = combined(&old, &by[k], slave);
        }
        Ok(())
    }

    /// The three coefficients of an equation at this node, in local axes.
    fn coefficients(&self, equation: &Written) -> [f64; 3] {
        let mut all = [0.0; 3];
        for &(dof, v) in equation.terms.iter().chain(&[(equation.slave, 1.0)]) {
            if dof.node == self.number && (1..=3).contains(&dof.component) {
                all[usize::from(dof.component) - 1] += v;
            }
        }
        all
    }

    /// Whether ccx accepts these equations with these slaves. It must find a direction for each slave, and each equation must have a
    /// nonzero coefficient in its direction. The coefficients of all equations in these directions must form a nonsingular matrix.
    fn are_accepted(&self, rows: &[[f64; 3]], slaves: &[usize]) -> bool {
        let global = |row: &[f64; 3], d: usize| (0..3).map(|c| row[c] * self.axes[c][d]).sum::<f64>();
        let mut taken: Vec<usize> = Vec::new();
        for &s in slaves {
            let free = (0..3).map(|k| (s + k) % 3).filter(|d| !taken.contains(d));
            match free.into_iter().find(|&d| self.axes[s][d].abs() >= LEAST) {
                Some(d) => taken.push(d),
                None => return false,
            }
        }
        let global_rows: Vec<[f64; 3]> = rows.iter().map(|row| [0, 1, 2].map(|d| global(row, d))).collect();
        let own = global_rows.iter().zip(&taken).all(|(row, &d)| row[d].abs() > ZERO);
        own && inverse(&global_rows, &taken).is_some()
    }

    /// Whether these components may be slaves: no other card claims them.
    fn is_free(&self, components: &[usize]) -> bool {
        let model = &self.deck.model;
        components.iter().all(|&c| !model.is_claimed(Dof { node: self.number, component: c as u8 + 1 }))
    }
}

/// All ordered choices of `count` out of three components.
fn choices(count: usize) -> Vec<Vec<usize>> {
    let mut all: Vec<Vec<usize>> = vec![Vec::new()];
    for _ in 0..count {
        let longer = |choice: &Vec<usize>| {
            let next = (0..3).filter(|c| !choice.contains(c)).collect::<Vec<_>>();
            next.into_iter().map(|c| [choice.as_slice(), &[c]].concat()).collect::<Vec<_>>()
        };
        all = all.iter().flat_map(longer).collect();
    }
    all
}

/// The inverse of the matrix with the chosen columns, by Gauss elimination with pivoting; `None` if the matrix is nearly singular.
fn inverse(rows: &[[f64; 3]], columns: &[usize]) -> Option<Vec<Vec<f64>>> {
    let n = columns.len();
    let unit = |i: usize| (0..n).map(move |j| if i == j { 1.0 } else { 0.0 });
    let mut work: Vec<Vec<f64>> =
        rows.iter().enumerate().map(|(i, row)| columns.iter().map(|&c| row[c]).chain(unit(i)).collect()).collect();
    for k in 0..n {
        let pivot = (k..n).max_by(|&a, &b| work[a][k].abs().total_cmp(&work[b][k].abs()))?;
        work.swap(k, pivot);
        let scale = work[k][k];
        if scale.abs() <= ZERO {
            return None;
        }
        work[k].iter_mut().for_each(|v| *v /= scale);
        let own = work[k].clone();
        for (_, row) in work.iter_mut().enumerate().filter(|(i, _)| *i != k) {
            let factor = row[k];
            row.iter_mut().zip(&own).for_each(|(v, own)| *v -= factor * own);
        }
    }
    Some(work.into_iter().map(|row| row[n..].to_vec()).collect())
}

fn product(by: &[Vec<f64>], rows: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let sum = |row: &Vec<f64>, c: usize| row.iter().zip(rows).map(|(v, other)| v * other[c]).sum();
    by.iter().map(|row| [0, 1, 2].map(|c| sum(row, c))).collect()
}

fn size(by: &[Vec<f64>]) -> f64 {
    by.iter().flatten().fold(0.0, |most, v| most.max(v.abs()))
}

/// The combination `sum_k by_k E_k` of the old equations E_k. It has the coefficient 1 at its slave, and 0 at the slaves of the other
/// equations of the node.
fn combined(old: &[Written], by: &[f64], slave: Dof) -> Written {
    let mut sums: BTreeMap<Dof, (f64, f64)> = BTreeMap::new();
    for (equation, factor) in old.iter().zip(by) {
        for &(dof, v) in equation.terms.iter().chain(&[(equation.slave, 1.0)]) {
            let sum = sums.entry(dof).or_default();
            *sum = (sum.0 + factor * v, sum.1 + (factor * v).abs());
        }
    }
    sums.remove(&slave);
    // Terms that cancel up to rounding are dropped.
    let terms = sums.into_iter().filter(|(_, (v, size))| v.abs() > 1e-14 * size).map(|(dof, (v, _))| (dof, v));
    let rhs = old.iter().zip(by).map(|(equation, factor)| factor * equation.rhs).sum();
    Written { slave, terms: terms.collect(), rhs, cases: old[0].cases.clone() }
}

//! Short explanations in networks of ties: breadth-first search for the shortest circle (cycle of the graph) of equations with one or two
//! DOFs.
//!
//! DOFs are the vertices. An equation with two DOFs joins them; an equation with one DOF, or a prescribed value, joins it to the ground.
//! An equation with two DOFs follows from a path between them, or from paths of both to the ground; an equation with one DOF from a path
//! to the ground. The search starts at all DOFs of the equation at once.

use std::collections::HashMap;

use super::candidates::Candidates;

/// How the search reached a vertex (a DOF).
#[derive(Clone, Copy)]
struct Reached {
    /// Index of the DOF of the equation from which the search started.
    side: usize,
    depth: usize,
    /// The previous vertex, and the equation between; `None` at the start.
    from: Option<(u32, u32)>,
}

/// The connection of the last vertex of a path to the ground.
#[derive(Clone, Copy)]
enum Grounded {
    Equation(u32),
    Prescribed,
}

/// A cycle of equations: paths to the vertices `ends`, which the equation `joint` connects, or which are connected to the ground.
struct Circle {
    length: usize,
    ends: Vec<u32>,
    joint: Option<u32>,
    grounded: Vec<Grounded>,
}

/// The search around one equation.
struct TieSearch<'a> {
    candidates: &'a Candidates<'a>,
    reached: HashMap<u32, Reached>,
    /// For each side (a DOF at which the search starts), the vertex with the shortest path to the ground, the length of this path, and the
    /// connection of the vertex to the ground.
    ground: Vec<Option<(u32, usize, Grounded)>>,
    best: Option<Circle>,
}

/// Finds the shortest circle (cycle of equations) through a vector with one or two DOFs. Returns its equations, each with the DOF that it
/// eliminates from the vector, and the number of equations visited, at most `most`. The coefficients of the circle may not match; the
/// caller checks that.
pub(super) fn shortest_circle(candidates: &Candidates, ends: &[u32], most: usize) -> (Option<Vec<(u32, u32)>>, usize) {
    if ends.is_empty() || ends.len() > 2 {
        return (None, 0);
    }
    let mut search = TieSearch { candidates, reached: HashMap::new(), ground: vec![None; ends.len()], best: None };
    let effort = search.run(ends, most);
    (search.best.as_ref().map(|circle| search.equations(circle)), effort)
}

impl TieSearch<'_> {
    /// Searches level by level, until no circle of the next level can be shorter; returns the number of equations visited.
    fn run(&mut self, ends: &[u32], most: usize) -> usize {
        let mut level: Vec<u32> = ends.to_vec();
        for (side, &end) in ends.iter().enumerate() {
            self.reached.insert(end, Reached { side, depth: 0, from: None });
            self.ground_by_value(end, side, 0);
        }
        let (mut effort, mut depth) = (0, 0);
        while !level.is_empty() && effort < most && self.may_improve(depth) {
            let mut next = Vec::new();
            for vertex in level {
                effort += self.visit(vertex, most - effort, &mut next);
            }
            level = next;
            depth += 1;
        }
        effort
    }

    /// Returns true if vertices at this depth can close a shorter circle: by an equation between two of them, or by paths to the ground
    /// from all sides that have none yet.
    fn may_improve(&self, depth: usize) -> bool {
        let missing = self.ground.iter().filter(|ground| ground.is_none()).count();
        let known: usize = self.ground.iter().flatten().map(|ground| ground.1).sum();
        let by_ground = if missing == 0 { usize::MAX } else { known + missing * (depth + 1) };
        let by_equation = if self.ground.len() == 2 { 2 * depth + 1 } else { usize::MAX };
        self.best.as_ref().is_none_or(|best| best.length > by_ground.min(by_equation))
    }

    /// Follows at most `most` equations of a vertex; returns their number.
    fn visit(&mut self, vertex: u32, most: usize, next: &mut Vec<u32>) -> usize {
        let Reached { side, depth, from } = self.reached[&vertex];
        let rows = self.candidates.rows(vertex);
        let rows = &rows[..rows.len().min(most)];
        for &row in rows {
            if !self.candidates.is_allowed(row) || from.is_some_and(|(_, before)| before == row) {
                continue;
            }
            match *self.candidates.dofs(row) {
                [_] => self.reach_ground(vertex, side, depth + 1, Grounded::Equation(row)),
                [a, b] => self.follow(vertex, if a == vertex { b } else { a }, row, next),
                _ => {}
            }
        }
        rows.len()
    }

    fn follow(&mut self, vertex: u32, other: u32, row: u32, next: &mut Vec<u32>) {
        let Reached { side, depth, .. } = self.reached[&vertex];
        match self.reached.get(&other) {
            None => {
                self.reached.insert(other, Reached { side, depth: depth + 1, from: Some((vertex, row)) });
                self.ground_by_value(other, side, depth + 1);
                next.push(other);
            }
            Some(met) if met.side != side => {
                let ends = if side == 0 { vec![vertex, other] } else { vec![other, vertex] };
                let length = depth + met.depth + 1;
                self.offer(Circle { length, ends, joint: Some(row), grounded: Vec::new() });
            }
            Some(_) => {}
        }
    }

    fn ground_by_value(&mut self, vertex: u32, side: usize, depth: usize) {
        if !self.candidates.is_free(vertex) {
            self.reach_ground(vertex, side, depth + 1, Grounded::Prescribed);
        }
    }

    /// Records the shortest path of a side to the ground. If every side has one, the circle is closed.
    fn reach_ground(&mut self, vertex: u32, side: usize, length: usize, by: Grounded) {
        if self.ground[side].is_some_and(|known| known.1 <= length) {
            return;
        }
        self.ground[side] = Some((vertex, length, by));
        if self.ground.iter().all(Option::is_some) {
            let all: Vec<_> = self.ground.iter().flatten().copied().collect();
            self.offer(Circle {
                length: all.iter().map(|ground| ground.1).sum(),
                ends: all.iter().map(|ground| ground.0).collect(),
                joint: None,
                grounded: all.iter().map(|ground| ground.2).collect(),
            });
        }
    }

    fn offer(&mut self, circle: Circle) {
        if self.best.as_ref().is_none_or(|best| circle.length < best.length) {
            self.best = Some(circle);
        }
    }

    /// The equations of a circle, from the sides to their meeting point. Prescribed values are not equations.
    fn equations(&self, circle: &Circle) -> Vec<(u32, u32)> {
        let mut all = Vec::new();
        for (k, &end) in circle.ends.iter().enumerate() {
            let mut path = Vec::new();
            let mut vertex = end;
            while let Some((before, row)) = self.reached[&vertex].from {
                path.push((row, before));
                vertex = before;
            }
            all.extend(path.into_iter().rev());
            if let Some(Grounded::Equation(row)) = circle.grounded.get(k) {
                all.push((*row, end));
            }
        }
        all.extend(circle.joint.map(|row| (row, circle.ends[0])));
        all
    }
}

/// The factors with which these equations, one after the other, eliminate their DOFs from a vector.
pub(super) fn factors(candidates: &Candidates, vector: &[(u32, f64)], circle: &[(u32, u32)]) -> Vec<(u32, f64)> {
    let mut left: HashMap<u32, f64> = vector.iter().copied().collect();
    let mut all = Vec::new();
    for &(row, dof) in circle {
        let factor = left.get(&dof).copied().unwrap_or(0.0) / candidates.system.coefficient(row as usize, dof);
        for (j, value) in candidates.system.row(row as usize) {
            *left.entry(j as u32).or_default() -= factor * value;
        }
        left.remove(&dof);
        all.push((row, factor));
    }
    all
}

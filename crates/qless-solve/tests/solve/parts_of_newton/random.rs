//! Random mechanisms: near and far from a solution, at dead centres, redundant, contradictory, or out of reach.

use super::mechanism::{Item, Mechanism};
use crate::linkages::random;
use crate::poses::{add, direction, norm, scale, sub};

/// Number of kinds.
pub const KINDS: usize = 13;

/// A number in [-1, 1].
pub struct Draw(pub usize);

impl Draw {
    pub fn next(&mut self) -> f64 {
        self.0 += 1;
        2.0 * random(self.0)
    }

    pub fn some(&mut self, count: usize, size: f64) -> Vec<f64> {
        (0..count).map(|_| size * self.next()).collect()
    }

    pub fn of<T: Copy>(&mut self, list: &[T]) -> T {
        list[((0.5 + 0.499_999 * self.next()) * list.len() as f64) as usize]
    }
}

/// A mechanism of the given kind with a prescribed first DOF, in a unit of length.
pub fn mechanism(kind: usize, seed: usize, unit: f64) -> Mechanism {
    let mut draw = Draw(1_000 * (seed * KINDS + kind));
    match kind {
        0 => slider_crank(&mut draw, unit),
        1 => crank(&mut draw, unit),
        2 => four_bar(&mut draw, unit),
        3 => parallelogram(&mut draw, unit),
        4 => chain(&mut draw, unit),
        5 => spheres(&mut draw, unit),
        6 => bead(&mut draw, unit),
        7 => weld(&mut draw, unit),
        8 => motor(&mut draw, unit),
        9 => ring(&mut draw, unit),
        10 => balls(&mut draw, unit),
        11 => linear(&mut draw, unit),
        _ => levers(&mut draw, unit),
    }
}

/// A slider-crank by points, at and near its dead centre, or pulled out of reach.
fn slider_crank(draw: &mut Draw, unit: f64) -> Mechanism {
    let (pin, slider) = ((1, [0.5 * unit, 0.0]), (0, [2.5 * unit, 0.0]));
    // DOF 0 is the slider, 1 and 2 are the pin, 3 is across the guide.
    let slider_and_guide = (3, [slider.1[0], 0.0]);
    let items = vec![
        Item::Linear(vec![(4, 1.0)], 0.0),
        Item::Linear(vec![(3, 1.0), (0, -1.0)], 0.0),
        Item::Arm(pin, [0.0; 2], None),
        Item::Rod([pin, slider_and_guide], None),
    ];
    let side = unit * draw.of(&[0.0, 0.0, 1e-60, 1e-12, 1e-8, -1e-6, 1e-3]);
    let by = -unit * draw.of(&[1e-12, 1e-6, 0.0357, 0.3, 0.9, -1e-3]);
    Mechanism { items, start: vec![0.0, 0.0, side, 0.0, 0.0], held: vec![(0, by)] }
}

/// The same slider-crank by its angle.
fn crank(draw: &mut Draw, unit: f64) -> Mechanism {
    let items = vec![Item::Crank([1, 0], [0.5 * unit, 2.0 * unit])];
    let angle = draw.of(&[0.0, 0.0, 1e-60, 1e-10, -1e-6, 1e-3, 0.4]);
    let by = -unit * draw.of(&[1e-12, 1e-6, 0.0357, 0.3, 0.9, -1e-3]);
    Mechanism { items, start: vec![0.0, angle], held: vec![(0, by)] }
}

/// Driven by small and large motions, also out of reach.
fn four_bar(draw: &mut Draw, unit: f64) -> Mechanism {
    let by = draw.of(&[0.0, 0.05, 0.4, 0.9, 3.0]) * draw.next();
    let [p, q] = [(0, [0.1 * draw.next() * unit, unit]), (2, [2.0 * unit, (1.4 + 0.2 * draw.next()) * unit])];
    let items = vec![Item::Arm(p, [0.0; 2], None), Item::Arm(q, [2.0 * unit, 0.0], None), Item::Rod([p, q], None)];
    let off = unit * draw.of(&[0.0, 1e-6, 0.05]);
    Mechanism { items, start: draw.some(4, off), held: vec![(0, by * unit)] }
}

/// With a redundant arm, which is sometimes too long.
fn parallelogram(draw: &mut Draw, unit: f64) -> Mechanism {
    let top = |i: usize| (2 * i, [i as f64 * unit, unit]);
    let factor = draw.of(&[1.0, 1.0, 1.0, 1.1]);
    let mut items: Vec<Item> =
        (0..2).map(|k| Item::Linear(vec![(2 + k, 1.0), (k, -0.5), (4 + k, -0.5)], 0.0)).collect();
    for i in 0..3 {
        let radius = if i == 2 { factor * unit } else { unit };
        items.push(Item::Arm(top(i), [i as f64 * unit, 0.0], Some(radius)));
    }
    items.push(Item::Rod([top(0), top(2)], None));
    let off = unit * draw.of(&[0.0, 1e-4, 0.05]);
    Mechanism { items, start: draw.some(6, off), held: vec![(0, 0.4 * draw.next() * unit)] }
}

/// Rods between two supports, sometimes straight or too short.
fn chain(draw: &mut Draw, unit: f64) -> Mechanism {
    let count = draw.of(&[2, 4, 9]);
    let bend = draw.of(&[0.0, 0.3, 0.6]);
    let at = |i: usize, draw: &mut Draw| (2 * i, [i as f64 * unit, bend * draw.next() * unit]);
    let nodes: Vec<_> = (0..count).map(|i| at(i, draw)).collect();
    let length = draw.of(&[None, None, Some(0.93 * unit), Some(1.3 * unit)]);
    let mut items: Vec<Item> = nodes.windows(2).map(|ends| Item::Rod([ends[0], ends[1]], length)).collect();
    let end = [(count as f64) * unit, 0.0];
    items.insert(0, Item::Arm(nodes[count - 1], end, None));
    let off = unit * draw.of(&[0.0, 1e-5, 0.1]);
    Mechanism { items, start: draw.some(2 * count, off), held: vec![(0, 0.2 * draw.next() * unit), (1, 0.0)] }
}

/// A point on two or three spheres, which may not intersect.
fn spheres(draw: &mut Draw, unit: f64) -> Mechanism {
    let (at, seed) = (scale(unit, direction(draw.0)), draw.0);
    let off = draw.of(&[0.0, 0.2, 1.5]);
    let ball = |k: usize, draw: &mut Draw| {
        let centre = scale(1.5 * unit, direction(seed + k));
        Item::Ball((0, at), centre, norm(sub(at, centre)) * (1.0 + off * 0.3 * draw.next()))
    };
    let items = (0..draw.of(&[1, 2, 2])).map(|k| ball(k, draw)).collect();
    Mechanism { items, start: draw.some(3, 0.3 * unit), held: vec![(0, 0.1 * draw.next() * unit)] }
}

/// A node on the line through two others, which turns far.
fn bead(draw: &mut Draw, unit: f64) -> Mechanism {
    let [a, b] = [direction(draw.0), direction(draw.0 + 1)].map(|d| scale(unit, d));
    let p = scale(unit, add(a.map(|x| x / unit), direction(draw.0 + 2)));
    let mut items = vec![Item::Bead([(0, p), (3, a), (6, b)])];
    if draw.next() > 0.0 {
        items.insert(0, Item::Equal([4, 7]));
    }
    let far = draw.of(&[0.1, 1.0, 2.0]);
    Mechanism { items, start: draw.some(9, far * unit), held: vec![(0, 0.3 * draw.next() * unit)] }
}

/// A body at rest on the ground, starting up to half a turn away; DOF 0 is unused.
fn weld(draw: &mut Draw, unit: f64) -> Mechanism {
    let at = scale(unit, direction(draw.0));
    let mut items = vec![Item::Linear(vec![(0, 1.0), (1, 1.0)], 0.1 * unit), Item::Weld((2, at))];
    if draw.next() > 0.0 {
        items.push(Item::Weld((2, at)));
    }
    let turn = draw.of(&[0.1, 1.0, 1.7]);
    let mut start = draw.some(5, unit);
    start.extend(draw.some(3, turn));
    Mechanism { items, start, held: vec![(0, 0.3 * draw.next() * unit)] }
}

/// A wheel on its hinge, turned by a motor by up to half a turn.
fn motor(draw: &mut Draw, unit: f64) -> Mechanism {
    let (at, axis) = (scale(unit, direction(draw.0)), direction(draw.0 + 5));
    let body = (2, at);
    let angle = 3.0 * draw.next();
    let items =
        vec![Item::Linear(vec![(0, 1.0), (1, -2.0)], 0.0), Item::Hinge(body, axis), Item::Motor(body, axis, angle)];
    let off = draw.of(&[0.0, 0.2, 1.5]);
    let mut start = draw.some(5, off * unit);
    start.extend(draw.some(3, off));
    Mechanism { items, start, held: vec![(0, 0.3 * draw.next() * unit)] }
}

/// Linear and closed, sometimes with a gap.
fn ring(draw: &mut Draw, unit: f64) -> Mechanism {
    let gap = unit * draw.of(&[0.0, 0.0, 0.25]);
    let items = vec![
        Item::Linear(vec![(3, 1.0), (1, -1.0)], gap),
        Item::Linear(vec![(3, 3.0), (0, -1.0 / 3.0), (4, 0.7)], 0.1 * unit),
        Item::Equal([1, 2]),
        Item::Equal([2, 3]),
    ];
    Mechanism { items, start: draw.some(5, unit), held: vec![(0, draw.next() * unit)] }
}

/// A point between two spheres that touch, or almost do: G loses rank there.
fn balls(draw: &mut Draw, unit: f64) -> Mechanism {
    let gap = draw.of(&[0.0, 1e-9, -1e-3, -0.1, 0.1]);
    let at = |x: f64| [0.0, x * unit, 0.0];
    let items = vec![
        Item::Ball((1, [0.0; 3]), at(-1.0), unit),
        Item::Ball((1, [0.0; 3]), at(1.0 + gap), unit),
        Item::Linear(vec![(1, 1.0), (0, -1.0)], 0.0),
    ];
    let off = unit * draw.of(&[0.0, 1e-8, 0.1]);
    Mechanism { items, start: draw.some(4, off), held: vec![(0, 0.0)] }
}

/// Linear rows with coefficients of many sizes; some rows depend on others exactly or nearly.
fn linear(draw: &mut Draw, unit: f64) -> Mechanism {
    let dofs = 8;
    let row =
        |draw: &mut Draw| (0..dofs).map(|j| (j, draw.next() * 10_f64.powf(3.0 * draw.next()))).collect::<Vec<_>>();
    let mut rows: Vec<Vec<(usize, f64)>> = (0..5).map(|_| row(draw)).collect();
    let near = draw.of(&[0.0, 1e-12, 1e-6, 1e-3]);
    rows.push((0..dofs).map(|j| (j, rows[0][j].1 - 0.3 * rows[1][j].1 + near * draw.next())).collect());
    let items = rows.into_iter().map(|row| Item::Linear(row, 0.0)).collect();
    Mechanism { items, start: draw.some(dofs, unit), held: vec![(0, draw.next() * unit)] }
}

/// Levers between lengths and a body that turns: columns of many sizes, connected by linear rows.
fn levers(draw: &mut Draw, unit: f64) -> Mechanism {
    let mut items: Vec<Item> =
        (1..6).map(|j| Item::Linear(vec![(j, 1.0), (j - 1, (1.0 + draw.next()) * 0.3 + 0.1)], 0.0)).collect();
    let node = (4, [unit, 0.3 * unit]);
    items.push(Item::Arm(node, [0.2 * unit, -unit], None));
    Mechanism { items, start: draw.some(6, 0.1 * unit), held: vec![(0, 0.02 * draw.next() * unit)] }
}

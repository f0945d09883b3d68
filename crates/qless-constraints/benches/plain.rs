//! c, G and H compared with a hand-written loop of the same formulas: `cargo bench -p qless-constraints --bench plain` (`-- --test` for a
//! small size).
//!
//! Three programs take turns in one process: a loop that knows its constraints in advance (compressed rows for linear equations, an array of
//! rods and one of spheres, known positions in H), the set with one thread, and the set with two. Limits: at most 1.1 times the loop, and at
//! least 1.7 times as fast with two threads. Medians of many rounds; the load of the machine is printed, since other programs take the second
//! core first.

mod model;

use std::hint::black_box;
use std::time::Instant;

use qless::Csr;
use qless_constraints::{ConstraintSet, Evaluation};
use rayon::{ThreadPool, ThreadPoolBuilder};

use model::{equal, linear, point, rod, small, sphere, tie};

const ROUNDS: usize = 41;
/// In 100 constraints: 20 rods and 6 spheres; the others are linear equations.
const MIX: [(usize, model::Add); 6] = [(20, rod), (6, sphere), (30, linear), (25, equal), (12, tie), (7, small)];
const RODS: [(usize, model::Add); 1] = [(100, rod)];
const LINEAR: [(usize, model::Add); 1] = [(100, linear)];

fn main() {
    let short = std::env::args().any(|argument| argument == "--test");
    let constraints = if short { 10_000 } else { 1_000_000 };
    println!("load before: {}", load());
    println!(
        "medians of {ROUNDS} rounds; plain, one thread, two threads in ms; ratios to plain, and of two threads to one"
    );
    for (name, shares, rods, spheres) in
        [("mixed", MIX.as_slice(), 20, 6), ("rods", &RODS, 100, 0), ("linear equations", &LINEAR, 0, 0)]
    {
        measure(name, constraints, shares, (rods, spheres));
    }
    println!("load after: {}", load());
}

fn load() -> String {
    std::fs::read_to_string("/proc/loadavg").unwrap_or_else(|_| "not known".into()).trim().into()
}

/// Kind and nodes of constraint i.
fn lot(i: usize) -> (usize, usize) {
    (i * 37 % 100, i / 2)
}

fn build(constraints: usize, shares: &[(usize, model::Add)]) -> ConstraintSet {
    let nodes = nodes(constraints);
    let mut builder = ConstraintSet::builder(3 * nodes);
    for i in 0..constraints {
        let (mut lot, node) = lot(i);
        for &(share, add) in shares {
            if lot < share {
                add(&mut builder, node, nodes);
                break;
            }
            lot -= share;
        }
    }
    builder.build().expect("few DOFs")
}

fn nodes(constraints: usize) -> usize {
    constraints / 2 + 200
}

struct Rod {
    dofs: [u32; 6],
    between: [f64; 3],
    length: f64,
    /// Positions in H: `aa, ab, ba, bb` for each axis.
    places: [u32; 12],
}

struct Sphere {
    dofs: [u32; 3],
    from: [f64; 3],
    radius: f64,
    places: [u32; 3],
}

/// The data of the hand-written loop.
struct Plain {
    linear: usize,
    start: Vec<usize>,
    col: Vec<u32>,
    val: Vec<f64>,
    rhs: Vec<f64>,
    rods: Vec<Rod>,
    spheres: Vec<Sphere>,
    c: Vec<f64>,
    g: Vec<f64>,
    h: Vec<f64>,
}

impl Plain {
    /// For constraints whose first kinds are rods and spheres.
    fn new(constraints: usize, set: &ConstraintSet, (rods, spheres): (usize, usize)) -> Self {
        let mut at_rest = set.allocate();
        let (rest, weights) = (vec![0.0; set.dofs()], vec![0.0; set.equations()]);
        set.evaluate(&rest, &mut at_rest).expect("of this set");
        set.effective_hessian(&rest, &weights, &mut at_rest).expect("of this set");
        let (linear, g, h) = (set.linear_rows().len(), at_rest.g(), at_rest.h());
        let nnz = g.starts()[linear];
        let mut plain = Self {
            linear,
            start: g.starts()[..=linear].to_vec(),
            col: g.columns()[..nnz].to_vec(),
            val: g.values()[..nnz].to_vec(),
            rhs: at_rest.c()[..linear].iter().map(|c| -c).collect(),
            rods: Vec::new(),
            spheres: Vec::new(),
            c: vec![0.0; set.equations()],
            g: g.values().to_vec(),
            h: vec![0.0; h.nnz()],
        };
        for (lot, node) in (0..constraints).map(lot) {
            if lot < rods {
                plain.rods.push(of_rod(node, nodes(constraints), h));
            } else if lot < rods + spheres {
                plain.spheres.push(of_sphere(node, h));
            }
        }
        plain
    }

    fn values(&mut self, u: &[f64]) {
        for row in 0..self.linear {
            let terms = self.start[row]..self.start[row + 1];
            let mut sum = 0.0;
            for (v, &j) in self.val[terms.clone()].iter().zip(&self.col[terms]) {
                sum += v * u[j as usize];
            }
            self.c[row] = sum - self.rhs[row];
        }
        let (rods, spheres) = (self.rods.len(), self.spheres.len());
        let (c, g) = (&mut self.c[self.linear..], &mut self.g[self.start[self.linear]..]);
        let (c_rods, c) = c.split_at_mut(rods);
        let (g_rods, g) = g.split_at_mut(6 * rods);
        for ((rod, c), g) in self.rods.iter().zip(c_rods).zip(g_rods.as_chunks_mut::<6>().0) {
            let (mut square, scale) = (0.0, 1.0 / rod.length);
            for k in 0..3 {
                let d = rod.between[k] + u[rod.dofs[3 + k] as usize] - u[rod.dofs[k] as usize];
                square += d * d;
                g[3 + k] = d * scale;
                g[k] = -g[3 + k];
            }
            *c = (square - rod.length * rod.length) * 0.5 * scale;
        }
        for ((sphere, c), g) in self.spheres.iter().zip(&mut c[..spheres]).zip(g.as_chunks_mut::<3>().0) {
            let (mut square, scale) = (0.0, 1.0 / sphere.radius);
            for k in 0..3 {
                let x = sphere.from[k] + u[sphere.dofs[k] as usize];
                square += x * x;
                g[k] = x * scale;
            }
            *c = (square - sphere.radius * sphere.radius) * 0.5 * scale;
        }
    }

    fn hessian(&mut self, w: &[f64]) {
        self.h.fill(0.0);
        let w = &w[self.linear..];
        for (rod, w) in self.rods.iter().zip(w) {
            let value = w / rod.length;
            for [aa, ab, ba, bb] in rod.places.as_chunks::<4>().0 {
                self.h[*aa as usize] += value;
                self.h[*ab as usize] -= value;
                self.h[*ba as usize] -= value;
                self.h[*bb as usize] += value;
            }
        }
        for (sphere, w) in self.spheres.iter().zip(&w[self.rods.len()..]) {
            let value = w / sphere.radius;
            sphere.places.iter().for_each(|&place| self.h[place as usize] += value);
        }
    }
}

fn of_rod(i: usize, nodes: usize, h: &Csr) -> Rod {
    let (a, b) = (point(i), point((i + [1, 100, 101, 99][i % 4]) % nodes));
    let mut places = [0; 12];
    for k in 0..3 {
        let all = [(a, a), (a, b), (b, a), (b, b)].map(|(row, col)| place(h, row.dofs[k], col.dofs[k]));
        places[4 * k..4 * k + 4].copy_from_slice(&all);
    }
    let dof = |k: usize| if k < 3 { a.dofs[k] } else { b.dofs[k - 3] } as u32;
    Rod { dofs: std::array::from_fn(dof), between: std::array::from_fn(|k| b.at[k] - a.at[k]), length: 1.0, places }
}

fn of_sphere(i: usize, h: &Csr) -> Sphere {
    let node = point(i);
    Sphere {
        dofs: node.dofs.map(|dof| dof as u32),
        from: node.at.map(|x| x + 1.0),
        radius: 2.0,
        places: node.dofs.map(|dof| place(h, dof, dof)),
    }
}

fn place(h: &Csr, row: usize, col: usize) -> u32 {
    let inside = h.starts()[row]..h.starts()[row + 1];
    (h.starts()[row] + h.columns()[inside].partition_point(|&j| (j as usize) < col)) as u32
}

fn measure(name: &str, constraints: usize, shares: &[(usize, model::Add)], kinds: (usize, usize)) {
    let set = build(constraints, shares);
    let u: Vec<f64> = (0..set.dofs()).map(|j| 1e-3 * (j % 17) as f64).collect();
    let w: Vec<f64> = (0..set.equations()).map(|i| (i % 5) as f64).collect();
    let mut plain = Plain::new(constraints, &set, kinds);
    let mut evaluation = set.allocate();
    let pools = [1, 2].map(|threads| ThreadPoolBuilder::new().num_threads(threads).build().expect("threads"));
    let mut times: [[Vec<f64>; 3]; 2] = Default::default();
    for _ in 0..ROUNDS {
        times[0][0].push(milliseconds(|| plain.values(&u)));
        times[1][0].push(milliseconds(|| plain.hessian(&w)));
        for (k, pool) in pools.iter().enumerate() {
            let [values, hessian] = of_set(pool, &set, (&u, &w), &mut evaluation);
            times[0][k + 1].push(values);
            times[1][k + 1].push(hessian);
        }
        black_box((&plain.c, &plain.g, &plain.h));
    }
    same(plain.c.as_slice(), evaluation.c());
    same(plain.g.as_slice(), evaluation.g().values());
    same(plain.h.as_slice(), evaluation.h().values());
    for (what, times) in ["c and G", "H"].into_iter().zip(times) {
        let [plain, one, two] = times.map(median);
        print!("{name:>20} {what:>8}: {plain:>8.2} {one:>8.2} {two:>8.2}");
        println!("  {:>5.2} of plain, {:>5.2} times as fast with two", one / plain, one / two);
    }
}

fn of_set(pool: &ThreadPool, set: &ConstraintSet, (u, w): (&[f64], &[f64]), evaluation: &mut Evaluation) -> [f64; 2] {
    pool.install(|| {
        let values = milliseconds(|| set.evaluate(u, evaluation).expect("of this set"));
        [values, milliseconds(|| set.effective_hessian(u, w, evaluation).expect("of this set"))]
    })
}

/// Checks equality up to rounding, since sums may be in another order.
fn same(plain: &[f64], set: &[f64]) {
    assert_eq!(plain.len(), set.len());
    let size = plain.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    assert!(plain.iter().zip(set).all(|(a, b)| (a - b).abs() <= 1e-13 * size), "other numbers than the plain loop");
}

fn milliseconds(work: impl FnOnce()) -> f64 {
    let start = Instant::now();
    work();
    1e3 * start.elapsed().as_secs_f64()
}

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

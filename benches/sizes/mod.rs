//! The paper's tie model in sizes from 3e4 to 3e6 equations, and the work for each.

use qless::{ConstraintSystem, Csr, Options, analyse};
use qless_scenes::fssi::{self, Mesh};

const SIZES: [usize; 5] = [30_000, 100_000, 300_000, 1_000_000, 3_000_000];

/// Approximate numbers of equations; the two smallest with `--test`.
pub fn sizes() -> &'static [usize] {
    let short = std::env::args().any(|argument| argument == "--test");
    if short { &SIZES[..2] } else { &SIZES }
}

/// Renumbers the DOFs of a system.
pub type Order = fn(&ConstraintSystem) -> ConstraintSystem;

/// Two numberings: in the order of the equations, as by a mesh generator, and at random, as in the scene.
pub const ORDERS: [(&str, Order); 2] = [("as named", by_appearance), ("random", Clone::clone)];

pub fn system(size: usize, order: Order) -> ConstraintSystem {
    order(&fssi::tie(&Mesh::with_equations(size), 1).expect("a scene").system)
}

/// The same equations with DOFs in the order in which they are named.
fn by_appearance(system: &ConstraintSystem) -> ConstraintSystem {
    let mut number = vec![usize::MAX; system.dofs()];
    let mut count = 0;
    let mut numbered = |j: usize| {
        if number[j] == usize::MAX {
            number[j] = count;
            count += 1;
        }
        number[j]
    };
    let mut matrix = Csr::empty(system.dofs());
    for i in 0..system.equations() {
        let mut row: Vec<_> = system.matrix().row(i).map(|(j, v)| (numbered(j), v)).collect();
        row.sort_unstable_by_key(|&(j, _)| j);
        matrix.push_row(row).expect("ascending");
    }
    let prescribed: Vec<_> = system.prescribed().iter().map(|&(j, value)| (numbered(j), value)).collect();
    ConstraintSystem::from_csr(&matrix, system.rhs(), &prescribed).expect("the same system")
}

/// Rank, named redundancies, T, G and g.
pub fn whole(system: &ConstraintSystem) -> usize {
    let analysis = analyse(system, &Options::default()).expect("a valid system");
    let named: usize =
        analysis.dependent().iter().map(|d| analysis.because(d.row).expect("one of its rows").len()).sum();
    let reduction = analysis.reduction().expect("within the gate");
    assert!(reduction.growth() <= 1.0, "growth {}", reduction.growth());
    named + reduction.t().nnz()
}

/// Exponent p of `y = a x^p` by least squares of logarithms.
pub fn exponent(points: impl Iterator<Item = (f64, f64)>) -> f64 {
    let points: Vec<_> = points.map(|(x, y)| (x.ln(), y.ln())).collect();
    let n = points.len() as f64;
    let mean = points.iter().fold((0.0, 0.0), |a, p| (a.0 + p.0 / n, a.1 + p.1 / n));
    let (above, below) = points.iter().fold((0.0, 0.0), |a, p| {
        let dx = p.0 - mean.0;
        (a.0 + dx * (p.1 - mean.1), a.1 + dx * dx)
    });
    above / below
}

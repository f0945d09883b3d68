//! A periodic cell of two blocks whose meshes do not match, tied, around a rigid inclusion, under a mean displacement gradient; nodes,
//! hexahedra and equations are spread over the ranks of an MPI job. Solved by conjugate gradients, checked against one rank.
//!
//! `mpirun -n RANKS mpi-elasticity`

mod cell;
mod check;
mod constraints;
mod hexahedron;
mod solve;

use std::error::Error;

use cell::{Block, Cell};
use check::{check, largest, same_as_alone};
use constraints::Gradient;
use qless_mpi::{Alone, Ranks, World};
use solve::Model;

const STEPS: usize = 4;
/// At the last step.
const STRETCH: Gradient = [[0.02, 0.01, 0.0], [0.0, -0.01, 0.005], [0.003, 0.0, 0.015]];

/// Every other node of the upper face coincides with one of the lower face: only then do node ties transmit a constant stress exactly.
const PLAIN: Cell =
    Cell { blocks: [Block { cells: [4, 3, 3], young: 1.0 }, Block { cells: [8, 6, 2], young: 1.0 }], inclusion: None };
/// The meshes meet in every third or second node; the inclusion ends there.
const WITH_INCLUSION: Cell = Cell {
    blocks: [Block { cells: [8, 6, 4], young: 1.0 }, Block { cells: [12, 9, 6], young: 3.0 }],
    inclusion: Some([[0.25, 1.0 / 3.0, 0.25], [0.75, 2.0 / 3.0, 0.75]]),
};

/// The cell at the last step.
struct Solved {
    /// On the DOFs that the rank owns.
    u: Vec<f64>,
    stress: Gradient,
    redundant: u64,
    equations: u64,
    iterations: usize,
    /// The largest `|C u - b|` of this rank's equations at any step.
    unmet: f64,
}

fn main() -> Result<(), Box<dyn Error>> {
    let world = World::start()?;
    for (name, cell) in [("plain", PLAIN), ("with an inclusion", WITH_INCLUSION)] {
        let solved = solve(&cell, &world)?;
        report(&world, name, &cell, &solved);
        checks(&world, &cell, &solved)?;
    }
    Ok(())
}

/// Stretched step by step. Collective.
fn solve(cell: &Cell, ranks: &dyn Ranks) -> Result<Solved, Box<dyn Error>> {
    let mut model = Model::new(cell, ranks)?;
    let counts = model.map.analysis().counts();
    let mut u_q = vec![0.0; model.map.masters().len()];
    let (mut u, mut unmet, mut iterations) = (Vec::new(), 0.0_f64, 0);
    for step in 1..=STEPS {
        let e = STRETCH.map(|row| row.map(|value| value * step as f64 / STEPS as f64));
        model.stretch(&e)?;
        iterations += model.solve(&mut u_q)?;
        u = model.expanded(&u_q);
        unmet = unmet.max(model.constraints.unmet(&model.map, &u, &e));
    }
    let stress = model.mean_stress(&u)?;
    let owned = cell.owned_dofs(ranks.rank(), ranks.size());
    let own = model.map.dofs().iter().zip(&u).filter(|(dof, _)| owned.contains(dof)).map(|(_, &u)| u).collect();
    Ok(Solved { u: own, stress, redundant: counts.redundant, equations: counts.equations, iterations, unmet })
}

/// The checks. Collective: the same result on all ranks.
fn checks(ranks: &dyn Ranks, cell: &Cell, solved: &Solved) -> Result<(), Box<dyn Error>> {
    let Solved { stress, .. } = solved;
    let counted = solved.redundant as f64 - cell.redundant() as f64;
    check(ranks, "redundant equations, counted by hand", counted, 0.0)?;
    check(ranks, "C u = b of every equation", solved.unmet, 1e-10)?;
    check(ranks, "a symmetric mean stress", largest(stress, &transposed(stress)), 1e-9)?;
    if cell.inclusion.is_none() {
        let exact = hexahedron::stress(cell.blocks[0].young, &STRETCH);
        check(ranks, "the stress of a homogeneous body", largest(stress, &exact), 1e-9)?;
    }
    // The other ranks wait for rank 0, so it must send its result before it returns.
    let alone = (ranks.rank() == 0).then(|| solve(cell, &Alone).expect("one rank solves what many have solved"));
    let off = same_as_alone(ranks, &solved.u, alone.as_ref().map(|alone| &alone.u[..]));
    check(ranks, "u of one rank", off, 1e-9)?;
    let off = alone.map_or(0.0, |alone| largest(stress, &alone.stress));
    check(ranks, "the mean stress of one rank", off, 1e-9)
}

fn transposed(e: &Gradient) -> Gradient {
    std::array::from_fn(|i| std::array::from_fn(|j| e[j][i]))
}

fn report(ranks: &dyn Ranks, name: &str, cell: &Cell, solved: &Solved) {
    if ranks.rank() == 0 {
        let Solved { redundant, equations, iterations, stress, .. } = solved;
        println!(
            "{name}, {} ranks: {} DOFs, {redundant} of {equations} equations redundant",
            ranks.size(),
            cell.dofs()
        );
        println!("  {iterations} iterations in {STEPS} steps, mean stress {stress:.9?}");
    }
}

//! Heat conduction by gemlab with Hex20, solved by UMFPACK through russell_sparse: two blocks whose meshes do not match are tied, the
//! lower one is periodic, the top isothermal, and the bottom heated over 20 implicit time steps while the conductivity grows. Each
//! step is checked against Lagrange multipliers.
//!
//! `gemlab-heat [CELLS]` runs and checks.

mod model;

use std::error::Error;

use gemlab::integ::{self, CommonArgs, Gauss};
use gemlab::mesh::Mesh;
use gemlab::shapes::GeoKind;
use lagrange::{Lagrange, agree};
use qless::{Elimination, Options};
use qless::elimination::{PrescribedDofs, Storage, View};
use russell_lab::{Matrix, Vector};
use russell_sparse::prelude::{CooMatrix, CscMatrix, LinSolTrait, SolverUMFPACK, Sym};

const STEPS: usize = 20;
/// The time of a step.
const DT: f64 = 1.0 / STEPS as f64;

fn main() -> Result<(), Box<dyn Error>> {
    let cells = std::env::args().nth(1).map_or(Ok(2), |word| word.parse())?;
    let mesh = model::two_blocks(cells)?;
    let (system, n) = (model::constraints(&mesh)?, mesh.points.len());
    let mut map = Elimination::new(&system, &Options::default())?;
    println!("{map:?}: {} of {} equations redundant", map.analysis().expect("made from equations").dependent().len(), map.kinds().len());

    // Capacity and conductivity have one pattern: gemlab's columns, counted from 0 in i32.
    let (m, k) = (assembled(&mesh, capacity)?, assembled(&mesh, conductivity)?);
    let columns = View::columns(m.get_col_pointers(), m.get_row_indices());
    let condensed = map.condensed(columns, PrescribedDofs::Eliminated)?;
    let (q, nnz) = (condensed.unknowns(), condensed.nnz());
    let (mut a_q, mut m_q, mut k_q) = (vec![0.0; nnz], vec![0.0; nnz], vec![0.0; nnz]);
    condensed.condense_matrix_into(&map, m.get_values(), &mut m_q)?;
    condensed.condense_matrix_into(&map, k.get_values(), &mut k_q)?;
    // The same by elements, of which no matrix is assembled.
    let dofs = |e: usize| mesh.cells[e].points.as_slice();
    let scattered = map.condensed_for_elements(mesh.cells.len(), dofs, Storage::Full, PrescribedDofs::Eliminated)?;
    let (mut a_e, mut f_e) = (vec![0.0; scattered.nnz()], vec![0.0; q]);

    // UMFPACK's side: triplets whose values are written anew in each step.
    let (rows, others) = condensed.entries().map(|(i, j)| (i as i32, j as i32)).unzip();
    let mut a_umfpack = CooMatrix::from(q, q, rows, others, vec![0.0; nnz], Sym::YesFull)?;
    let mut umfpack = SolverUMFPACK::new()?;
    let (mut f_q, mut u_q, mut u) = (Vector::new(q), Vector::new(q), vec![0.0; n]);

    for step in 1..=STEPS {
        let t = step as f64 * DT;
        let (rhs, growth) = (|equation: usize| t * system.rhs()[equation], 1.0 + t);
        map.update_with(rhs, |dof| t * model::heated(&mesh, dof))?;

        let a: Vec<f64> = m.get_values().iter().zip(k.get_values()).map(|(m, k)| m / DT + growth * k).collect();
        let mut f = Vector::new(n);
        m.mat_vec_mul(&mut f, 1.0 / DT, &Vector::from(&u))?;
        let f: Vec<f64> = f.as_data().iter().map(|of_old| of_old + 0.01).collect();
        condensed.condense_into(&map, &a, &f, &mut a_q, f_q.as_mut_data())?;
        a_umfpack.get_values_mut().copy_from_slice(&a_q);
        umfpack.preprocess(&a_umfpack, None)?;
        umfpack.solve(&mut u_q, &f_q, false)?;
        map.expand_into(u_q.as_data(), &mut u)?;

        let entries = || {
            (0..n).flat_map(|j| (m.get_col_pointers()[j]..m.get_col_pointers()[j + 1]).map(move |e| (e as usize, j)))
        };
        let mut residual = f.clone();
        entries().for_each(|(e, j)| residual[m.get_row_indices()[e] as usize] -= a[e] * u[j]);
        let multipliers = map.multipliers(&residual)?;
        let reactions = map.reactions(&residual, &multipliers)?;

        let sums: Vec<f64> = m_q.iter().zip(&k_q).map(|(m, k)| m / DT + growth * k).collect();
        scattered.assemble(&map, mesh.cells.len(), dofs, &mut a_e, &mut f_e, |e, matrix, _| {
            let [m, k] =
                [capacity, conductivity].map(|of| of(&mesh, e).expect("the cell is sound: it was assembled above"));
            let both = m.as_data().iter().zip(k.as_data());
            matrix.iter_mut().zip(both).for_each(|(a, (m, k))| *a = m / DT + growth * k);
        })?;

        let entries = entries().map(|(e, j)| (m.get_row_indices()[e] as usize, j, a[e]));
        let expected = Lagrange::new(&map, entries)?.solve(&f, rhs, map.prescribed_values());
        let checks = [
            agree("u", &u, &expected.u)?,
            agree("multipliers", &multipliers, &expected.multipliers)?,
            agree("reactions", &reactions, &expected.reactions)?,
            agree("M_q / dt + K_q", &sums, &a_q)?,
            agree("A_q by elements", &a_e, &a_q)?,
        ];
        println!("step {step:2}: u, multipliers and reactions agree to {:.0e}", checks.into_iter().fold(0.0, f64::max));
    }
    Ok(())
}

/// The sum over cells, by columns.
fn assembled(mesh: &Mesh, of: fn(&Mesh, usize) -> Result<Matrix, &'static str>) -> Result<CscMatrix, &'static str> {
    let (n, most) = (mesh.points.len(), mesh.cells.iter().map(|cell| cell.points.len().pow(2)).sum());
    let mut sum = CooMatrix::new(n, n, most, Sym::YesFull)?;
    for (e, cell) in mesh.cells.iter().enumerate() {
        let matrix = of(mesh, e)?;
        for (a, &i) in cell.points.iter().enumerate() {
            cell.points.iter().enumerate().try_for_each(|(b, &j)| sum.put(i, j, matrix.get(a, b)))?;
        }
    }
    CscMatrix::from_coo(&sum)
}

fn capacity(mesh: &Mesh, e: usize) -> Result<Matrix, &'static str> {
    let (mut pad, gauss, mut m) = (mesh.get_pad(e), Gauss::new(GeoKind::Hex20), Matrix::new(20, 20));
    integ::mat_01_nsn(&mut m, &mut CommonArgs::new(&mut pad, &gauss), |_, _, _| Ok(0.3))?;
    Ok(m)
}

/// Twice as high along the blocks as across them.
fn conductivity(mesh: &Mesh, e: usize) -> Result<Matrix, &'static str> {
    let (mut pad, gauss, mut k) = (mesh.get_pad(e), Gauss::new(GeoKind::Hex20), Matrix::new(20, 20));
    integ::mat_03_btb::<6, _>(&mut k, &mut CommonArgs::new(&mut pad, &gauss), |tensor, _, _, _| {
        [1.0, 1.0, 2.0, 0.0, 0.0, 0.0].iter().enumerate().for_each(|(m, &v)| tensor.set(m, v));
        Ok(())
    })?;
    Ok(k)
}

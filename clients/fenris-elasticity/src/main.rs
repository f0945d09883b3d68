//! Elasticity by fenris: two blocks whose meshes do not match are tied, the upper end is rigid, the lower block periodic; all of it
//! is driven over 20 time steps while the material softens. Each step is checked against Lagrange multipliers.
//!
//! `fenris-elasticity [CELLS]` runs and checks; `fenris-elasticity measure CELLS` measures.

mod measure;
mod model;

use faer::prelude::Solve;
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Mat, Side};
use fenris::assembly::global::CsrAssembler;
use fenris::assembly::local::{ElementConnectivityAssembler, ElementMatrixAssembler};
use fenris::nalgebra::{DMatrixViewMut, DVector};
use fenris::nalgebra_sparse::CsrMatrix;
use fenris::quadrature::CanonicalStiffnessQuadrature;
use fenris_solid::MaterialEllipticOperator;
use fenris_solid::materials::{LameParameters, LinearElasticMaterial, YoungPoisson};
use lagrange::{Lagrange, agree};
use model::RIGID;
use qless::{Elimination, Options};
use qless::elimination::{CondensedPattern, PrescribedDofs, Storage, View};

const STEPS: usize = 20;

fn main() -> eyre::Result<()> {
    let mut arguments = std::env::args().skip(1).peekable();
    let measures = arguments.next_if(|word| word == "measure").is_some();
    let cells = arguments.next().map_or(Ok(5), |word| word.parse())?;
    if measures { measure::measure(cells) } else { run(cells) }
}

fn run(cells: usize) -> eyre::Result<()> {
    let mesh = model::two_blocks(cells);
    let system = model::constraints(&mesh)?;
    let (known, n) = (3 * mesh.vertices().len(), system.dofs());
    let mut map = Elimination::new(&system, &Options::default())?;
    println!("{map:?}: {} of {} equations redundant", map.analysis().expect("made from equations").dependent().len(), map.kinds().len());

    // Both patterns once: for fenris' K, and for its elements, which need no K.
    let (material, none) = (MaterialEllipticOperator::new(&LinearElasticMaterial), DVector::zeros(known));
    let softened = |t: f64| {
        let lame = LameParameters::from(YoungPoisson { young: 1.0 - 0.5 * t, poisson: 0.3 });
        mesh.canonical_stiffness_quadrature().with_uniform_data(lame)
    };
    let pattern =
        CsrAssembler::<f64>::default().assemble_pattern(&model::stiffness(&mesh, &material, &softened(0.0), &none));
    let rows = View::rows(pattern.major_offsets(), pattern.minor_indices()).then_empty(RIGID);
    let condensed = map.condensed(rows, PrescribedDofs::Eliminated)?;
    let cell_dofs =
        |e: usize| mesh.connectivity()[e].0.iter().flat_map(|&i| [3 * i, 3 * i + 1, 3 * i + 2]).collect::<Vec<_>>();
    let count = mesh.connectivity().len();
    let scattered = map.condensed_for_elements(count, cell_dofs, Storage::Full, PrescribedDofs::Eliminated)?;
    let nnz = pattern.nnz();
    let mut k =
        CsrMatrix::try_from_pattern_and_values(pattern, vec![0.0; nnz]).map_err(|error| eyre::eyre!("{error}"))?;
    let (mut k_q, mut f_q, mut u) = (vec![0.0; condensed.nnz()], vec![0.0; condensed.unknowns()], vec![0.0; n]);
    let (mut k_e, mut f_e) = (vec![0.0; scattered.nnz()], vec![0.0; scattered.unknowns()]);
    let weight: Vec<f64> = (0..n).map(|dof| if dof < known && dof % 3 == 2 { -1e-3 } else { 0.0 }).collect();

    for step in 1..=STEPS {
        let t = step as f64 / STEPS as f64;
        let rhs = |equation: usize| t * system.rhs()[equation];
        map.update_with(
            rhs,
            |dof| if dof < known { 0.0 } else { [0.01, 0.0, -0.1 * t, 0.0, 0.0, 0.2][dof - known] * t },
        )?;

        let quadrature = softened(t);
        let elements = model::stiffness(&mesh, &material, &quadrature, &none);
        k.values_mut().fill(0.0);
        CsrAssembler::default().assemble_into_csr(&mut k, &elements)?;

        condensed.condense_into(&map, k.values(), &weight, &mut k_q, &mut f_q)?;
        map.expand_into(&solve(&condensed, &k_q, &f_q)?, &mut u)?;
        let residual = residual(&k, &u, &weight);
        let multipliers = map.multipliers(&residual)?;
        let reactions = map.reactions(&residual, &multipliers)?;

        let size = 3 * elements.element_node_count(0);
        scattered.assemble(&map, count, cell_dofs, &mut k_e, &mut f_e, |e, matrix, _| {
            // By columns, which of a symmetric matrix are its rows.
            let matrix = DMatrixViewMut::from_slice(matrix, size, size);
            elements.assemble_element_matrix_into(e, matrix).expect("the cell is sound: it was assembled above");
        })?;
        map.restrict_into(&weight, &mut f_q)?;
        f_e.iter_mut().zip(&f_q).for_each(|(own, weight)| *own += weight);
        let q: Vec<f64> = map.masters().iter().map(|&dof| u[dof]).collect();

        let entries = k.triplet_iter().map(|(i, j, &v)| (i, j, v));
        let expected =
            Lagrange::new(&map, entries).map_err(eyre::Report::msg)?.solve(&weight, rhs, map.prescribed_values());
        let checks = [
            agree("u", &u, &expected.u),
            agree("u by elements", &solve(&scattered, &k_e, &f_e)?, &q),
            agree("multipliers", &multipliers, &expected.multipliers),
            agree("reactions", &reactions, &expected.reactions),
        ];
        let off: Vec<f64> = checks.into_iter().collect::<Result<_, _>>().map_err(eyre::Report::msg)?;
        println!("step {step:2}: u, multipliers and reactions agree to {:.0e}", off.into_iter().fold(0.0, f64::max));
    }
    Ok(())
}

/// `u_q = K_q^-1 f_q` by faer's Cholesky, on the arrays as they are: the rows of a symmetric matrix are its columns.
fn solve(condensed: &CondensedPattern, k_q: &[f64], f_q: &[f64]) -> eyre::Result<Vec<f64>> {
    let q = condensed.unknowns();
    let pattern = SymbolicSparseColMatRef::new_checked(q, q, condensed.starts(), None, condensed.index());
    let factors =
        SparseColMatRef::new(pattern, k_q).sp_cholesky(Side::Lower).map_err(|error| eyre::eyre!("K_q: {error:?}"))?;
    let x = factors.solve(Mat::from_fn(q, 1, |i, _| f_q[i]));
    Ok(x.col(0).iter().copied().collect())
}

/// `f - K u`, over the DOFs of the rigid end too.
fn residual(k: &CsrMatrix<f64>, u: &[f64], f: &[f64]) -> Vec<f64> {
    let mut residual = f.to_vec();
    k.triplet_iter().for_each(|(i, j, v)| residual[i] -= v * u[j]);
    residual
}

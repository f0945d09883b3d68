//! fenris' own assembly of K beside its condensation, and beside the scatter of elements into the condensed matrix.

use std::time::Instant;

use fenris::assembly::global::{CsrAssembler, CsrParAssembler, color_nodes};
use fenris::assembly::local::ElementMatrixAssembler;
use fenris::nalgebra::{DMatrixViewMut, DVector};
use fenris::nalgebra_sparse::CsrMatrix;
use fenris::quadrature::CanonicalStiffnessQuadrature;
use fenris_solid::MaterialEllipticOperator;
use fenris_solid::materials::{LameParameters, LinearElasticMaterial};
use qless::{Elimination, Options};
use qless::elimination::{PrescribedDofs, Storage, View};

use crate::model::{self, RIGID};

const ROUNDS: usize = 5;

pub fn measure(cells: usize) -> eyre::Result<()> {
    let mesh = model::two_blocks(cells);
    let system = model::constraints(&mesh)?;
    let (map, of_map) = timed(|| Elimination::new(&system, &Options::default()));
    let (map, known) = (map?, 3 * mesh.vertices().len());
    let quadrature = mesh.canonical_stiffness_quadrature().with_uniform_data(LameParameters { mu: 0.4, lambda: 0.6 });
    let (operator, none) = (MaterialEllipticOperator::new(&LinearElasticMaterial), DVector::zeros(known));
    let elements = model::stiffness(&mesh, &operator, &quadrature, &none);
    let pattern = CsrAssembler::<f64>::default().assemble_pattern(&elements);
    let rows = View::rows(pattern.major_offsets(), pattern.minor_indices()).then_empty(RIGID);
    let (condensed, of_pattern) = timed(|| map.condensed(rows, PrescribedDofs::Eliminated));
    let condensed = condensed?;
    println!(
        "{} DOFs, {} entries of K; {map:?} in {of_map:.4} s, pattern of K_q in {of_pattern:.3} s",
        map.dofs(),
        pattern.nnz()
    );

    let nnz = pattern.nnz();
    let mut k =
        CsrMatrix::try_from_pattern_and_values(pattern, vec![0.0; nnz]).map_err(|error| eyre::eyre!("{error}"))?;
    let cell_dofs = |e: usize| -> [usize; 24] { std::array::from_fn(|i| 3 * mesh.connectivity()[e].0[i / 3] + i % 3) };
    let count = mesh.connectivity().len();
    let (colours, f) = (color_nodes(&mesh), vec![0.0; map.dofs()]);
    let (mut k_q, mut f_q) = (vec![0.0; condensed.nnz()], vec![0.0; condensed.unknowns()]);
    let scattered = map.condensed_for_elements(count, cell_dofs, Storage::Full, PrescribedDofs::Eliminated)?;
    for threads in [1, 2] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
        // The least of some rounds in alternation: whatever else runs on the machine only adds.
        let mut least = [f64::INFINITY; 3];
        for _ in 0..ROUNDS {
            k.values_mut().fill(0.0);
            let (done, assembly) = pool.install(|| {
                timed(|| match threads {
                    1 => CsrAssembler::default().assemble_into_csr(&mut k, &elements),
                    _ => CsrParAssembler::default().assemble_into_csr(&mut k, &colours, &elements),
                })
            });
            done?;
            let condense = || condensed.condense_into(&map, k.values(), &f, &mut k_q, &mut f_q);
            let (done, condensation) = pool.install(|| timed(condense));
            done?;
            let element = |e: usize, matrix: &mut [f64], _: &mut [f64]| {
                let matrix = DMatrixViewMut::from_slice(matrix, 24, 24);
                elements.assemble_element_matrix_into(e, matrix).expect("the cell is sound: it was assembled above");
            };
            let scatter = || scattered.assemble(&map, count, cell_dofs, &mut k_q, &mut f_q, element);
            let (done, scatter) = pool.install(|| timed(scatter));
            done?;
            least.iter_mut().zip([assembly, condensation, scatter]).for_each(|(least, time)| *least = least.min(time));
        }
        let [assembly, condensation, scatter] = least;
        println!(
            "{threads} threads: assembly {assembly:.4} s, condensation {condensation:.4} s, scatter {scatter:.4} s"
        );
        println!(
            "  condensation / assembly {:.3}, scatter / assembly {:.3}",
            condensation / assembly,
            scatter / assembly
        );
    }
    Ok(())
}

fn timed<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let start = Instant::now();
    let result = work();
    (result, start.elapsed().as_secs_f64())
}

//! Edge cases: no equations, no masters, DOFs without equations, elements that name a DOF twice.

use qless::elimination::{EliminationError, PrescribedDofs, Storage, View};
use qless::{Elimination, Options, SystemBuilder};

use super::dense::close;

fn map(builder: SystemBuilder) -> Elimination {
    Elimination::new(&builder.build().expect("a system"), &Options::default()).expect("no conflict")
}

#[test]
fn without_equations_nothing_changes() {
    let map = map(SystemBuilder::new(3));
    let (starts, rows, k) = ([0_u32, 2, 3, 5], [0_u32, 2, 1, 0, 2], [1.0, 2.0, 3.0, 4.0, 5.0]);
    let condensed = map.condensed(View::columns(&starts, &rows), PrescribedDofs::Kept).expect("a pattern");
    let (mut k_q, mut f_q, mut u) = (vec![0.0; 5], vec![0.0; 3], vec![0.0; 3]);
    condensed.condense_into(&map, &k, &[7.0, 8.0, 9.0], &mut k_q, &mut f_q).expect("finite");
    assert_eq!((condensed.starts(), condensed.index()), (starts.as_slice(), rows.as_slice()));
    assert_eq!((k_q.as_slice(), f_q.as_slice()), (k.as_slice(), [7.0, 8.0, 9.0].as_slice()));
    map.expand_into(&[1.0, 2.0, 3.0], &mut u).expect("finite");
    assert_eq!(u, [1.0, 2.0, 3.0]);
    assert_eq!(map.multipliers(&[1.0; 3]).expect("none"), [0.0; 0]);
}

#[test]
fn where_all_is_prescribed_or_fixed_nothing_is_left() {
    let mut builder = SystemBuilder::new(3);
    (0..2).for_each(|j| builder.prescribe(j, 1.0 + j as f64));
    builder.equation([(2, 2.0), (0, 1.0)], 0.0);
    let map = map(builder);
    assert!(map.masters().is_empty());
    let diagonal = View::rows(&[0_usize, 1, 2, 3], &[0_u32, 1, 2]);
    let condensed = map.condensed(diagonal, PrescribedDofs::Eliminated).expect("a pattern");
    assert_eq!((condensed.unknowns(), condensed.nnz(), condensed.starts()), (0, 0, [0].as_slice()));
    condensed.condense_into(&map, &[1.0; 3], &[1.0; 3], &mut [], &mut []).expect("nothing");
    let mut u = [0.0; 3];
    map.expand_into(&[], &mut u).expect("finite");
    assert_eq!(u, [1.0, 2.0, -0.5]);
    map.restrict_into(&[1.0; 3], &mut []).expect("nothing");
    map.restrict_many_into(&[1.0; 6], &mut []).expect("nothing");
    map.expand_increments_into(&[], &mut [1.0; 6]).expect("nothing");
    // The force on the slave acts on the prescribed DOF: 3 on u2 is -1.5 on u0.
    let lambda = map.multipliers(&[0.0, 0.0, 3.0]).expect("factored");
    assert_eq!((lambda[0], map.reactions(&[0.0, 0.0, 3.0], &lambda).expect("finite")), (1.5, vec![1.5, 0.0]));
    assert_eq!(map.loads_without_effect(&[1.0, 1.0, 4.0]).expect("finite"), [(2, 4.0)]);
}

/// K alone is singular, DOFs of the element repeat, and a slave depends on a master of the same element.
#[test]
fn elements_may_name_a_dof_twice_and_hold_their_own_masters() {
    let mut builder = SystemBuilder::new(4);
    builder.equation([(1, 1.0), (0, -2.0), (3, 1.0)], 0.5);
    builder.prescribe(3, 0.25);
    let map = map(builder);
    let dofs = |_| [0_usize, 1, 1, 3];
    let matrix: Vec<f64> = (0..16).map(|k| 1.0 / f64::from(1 + k % 5 + k / 4)).collect();
    let forces = [1.0, 2.0, 3.0, 4.0];
    // K of DOFs 0, 1 and 3, by hand.
    let mut k = [[0.0; 4]; 4];
    let mut f = [0.0; 4];
    for (a, i) in dofs(0).into_iter().enumerate() {
        f[i] += forces[a];
        dofs(0).into_iter().enumerate().for_each(|(b, j)| k[i][j] += matrix[4 * a + b]);
    }
    for given in [PrescribedDofs::Eliminated, PrescribedDofs::Kept] {
        let condensed = map.condensed_for_elements(1, dofs, Storage::Full, given).expect("a pattern");
        let (mut k_q, mut f_q) = (vec![0.0; condensed.nnz()], vec![0.0; condensed.unknowns()]);
        condensed.add_element(&map, &dofs(0), (&matrix, &forces), &mut k_q, &mut f_q).expect("in the pattern");
        // Whichever of 0 and 1 is the slave: energies agree for any u that meets the equation.
        let x: Vec<f64> = (0..condensed.unknowns()).map(|c| 0.3 + c as f64).collect();
        let energy_q: f64 = (0..x.len())
            .flat_map(|i| (condensed.starts()[i]..condensed.starts()[i + 1]).map(move |e| (i, e as usize)))
            .map(|(i, e)| x[i] * k_q[e] * x[condensed.index()[e] as usize])
            .sum();
        let l = |u: &[f64]| -> Vec<f64> {
            let mut du = vec![0.0; 4];
            condensed.dofs().iter().zip(u).for_each(|(&j, &v)| du[j] = v);
            for &slave in map.slaves() {
                let (terms, _) = map.row(slave).expect("a slave");
                du[slave] = terms.iter().map(|&(j, v)| v * du[j]).sum();
            }
            du
        };
        let du = l(&x);
        let energy: f64 = (0..4).flat_map(|i| (0..4).map(move |j| (i, j))).map(|(i, j)| du[i] * k[i][j] * du[j]).sum();
        assert!(close(energy, energy_q), "{energy} and {energy_q}");
    }
}

/// Without its equations an elimination computes no multipliers and takes no right-hand sides; T, G and g work as usual.
#[test]
fn an_elimination_from_a_reduction_has_no_equations() {
    let mut builder = SystemBuilder::new(3);
    builder.equation([(0, 1.0), (1, -2.0), (2, 3.0)], 0.5);
    builder.prescribe(2, 4.0);
    let whole = Elimination::new(&builder.build().expect("valid"), &Options::default()).expect("no conflict");
    let mut bare = Elimination::from_reduction(whole.reduction().clone(), &[4.0]).expect("its lengths");
    assert!(bare.analysis().is_none() && bare.rhs().is_empty() && bare.kinds().is_empty());
    let none = Err(EliminationError::NoEquations);
    assert_eq!(bare.multipliers(&[0.0; 3]), none);
    assert_eq!(bare.reactions(&[0.0; 3], &[]), none);
    assert_eq!(bare.loads_without_effect(&[0.0; 3]).map(|_| ()), Err(EliminationError::NoEquations));
    assert_eq!(bare.update(&[1.0], &[1.0]), Err(EliminationError::NoEquations));
    assert!(Elimination::from_reduction(whole.reduction().clone(), &[]).is_err());
    assert!(Elimination::from_reduction(whole.reduction().clone(), &[f64::NAN]).is_err());
    let (mut u, mut same) = ([0.0; 3], [0.0; 3]);
    whole.expand_into(&[1.5], &mut u).expect("one master");
    bare.expand_into(&[1.5], &mut same).expect("one master");
    assert_eq!(u, same);
    // A prescribed value of another time, as `update` sets it if the equations are known.
    bare.set(whole.reduction().g(), &[1.0]).expect("one slave");
    bare.expand_into(&[1.5], &mut same).expect("one master");
    assert_eq!(same[0] - 2.0 * same[1] + 3.0 * same[2], 0.5);
}

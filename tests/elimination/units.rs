//! Results do not depend on the units of DOFs and equations, or on the sizes of constants.

use qless::elimination::{PrescribedDofs, Storage};
use qless::{ArgumentError, ConstraintSystem, Elimination, Form, Kind, Options, SystemBuilder, analyse};
use qless_scenes::Rng;

use super::dense::{close, map_of, random_system};

fn power(rng: &mut Rng, most: usize) -> f64 {
    2.0_f64.powi(rng.below(2 * most + 1) as i32 - most as i32)
}

/// The same system with DOF j counted in `units[j]` and equation i multiplied by `rows[i]`, all powers of two.
fn in_units(system: &ConstraintSystem, units: &[f64], rows: &[f64]) -> ConstraintSystem {
    let mut builder = SystemBuilder::new(system.dofs());
    for (i, row) in rows.iter().enumerate() {
        let terms = system.matrix().row(i).map(|(j, v)| (j, v / units[j] * row));
        builder.equation(terms, system.rhs()[i] * row);
    }
    system.prescribed().iter().for_each(|&(j, v)| builder.prescribe(j, v * units[j]));
    builder.build().expect("a system")
}

#[test]
fn prescribed_dofs_bring_the_same_in_any_unit() {
    for seed in 0..1500 {
        let mut rng = Rng::new(seed);
        let system = random_system(&mut rng);
        let mut units = vec![1.0; system.dofs()];
        system.prescribed().iter().for_each(|&(j, _)| units[j] = power(&mut rng, 300));
        let other = in_units(&system, &units, &vec![1.0; system.equations()]);
        for form in [Form::Explicit, Form::Factored] {
            let (Some(_), Some(other)) = (map_of(&system, form), map_of(&other, form)) else { continue };
            let mut u = vec![0.0; other.dofs()];
            other.expand_into(&vec![0.25; other.masters().len()], &mut u).expect("finite");
            u.iter_mut().zip(&units).for_each(|(u, unit)| *u /= unit);
            let left = system.matrix().times(&u).expect("a number for each DOF");
            left.iter().zip(system.rhs()).for_each(|(a, b)| assert!(close(*a, *b), "seed {seed}: {a} for {b}"));
        }
    }
}

#[test]
fn multipliers_balance_in_any_units() {
    let mut checked = 0;
    for seed in 0..1500 {
        let mut rng = Rng::new(seed);
        let plain = random_system(&mut rng);
        let units: Vec<f64> = (0..plain.dofs()).map(|_| power(&mut rng, 100)).collect();
        let rows: Vec<f64> = (0..plain.equations()).map(|_| power(&mut rng, 100)).collect();
        let analysis = analyse(&in_units(&plain, &units, &rows), &Options::default()).expect("analysed");
        let sure = !analysis.confidence().ambiguous;
        let Some(map) = Elimination::from_analysis(analysis, Form::Explicit).ok().filter(|_| sure) else { continue };
        let force = |lambda: &dyn Fn(usize) -> f64, j: usize| {
            let of_row = |i: usize| plain.matrix().row(i).filter(|e| e.0 == j).map(|(_, v)| v * lambda(i)).sum::<f64>();
            (0..plain.equations()).map(of_row).sum::<f64>()
        };
        let residual: Vec<f64> = (0..plain.dofs()).map(|j| force(&|i| (i + 1) as f64, j)).collect();
        let scaled: Vec<f64> = residual.iter().zip(&units).map(|(r, unit)| r / unit).collect();
        let lambda = map.multipliers(&scaled).unwrap_or_else(|error| panic!("seed {seed}: {error}"));
        for j in (0..plain.dofs()).filter(|j| !map.prescribed().contains(j)) {
            let found = force(&|i| lambda[i] * rows[i], j);
            assert!((found - residual[j]).abs() < 1e-9, "seed {seed}, DOF {j}: {found} for {}", residual[j]);
        }
        checked += usize::from(map.kinds().contains(&Kind::Independent));
    }
    assert!(checked > 300, "{checked}");
}

#[test]
fn increments_lose_nothing_beside_large_constants() {
    for seed in 0..500 {
        let mut rng = Rng::new(seed);
        let plain = random_system(&mut rng);
        let mut builder = SystemBuilder::new(plain.dofs());
        // Every DOF is shifted by 1e12 times its size.
        (0..plain.equations()).for_each(|i| {
            builder.equation(plain.matrix().row(i), plain.rhs()[i] * 2.0_f64.powi(40));
        });
        plain.prescribed().iter().for_each(|&(j, v)| builder.prescribe(j, v * 2.0_f64.powi(40)));
        let large = builder.build().expect("a system");
        let [Some(map), Some(large)] = [&plain, &large].map(|system| map_of(system, Form::Factored)) else { continue };
        let x: Vec<f64> = map.masters().iter().map(|_| rng.real() - 0.5).collect();
        let mut du = [vec![0.0; map.dofs()], vec![f64::NAN; map.dofs()]];
        map.expand_increment_into(&x, &mut du[0]).expect("finite");
        large.expand_increment_into(&x, &mut du[1]).expect("finite");
        assert_eq!(du[0], du[1], "seed {seed}");
    }
}

#[test]
fn elements_beyond_doubles_are_refused() {
    let mut builder = SystemBuilder::new(2);
    builder.equation([(0, 2.0_f64.powi(-600)), (1, -1.0)], 0.0);
    builder.equation([(0, 2.0_f64.powi(-600)), (1, -1.0)], 0.0);
    let mut preferred = Options::default();
    preferred.preferences.masters = vec![1];
    let map = Elimination::new(&builder.build().expect("a system"), &preferred).expect("no conflict");
    assert_eq!(map.masters(), [1]);
    let dofs = |_| [0_usize, 1];
    let condensed = map.condensed_for_elements(1, dofs, Storage::Full, PrescribedDofs::Eliminated).expect("a pattern");
    let (mut k_q, mut f_q) = (vec![0.0; condensed.nnz()], vec![0.0; 1]);
    let (matrix, forces) = ([1.0, 0.0, 0.0, 1.0], [1.0, 1.0]);
    let one = condensed.add_element(&map, &[0, 1], (&matrix, &forces), &mut k_q, &mut f_q);
    assert!(matches!(one, Err(ArgumentError::Overflow { .. })), "{one:?}");
    let all = condensed.assemble(&map, 1, dofs, &mut k_q, &mut f_q, |_, k, _| k.copy_from_slice(&matrix));
    assert!(matches!(all, Err(ArgumentError::Overflow { .. })), "{all:?}");
}

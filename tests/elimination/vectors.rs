//! Expand, increment, restrict, operator, multipliers and update against L and u_0, in both forms of T.

use qless::elimination::{EliminationError, PrescribedDofs};
use qless::{ArgumentError, Elimination, Form, Options, SystemBuilder};
use qless_scenes::Rng;

use super::dense::{close, map_of, parts, random_system};
use super::matrix::random;

fn numbers(count: usize, rng: &mut Rng) -> Vec<f64> {
    (0..count).map(|_| rng.real() - 0.5).collect()
}

fn same(a: &[f64], b: &[f64]) {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).for_each(|(a, b)| assert!(close(*a, *b), "{a} for {b}"));
}

/// L by its columns, from unit vectors; and u_0.
fn by_columns(map: &Elimination) -> (Vec<Vec<f64>>, Vec<f64>) {
    let (n, q) = (map.dofs(), map.masters().len());
    let expanded = |x: &[f64]| {
        let mut u = vec![f64::NAN; n];
        map.expand_into(x, &mut u).expect("finite");
        u
    };
    let constant = expanded(&vec![0.0; q]);
    let mut units = vec![0.0; q * q];
    (0..q).for_each(|c| units[c * q + c] = 1.0);
    let mut columns = vec![f64::NAN; n * q];
    map.expand_increments_into(&units, &mut columns).expect("finite");
    (columns.chunks(n).map(<[f64]>::to_vec).collect(), constant)
}

#[test]
fn l_meets_the_equations_and_is_what_rows_say() {
    for seed in 0..1500 {
        let mut rng = Rng::new(seed);
        let system = random_system(&mut rng);
        for form in [Form::Explicit, Form::Factored] {
            let Some(map) = map_of(&system, form) else { continue };
            let (columns, constant) = by_columns(&map);
            same(&system.matrix().times(&constant).expect("a number for each DOF"), system.rhs());
            for column in &columns {
                let left = system.matrix().times(column).expect("a number for each DOF");
                same(&left, &vec![0.0; left.len()]);
            }
            if map.reduction().is_explicit() {
                let (l, u_0) = parts(&map, PrescribedDofs::Eliminated);
                same(&constant, &u_0);
                columns
                    .iter()
                    .enumerate()
                    .for_each(|(c, own)| same(own, &l.iter().map(|row| row[c]).collect::<Vec<_>>()));
            }
        }
    }
}

#[test]
fn vectors_go_there_and_back_as_l_says() {
    for seed in 0..1500 {
        let mut rng = Rng::new(seed);
        let system = random_system(&mut rng);
        let Some(map) = map_of(&system, [Form::Explicit, Form::Factored][rng.below(2)]) else { continue };
        let (columns, constant) = by_columns(&map);
        let (n, q) = (map.dofs(), map.masters().len());
        let (x, f) = (numbers(2 * q, &mut rng), numbers(2 * n, &mut rng));
        let moved = |x: &[f64]| {
            (0..n).map(|i| columns.iter().zip(x).map(|(column, x)| column[i] * x).sum()).collect::<Vec<f64>>()
        };
        let back = |f: &[f64]| {
            columns.iter().map(|column| column.iter().zip(f).map(|(l, f)| l * f).sum()).collect::<Vec<f64>>()
        };
        let (mut u, mut f_q) = (vec![f64::NAN; 2 * n], vec![f64::NAN; 2 * q]);
        map.expand_into(&x[..q], &mut u[..n]).expect("finite");
        same(&u[..n], &moved(&x[..q]).iter().zip(&constant).map(|(u, c)| u + c).collect::<Vec<f64>>());
        map.expand_increments_into(&x, &mut u).expect("finite");
        same(&u[..n], &moved(&x[..q]));
        same(&u[n..], &moved(&x[q..]));
        map.restrict_many_into(&f, &mut f_q).expect("finite");
        same(&f_q[..q], &back(&f[..n]));
        same(&f_q[q..], &back(&f[n..]));
        let mut long = vec![0.0; q + 1];
        assert!(matches!(map.expand_into(&x[..q], &mut u[1..n]), Err(ArgumentError::WrongLength { .. })));
        assert!(matches!(map.expand_into(&long, &mut u[..n]), Err(ArgumentError::WrongLength { .. })));
        assert!(matches!(map.restrict_into(&f[..n], &mut long), Err(ArgumentError::WrongLength { .. })));
        assert!(matches!(map.expand_increments_into(&x, &mut u[1..]), Err(ArgumentError::WrongLength { .. })));
        let mut bad = f[..n].to_vec();
        bad[rng.below(n)] = f64::NAN;
        assert!(matches!(map.restrict_into(&bad, &mut f_q[..q]), Err(ArgumentError::NotFinite { .. })));
    }
}

/// If u solves the condensed equations, `K u + C^T lambda = f` at every DOF, with reactions at the prescribed DOFs.
#[test]
fn multipliers_balance_every_dof() {
    let mut checked = 0;
    for seed in 0..800 {
        let mut rng = Rng::new(seed);
        let system = random_system(&mut rng);
        let Some(map) = map_of(&system, Form::Explicit) else { continue };
        let (n, q) = (map.dofs(), map.masters().len());
        let (u_q, lambda) = (numbers(q, &mut rng), numbers(system.equations(), &mut rng));
        let mut u = vec![0.0; n];
        map.expand_into(&u_q, &mut u).expect("finite");
        let k = random(n, false, &mut rng);
        let stress: Vec<f64> = k.iter().map(|row| row.iter().zip(&u).map(|(k, u)| k * u).sum()).collect();
        // Forces in balance with some multipliers and no reactions: exactly at masters and slaves.
        let mut f = stress.clone();
        for (i, lambda) in lambda.iter().enumerate() {
            system.matrix().row(i).for_each(|(j, v)| f[j] += v * lambda);
        }
        let residual: Vec<f64> = f.iter().zip(&stress).map(|(f, s)| f - s).collect();
        let mut projected = vec![0.0; q];
        map.restrict_into(&residual, &mut projected).expect("finite");
        let found = map.multipliers(&residual).expect("factored");
        let reactions = map.reactions(&residual, &found).expect("finite");
        let mut left = residual.clone();
        for (i, lambda) in found.iter().enumerate() {
            assert!(map.kinds()[i] == qless::Kind::Independent || *lambda == 0.0);
            system.matrix().row(i).for_each(|(j, v)| left[j] -= v * lambda);
        }
        map.prescribed().iter().zip(&reactions).for_each(|(&j, r)| left[j] += r);
        left.iter().for_each(|v| assert!(v.abs() < 1e-9, "seed {seed}: {v}"));
        checked += usize::from(found.iter().any(|v| *v != 0.0));
    }
    assert!(checked > 500, "{checked}");
}

#[test]
fn the_operator_is_the_condensed_matrix() {
    for seed in 0..300 {
        let mut rng = Rng::new(seed);
        let system = random_system(&mut rng);
        let Some(map) = map_of(&system, Form::Explicit) else { continue };
        let k = random(map.dofs(), false, &mut rng);
        let (k_q, _) = super::dense::condensed(&k, &vec![0.0; map.dofs()], &parts(&map, PrescribedDofs::Eliminated));
        let x = numbers(map.masters().len(), &mut rng);
        let mut y = vec![f64::NAN; x.len()];
        let times = |u: &[f64], f: &mut [f64]| {
            k.iter().zip(f).for_each(|(row, f)| *f += row.iter().zip(u).map(|(k, u)| k * u).sum::<f64>());
        };
        let mut operator = map.operator(times);
        operator.apply_into(&x, &mut y).expect("finite");
        operator.apply_into(&x, &mut y).expect("finite");
        same(&y, &k_q.iter().map(|row| row.iter().zip(&x).map(|(k, x)| k * x).sum()).collect::<Vec<f64>>());
    }
}

/// An update equals a new elimination with the new numbers; inconsistent numbers are refused and change nothing.
#[test]
fn refreshed_maps_are_those_of_a_fresh_system() {
    let (mut refused, mut taken) = (0, 0);
    for seed in 0..800 {
        let mut rng = Rng::new(seed);
        let system = random_system(&mut rng);
        let Some(mut map) = map_of(&system, [Form::Explicit, Form::Factored][rng.below(2)]) else { continue };
        let u = numbers(system.dofs(), &mut rng);
        let mut b = system.matrix().times(&u).expect("a number for each DOF");
        let given: Vec<f64> = map.prescribed().iter().map(|&j| u[j]).collect();
        let x = numbers(map.masters().len(), &mut rng);
        let mut expanded = [vec![0.0; system.dofs()], vec![0.0; system.dofs()]];
        let spoilt = (0..b.len()).find(|&i| map.kinds()[i] == qless::Kind::Redundant).filter(|_| rng.below(2) == 0);
        if let Some(i) = spoilt {
            b[i] += 1.0;
            map.expand_into(&x, &mut expanded[0]).expect("finite");
            let error = map.update(&b, &given).expect_err("a contradiction");
            assert!(matches!(error, EliminationError::Conflicting { .. }), "{error}");
            map.expand_into(&x, &mut expanded[1]).expect("finite");
            assert_eq!(expanded[0], expanded[1], "as it was");
            refused += 1;
            continue;
        }
        map.update_with(|i| b[i], |j| u[j]).expect("consistent");
        map.expand_into(&x, &mut expanded[0]).expect("finite");
        let left = system.matrix().times(&expanded[0]).expect("a number for each DOF");
        same(&left, &b);
        map.prescribed().iter().zip(&given).for_each(|(&j, v)| assert_eq!(expanded[0][j], *v));
        taken += 1;
    }
    assert!(refused > 50 && taken > 400, "{refused} and {taken}");
}

#[test]
fn maps_are_sent_and_shared_and_know_conflicts() {
    fn sent<T: Send + Sync + 'static>() {}
    sent::<Elimination>();
    sent::<qless::elimination::CondensedPattern>();
    let mut builder = SystemBuilder::new(2);
    builder.equation([(0, 1.0), (1, -1.0)], 0.0);
    builder.equation([(0, 1.0), (1, -1.0)], 1.0);
    let error =
        Elimination::new(&builder.build().expect("a system"), &Options::default()).expect_err("a contradiction");
    assert!(matches!(&error, EliminationError::Conflicting { rows, .. } if rows.len() == 1), "{error}");
    assert!(error.to_string().contains("conflict"), "{error}");
}

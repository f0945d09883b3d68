//! Results of a connected part do not depend on other parts, to the last bit: f(A + B) is f(A) and f(B).

use faer::sparse::{SparseColMat, Triplet};
use qless::{ConstraintSystem, SystemBuilder};
use qless_solve::enforce::{EnforceError, Method, Problem, Solution};

use super::Random;
use super::models::{Kind, Lack, Model, Units, all_units, model};
use crate::linkages::Outcome;

type Solved = Result<Solution, EnforceError>;

/// Two models with interleaved DOFs, each in its own order.
struct Both {
    k: SparseColMat<usize, f64>,
    f: Vec<f64>,
    system: ConstraintSystem,
    /// The DOFs and the equations of each model.
    dofs: [Vec<usize>; 2],
    rows: [Vec<usize>; 2],
}

/// Interleaves two lists at random; returns the positions of each.
fn shuffled(counts: [usize; 2], random: &mut Random) -> [Vec<usize>; 2] {
    let mut places = [Vec::new(), Vec::new()];
    for at in 0..counts[0] + counts[1] {
        let left = [counts[0] - places[0].len(), counts[1] - places[1].len()];
        let second = left[0] == 0 || (left[1] > 0 && random.below(2) == 0);
        places[usize::from(second)].push(at);
    }
    places
}

fn both(models: [&Model; 2], case: usize) -> Outcome<Both> {
    let random = &mut Random::new(case);
    let dofs = shuffled(models.map(|model| model.f.len()), random);
    let rows = shuffled(models.map(|model| model.system.equations()), random);
    let n = dofs[0].len() + dofs[1].len();
    let (mut entries, mut f, mut equations) = (Vec::new(), vec![0.0; n], vec![(0, 0); rows[0].len() + rows[1].len()]);
    let mut builder = SystemBuilder::new(n);
    for (side, model) in models.into_iter().enumerate() {
        let own = &dofs[side];
        for j in 0..own.len() {
            f[own[j]] = model.f[j];
            let column = model.k.symbolic().row_idx_of_col(j).zip(model.k.val_of_col(j));
            column.for_each(|(i, &v)| entries.push(Triplet::new(own[i], own[j], v)));
        }
        rows[side].iter().enumerate().for_each(|(row, &at)| equations[at] = (side, row));
        model.system.prescribed().iter().for_each(|&(j, value)| builder.prescribe(own[j], value));
    }
    for (side, row) in equations {
        let system = &models[side].system;
        builder.equation(system.matrix().row(row).map(|(j, v)| (dofs[side][j], v)), system.rhs()[row]);
    }
    Ok(Both { k: SparseColMat::try_new_from_triplets(n, n, &entries)?, f, system: builder.build()?, dofs, rows })
}

/// One method for all equations, or each method in turn.
fn solved(k: &SparseColMat<usize, f64>, f: &[f64], system: &ConstraintSystem, turns: &[Method]) -> Solved {
    Problem::new(k, f, system)?.enforce(turns, 1e-3)
}

fn of(values: &[f64], places: &[usize]) -> Vec<u64> {
    places.iter().map(|&at| values[at].to_bits()).collect()
}

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|v| v.to_bits()).collect()
}

fn same(both: &Both, found: &Solved, alone: &[Solved; 2]) {
    match (found, alone) {
        (Ok(found), [Ok(a), Ok(b)]) => {
            for (side, alone) in [a, b].into_iter().enumerate() {
                assert_eq!(of(&found.u, &both.dofs[side]), bits(&alone.u));
                assert_eq!(of(&found.forces, &both.dofs[side]), bits(&alone.forces));
                assert_eq!(of(&found.multipliers, &both.rows[side]), bits(&alone.multipliers));
                for &(j, reaction) in &alone.reactions {
                    let there = found.reactions.iter().find(|&&(dof, _)| dof == both.dofs[side][j]);
                    assert_eq!(there.map(|(_, value)| value.to_bits()), Some(reaction.to_bits()));
                }
            }
            assert_eq!(found.accuracy, a.accuracy.max(b.accuracy));
            assert_eq!(found.imbalance, a.imbalance.max(b.imbalance));
        }
        (Err(EnforceError::Unsupported(found)), alone) => {
            let motions = alone.iter().zip(&both.dofs).filter_map(|(alone, dofs)| match alone {
                Err(EnforceError::Unsupported(motion)) => Some((motion, dofs)),
                _ => None,
            });
            let mut moves: Vec<(usize, u64)> = motions
                .flat_map(|(motion, dofs)| motion.dofs.iter().map(|&j| dofs[j]).zip(bits(&motion.motion)))
                .collect();
            moves.sort_unstable();
            assert_eq!(found.dofs.iter().copied().zip(bits(&found.motion)).collect::<Vec<_>>(), moves);
        }
        (Err(EnforceError::PenaltyTooSmall { cost, .. }), alone) => {
            let costs = alone.iter().filter_map(|alone| match alone {
                Err(EnforceError::PenaltyTooSmall { cost, .. }) => Some(*cost),
                _ => None,
            });
            assert_eq!(Some(*cost), costs.reduce(f64::max));
        }
        (found, alone) => panic!("{found:?}; {alone:?}"),
    }
}

#[test]
fn what_is_found_of_a_part_does_not_depend_on_others() -> Outcome {
    let units: Vec<Units> = all_units().collect();
    let kinds = [Kind::Symmetric, Kind::Unsymmetric, Kind::Indefinite];
    let lacks = [Lack::Nothing, Lack::Nothing, Lack::Nothing, Lack::Ground];
    for case in 0..120 {
        let a = model(case, kinds[case % 3], lacks[case % 4], units[case % 9])?;
        let b = model(case + 500, kinds[case / 3 % 3], lacks[case / 4 % 4], units[case / 9 % 9])?;
        let both = both([&a, &b], case)?;
        let factor = 10_f64.powi((case % 14) as i32);
        let turns = [
            Method::Elimination,
            Method::Multiplier,
            Method::Penalty { factor },
            Method::Augmented { factor: 1e2 * factor },
        ];
        for shift in 0..5 {
            let methods = |model: &Model| -> Vec<Method> {
                let turn = |row: usize| if shift < 4 { turns[shift] } else { turns[row % 4] };
                (0..model.system.equations()).map(turn).collect()
            };
            let alone = [&a, &b].map(|model| solved(&model.k, &model.f, &model.system, &methods(model)));
            let mut all = vec![Method::Multiplier; both.system.equations()];
            for (side, model) in [&a, &b].into_iter().enumerate() {
                both.rows[side].iter().zip(methods(model)).for_each(|(&row, method)| all[row] = method);
            }
            same(&both, &solved(&both.k, &both.f, &both.system, &all), &alone);
        }
    }
    Ok(())
}

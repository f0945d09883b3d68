//! What one rank does wrong, all hear: the same error, and nobody waits.

use qless::{BackendChoice, Noise, OptionError, Options, Preferences, Tolerance};
use qless_mpi::{DistributedElimination, Error, OptionName, Ranks, Share, ShareError, SharePlace, analyse, on_threads};

/// Three ranks with two DOFs and an equation each, and what one of them adds.
fn errors(add: impl Fn(usize, &mut Share) + Sync, options: &Options) -> Vec<Option<Error>> {
    on_threads(3, |ranks: &dyn Ranks| {
        let rank = ranks.rank();
        let mut share = Share::new(2 * rank as u64..2 * rank as u64 + 2);
        share.equation(rank as u64, [(2 * rank as u64, 1.0), ((2 * rank as u64 + 3) % 6, -1.0)], 0.0);
        add(rank, &mut share);
        analyse(ranks, &share, options).err()
    })
}

fn all_say(found: &[Option<Error>], expected: &Error) {
    assert!(found.iter().all(|error| error.as_ref() == Some(expected)), "{found:?} instead of {expected:?}");
}

#[test]
fn every_fault_of_one_rank_is_the_error_of_all() {
    let options = Options::default();
    let faulty = |add: fn(&mut Share)| {
        errors(
            |rank, share| {
                if rank == 1 {
                    add(share);
                }
            },
            &options,
        )
    };
    all_say(
        &faulty(|share| share.equation(9, [(0, f64::INFINITY)], 0.0)),
        &ShareError::NotFinite { rank: 1, what: SharePlace::Coefficient { equation: 9, dof: 0 }, value: f64::INFINITY }
            .into(),
    );
    all_say(
        &faulty(|share| share.equation(9, [(6, 1.0)], 0.0)),
        &ShareError::DofOutOfRange { rank: 1, what: SharePlace::Coefficient { equation: 9, dof: 6 }, dofs: 6 }.into(),
    );
    all_say(
        &faulty(|share| share.prescribe(u64::MAX, 0.0)),
        &ShareError::DofOutOfRange { rank: 1, what: SharePlace::Prescribed { dof: u64::MAX }, dofs: 6 }.into(),
    );
    all_say(
        &faulty(|share| share.need(7)),
        &ShareError::DofOutOfRange { rank: 1, what: SharePlace::Needed { dof: 7 }, dofs: 6 }.into(),
    );
    all_say(
        &faulty(|share| share.equation(2, [(0, 1.0)], 0.0)),
        &ShareError::NumberTwice { rank: 2, number: 2 }.into(),
    );
    all_say(
        &faulty(|share| share.equation(u64::MAX, [(0, 1.0)], 0.0)),
        &ShareError::NumberTooLarge { rank: 1, number: u64::MAX }.into(),
    );
    let twice = errors(|rank, share| share.prescribe(4, if rank == 2 { 1.0 } else { 0.0 }), &options);
    all_say(&twice, &ShareError::PrescribedTwice { dof: 4, first: 0.0, second: 1.0 }.into());
    let options = Options { tolerance: Tolerance::Relative(2.0), ..Options::default() };
    all_say(&errors(|_, _| (), &options), &OptionError::Tolerance(2.0).into());
}

#[test]
fn options_that_differ_between_ranks_are_refused_by_all() {
    let same = Options::default();
    let preferences = Preferences { masters: vec![1], ..Preferences::default() };
    for (setting, other) in [
        (OptionName::Tolerance, Options { tolerance: Tolerance::Relative(1e-3), ..same.clone() }),
        (OptionName::Tolerance, Options { tolerance: Tolerance::Paper, ..same.clone() }),
        (OptionName::Backend, Options { backend: BackendChoice::Gauss, ..same.clone() }),
        (OptionName::Presolve, Options { presolve: false, ..same.clone() }),
        (OptionName::Effort, Options { effort: qless::Effort::Quick, ..same.clone() }),
        (OptionName::Growth, Options { growth: 8.0, ..same.clone() }),
        (OptionName::Noise, Options { noise: Noise::None, ..same.clone() }),
        (OptionName::Noise, Options { noise: Noise::Relative(1e-9), ..same.clone() }),
        (OptionName::Preferences, Options { preferences, ..same.clone() }),
    ] {
        let found = on_threads(3, |ranks| {
            let share = Share::new(2 * ranks.rank() as u64..2 * ranks.rank() as u64 + 2);
            analyse(ranks, &share, if ranks.rank() == 1 { &other } else { &same }).err()
        });
        assert_eq!(found, vec![Some(Error::Options { rank: 1, setting }); 3]);
    }
    let more = Options { memory: 1 << 20, ..same.clone() };
    let found = on_threads(2, |ranks| {
        let share = Share::new(2 * ranks.rank() as u64..2 * ranks.rank() as u64 + 2);
        analyse(ranks, &share, if ranks.rank() == 1 { &more } else { &same }).err()
    });
    assert_eq!(found, vec![None; 2]);
}

#[test]
fn numbers_that_are_not_finite_are_named_on_all_ranks() {
    let found = errors(
        |rank, share| {
            if rank == 1 {
                share.equation(9, [(0, 1.0)], f64::NAN);
            }
        },
        &Options::default(),
    );
    let texts: Vec<String> = found.into_iter().flatten().map(|error| error.to_string()).collect();
    assert_eq!(texts, vec!["rank 1: the right-hand side of equation 9 is NaN; every number must be finite"; 3]);
}

#[test]
fn ranges_that_leave_gaps_are_refused() {
    let found = on_threads(3, |ranks| {
        let rank = ranks.rank() as u64;
        let share = Share::new(if rank == 1 { 3..4 } else { 2 * rank..2 * rank + 2 });
        analyse(ranks, &share, &Options::default()).err()
    });
    all_say(&found, &ShareError::Ranges { rank: 1, start: 3, expected: 2 }.into());
}

#[test]
fn what_the_serial_library_refuses_on_one_rank_all_refuse() {
    // Below 2.2e-308 numbers lose their digits.
    let found = errors(
        |rank, share| {
            if rank == 0 {
                share.equation(9, [(1, 1e-310)], 0.0);
            }
        },
        &Options::default(),
    );
    let texts: Vec<String> = found.into_iter().flatten().map(|error| error.to_string()).collect();
    assert_eq!(texts.len(), 3);
    assert!(texts.iter().all(|text| *text == texts[0] && text.contains("2.2e-308")), "{texts:?}");
}

#[test]
fn a_component_beyond_the_memory_is_refused_with_its_size() {
    let options = Options { memory: 1000, ..Options::default() };
    let found = errors(
        |rank, share| {
            for k in 0..3 {
                share.equation(10 + 3 * rank as u64 + k, [(k, 1.0), (k + 1, -1.0), (k + 3, 1.0)], 0.0);
            }
        },
        &options,
    );
    let Some(Error::TooLarge { equations, limit, .. }) = &found[0] else { panic!("{found:?}") };
    assert_eq!((*equations, *limit), (12, 1000));
    assert!(found.iter().all(|error| *error == found[0]));
}

#[test]
fn a_map_of_conflicting_equations_is_refused_by_their_number() {
    let found = on_threads(3, |ranks| {
        let rank = ranks.rank() as u64;
        let mut share = Share::new(rank..rank + 1);
        share.equation(5 - rank, [(0, 1.0), (1, -1.0)], rank as f64);
        DistributedElimination::new(ranks, &share, &Options::default()).err()
    });
    all_say(&found, &Error::Conflicting { count: 2, first: 4 });
}

#[test]
fn ranks_without_anything_take_part() {
    let found = on_threads(4, |ranks| {
        let mut share = Share::new([0..0, 0..0, 0..2, 2..2][ranks.rank()].clone());
        if ranks.rank() == 3 {
            share.equation(7, [(0, 1.0), (1, 2.0)], 3.0);
            share.equation(8, [], 0.0);
            share.equation(9, [], 1.0);
        }
        let analysis = analyse(ranks, &share, &Options::default()).expect("valid");
        (
            analysis.counts().rank(),
            analysis.counts().redundant,
            analysis.counts().conflicting,
            analysis.slaves().to_vec(),
        )
    });
    assert!(found.iter().all(|counts| (counts.0, counts.1, counts.2) == (1, 1, 1)), "{found:?}");
    assert_eq!(found[2].3, [1]);
}

#[test]
fn no_dofs_at_all() {
    let found =
        on_threads(2, |ranks| analyse(ranks, &Share::new(0..0), &Options::default()).map(|a| a.counts().equations));
    assert_eq!(found, [Ok(0), Ok(0)]);
}

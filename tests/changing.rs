//! Constraints that are added and removed: after any sequence of changes the results are those of a new run, to the last bit.

use proptest::prelude::*;
use qless::change::{ChangeError, EquationId, SolvedBlock};
use qless::{ChangingSystem, Kind, Options, SystemBuilder, analyse};

const DOFS: usize = 24;

type Terms = Vec<(usize, f64)>;

/// A change of the set; equations are named by their index among the present ones.
#[derive(Clone, Debug)]
enum Change {
    Add(Terms, f64),
    Remove(usize),
    Rhs(usize, f64),
    Replace(usize, Terms),
    Prescribe(usize, f64),
    Release(usize),
    Update,
}

/// A few terms with small whole coefficients on neighbouring DOFs, which give many blocks and many dependent equations.
fn terms() -> impl Strategy<Value = Terms> {
    let near = (0..DOFS - 3, prop::collection::vec((0..4_usize, -2..=2_i32), 1..4));
    near.prop_map(|(first, terms)| terms.into_iter().map(|(d, a)| (first + d, f64::from(a))).collect())
}

fn change() -> impl Strategy<Value = Change> {
    let value = || (-2..=2_i32).prop_map(f64::from);
    prop_oneof![
        6 => (terms(), value()).prop_map(|(terms, rhs)| Change::Add(terms, rhs)),
        3 => (0..64_usize).prop_map(Change::Remove),
        1 => (0..64_usize, value()).prop_map(|(k, rhs)| Change::Rhs(k, rhs)),
        1 => (0..64_usize, terms()).prop_map(|(k, terms)| Change::Replace(k, terms)),
        1 => (0..DOFS, value()).prop_map(|(dof, value)| Change::Prescribe(dof, value)),
        1 => (0..DOFS).prop_map(Change::Release),
        3 => Just(Change::Update),
    ]
}

/// The expected content of the set.
#[derive(Default)]
struct Mirror {
    equations: Vec<(EquationId, Terms, f64)>,
    prescribed: std::collections::BTreeMap<usize, f64>,
}

impl Mirror {
    fn apply(&mut self, set: &mut ChangingSystem, change: &Change) -> Result<(), ChangeError> {
        let count = self.equations.len();
        match change {
            Change::Add(terms, rhs) => {
                let id = set.add(terms.clone(), *rhs)?;
                self.equations.push((id, terms.clone(), *rhs));
            }
            Change::Remove(k) if count > 0 => set.remove(self.equations.remove(k % count).0)?,
            Change::Rhs(k, rhs) if count > 0 => {
                self.equations[k % count].2 = *rhs;
                set.set_rhs(self.equations[k % count].0, *rhs)?;
            }
            Change::Replace(k, terms) if count > 0 => {
                self.equations[k % count].1.clone_from(terms);
                set.set_terms(self.equations[k % count].0, terms.clone())?;
            }
            Change::Prescribe(dof, value) => {
                self.prescribed.insert(*dof, *value);
                set.prescribe(*dof, *value)?;
            }
            Change::Release(dof) => {
                self.prescribed.remove(dof);
                set.release(*dof)?;
            }
            Change::Update => drop(set.update()?),
            _ => {}
        }
        Ok(())
    }

    /// A new set with the same content.
    fn fresh(&self) -> (ChangingSystem, Vec<EquationId>) {
        let mut set = ChangingSystem::new(DOFS, Options::default()).expect("few DOFs");
        self.prescribed.iter().for_each(|(&dof, &value)| set.prescribe(dof, value).expect("in range"));
        let add = |(_, terms, rhs): &(EquationId, Terms, f64)| set.add(terms.clone(), *rhs).expect("finite");
        let ids = self.equations.iter().map(add).collect();
        set.update().expect("analysed");
        (set, ids)
    }

    /// Rank and number of conflicts of the content as one system.
    fn whole(&self) -> (usize, usize) {
        let mut builder = SystemBuilder::new(DOFS);
        self.equations.iter().for_each(|(_, terms, rhs)| _ = builder.equation(terms.clone(), *rhs));
        self.prescribed.iter().for_each(|(&dof, &value)| builder.prescribe(dof, value));
        let analysis = analyse(&builder.build().expect("a system"), &Options::default()).expect("analysed");
        (analysis.rank(), analysis.kinds().iter().filter(|kind| **kind == Kind::Conflicting).count())
    }
}

/// All results of a block, with equations by their position.
fn said(set: &ChangingSystem, ids: &[EquationId]) -> Vec<String> {
    let position = |id: EquationId| ids.iter().position(|other| *other == id);
    let one = |&id: &EquationId| {
        let because: Vec<_> =
            set.because(id).expect("of this set").into_iter().map(|(id, c)| (position(id), c.to_bits())).collect();
        let block = set.block_of(id).expect("updated");
        let bits = |values: &[f64]| values.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
        let (t, g_matrix, g) = (block.reduction().t(), block.reduction().g_matrix(), block.reduction().g());
        let numbers = (bits(t.values()), t.columns(), t.starts(), bits(g_matrix.values()), bits(g));
        let members: Vec<_> = block.equations().iter().map(|id| position(*id)).collect();
        format!(
            "{:?}",
            (set.kind(id), because, members, &block.slaves(), &block.masters(), &block.prescribed(), numbers)
        )
    };
    ids.iter().map(one).collect()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, rng_seed: proptest::test_runner::RngSeed::Fixed(7), ..ProptestConfig::default() })]

    #[test]
    fn any_history_leaves_what_a_fresh_run_gives(changes in prop::collection::vec(change(), 1..60)) {
        let mut set = ChangingSystem::new(DOFS, Options::default()).expect("few DOFs");
        let mut mirror = Mirror::default();
        for change in &changes {
            mirror.apply(&mut set, change).expect("a valid change");
        }
        set.update().expect("analysed");
        let ids: Vec<EquationId> = mirror.equations.iter().map(|(id, ..)| *id).collect();
        let (fresh, fresh_ids) = mirror.fresh();
        prop_assert!(said(&set, &ids) == said(&fresh, &fresh_ids));
        prop_assert_eq!((set.rank(), set.equations()), (fresh.rank(), ids.len()));
        // Compare with the content as one system.
        let conflicts = ids.iter().filter(|&&id| set.kind(id) == Some(Kind::Conflicting)).count();
        prop_assert_eq!((set.rank(), conflicts), mirror.whole());
        // A second update has no work.
        prop_assert_eq!(set.update().expect("analysed"), 0);
    }
}

#[test]
fn only_what_is_touched_is_done_again() {
    let mut set = ChangingSystem::new(300, Options::default()).expect("few DOFs");
    let ids: Vec<_> = (0..100).map(|k| set.add([(3 * k, 1.0), (3 * k + 1, -1.0)], 0.0).expect("valid")).collect();
    assert_eq!(set.update().expect("analysed"), 100);
    let bridge = set.add([(1, 1.0), (4, -1.0)], 0.0).expect("valid");
    assert_eq!((set.update().expect("analysed"), set.rank()), (1, 101));
    assert_eq!(set.block_of(ids[0]).map(|block| block.equations().len()), Some(3));
    set.remove(bridge).expect("there");
    assert_eq!((set.update().expect("analysed"), set.rank()), (2, 100));
    // A prescribed DOF splits its block.
    let other = set.add([(0, 1.0), (2, -1.0)], 0.0).expect("valid");
    set.update().expect("analysed");
    set.prescribe(0, 0.5).expect("in range");
    assert_eq!(set.update().expect("analysed"), 2);
    let mut u = vec![0.0; 300];
    set.expand(&mut u).expect("long enough");
    assert_eq!((u[0], u[1], u[2]), (0.5, 0.5, 0.5));
    assert_eq!(set.kind(other), Some(Kind::Independent));
}

#[test]
fn a_block_in_doubt_leaves_the_others_sure() {
    let mut set = ChangingSystem::new(5, Options::default()).expect("few DOFs");
    let near = [0.0, 1e-9].map(|e| set.add([(0, 1.0), (1, 1.0 + e), (2, 1.0)], 0.0).expect("valid"));
    let sure = set.add([(3, 1.0), (4, 1.0)], 0.0).expect("valid");
    set.update().expect("analysed");
    let found = [near[0], near[1], sure].map(|id| set.block_of(id).map(SolvedBlock::ambiguous));
    assert_eq!(found, [Some(true), Some(true), Some(false)]);
}

#[test]
fn what_is_wrong_is_refused_and_changes_nothing() {
    let mut set = ChangingSystem::new(2, Options::default()).expect("few DOFs");
    assert_eq!(set.add([(2, 1.0)], 0.0), Err(ChangeError::DofOutOfRange { dof: 2, dofs: 2 }));
    assert!(matches!(set.add([(0, f64::NAN)], 0.0), Err(ChangeError::NotFinite(_))));
    assert!(matches!(set.prescribe(1, f64::INFINITY), Err(ChangeError::NotFinite(_))));
    let id = set.add([(0, 1.0)], 1.0).expect("valid");
    set.remove(id).expect("there");
    assert!(matches!(set.remove(id), Err(ChangeError::Gone(_))));
    assert!(matches!(set.set_rhs(id, 1.0), Err(ChangeError::Gone(_))));
    assert!(matches!(set.set_terms(id, [(0, 1.0)]), Err(ChangeError::Gone(_))));
    assert_eq!((set.update().expect("analysed"), set.equations(), set.kind(id)), (0, 0, None));
}

/// A block is in doubt if its own equations are nearly dependent, whatever the others are.
#[test]
fn doubts_are_those_of_the_block() {
    let mut set = ChangingSystem::new(6, Options::default()).expect("few DOFs");
    for (first, off) in [(0, 0.5), (3, 1e-9)] {
        for terms in [[1.0, 2.0, 3.0], [3.0, 1.0, -1.0], [4.0, 3.0, 2.0 + off]] {
            let terms: Vec<(usize, f64)> = terms.into_iter().enumerate().map(|(j, v)| (first + j, v)).collect();
            set.add(terms, 0.0).expect("valid");
        }
    }
    set.update().expect("analysed");
    let doubts: Vec<bool> = set.blocks().map(SolvedBlock::ambiguous).collect();
    assert_eq!(doubts, [false, true]);
}

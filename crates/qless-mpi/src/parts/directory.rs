//! What the owner of a DOF knows of it, and tells those that use it: who else does, and whether it is prescribed.
//!
//! Each rank names its DOFs to their owners, 8 bytes each; the owners answer for those that are shared or prescribed.

use std::collections::{BTreeMap, BTreeSet};

use super::{Layout, Touched};
use crate::ranks::{Post, Ranks, real};
use crate::share::ShareError;

/// Of the DOFs of a rank's equations, by place.
pub(crate) struct Known {
    /// Whether equations of other ranks name it too.
    pub shared: Vec<bool>,
    /// Whether a coefficient of it may be rounding, on any rank.
    pub faint: Vec<bool>,
    /// Whether it is free.
    pub free: Vec<bool>,
    /// The values of those that are not, by place.
    pub given: BTreeMap<u32, f64>,
}

/// What a rank knows of the DOFs that it owns.
#[derive(Clone, Debug)]
pub(crate) struct Directory {
    /// Values of the prescribed ones.
    pub prescribed: BTreeMap<u64, f64>,
}

const SHARED: u64 = 1;
const PRESCRIBED: u64 = 2;
const FAINT: u64 = 4;
/// What is said of a DOF takes this many bits below its place.
const BITS: u32 = 3;
/// Marks a DOF of which the same is said on the way to its owner.
const FAINT_DOF: u64 = 1 << 63;

impl Directory {
    /// Collective. `prescribed` may name any DOFs.
    pub fn new(
        ranks: &dyn Ranks,
        layout: &Layout,
        touched: &Touched,
        prescribed: &[(u64, f64)],
    ) -> (Result<Self, ShareError>, Known) {
        let mut prescriptions: BTreeMap<usize, Vec<u64>> = BTreeMap::new();
        for &(dof, value) in prescribed {
            prescriptions.entry(layout.owner(dof)).or_default().extend([dof, value.to_bits()]);
        }
        let mut post = Post::default();
        let mark = |(&dof, &faint): (&u64, &bool)| if faint { dof | FAINT_DOF } else { dof };
        let mut first = 0;
        for part in touched.dofs.chunk_by(|&a, &b| layout.owner(a) == layout.owner(b)) {
            let words = post.to(layout.owner(part[0]));
            words.push(part.len() as u64);
            words.extend(part.iter().zip(&touched.faint[first..]).map(mark));
            first += part.len();
        }
        for (owner, words) in prescriptions {
            let out = post.to(owner);
            if out.is_empty() {
                out.push(0);
            }
            out.extend(words);
        }
        let came = post.send(ranks);
        let (directory, answers) = Self::of_messages(&came);
        (directory, Known::of_answers(&answers.send(ranks), touched, layout))
    }

    /// The directory, and what is told to each rank: place among the DOFs that it named and what there is to know, with the value.
    fn of_messages(came: &[crate::Message]) -> (Result<Self, ShareError>, Post) {
        let mut prescribed: BTreeMap<u64, f64> = BTreeMap::new();
        let mut fault = None;
        let lists = came.iter().map(|message| message.words.split_at(1 + message.words[0] as usize));
        for pair in lists.clone().flat_map(|(_, given)| given.chunks_exact(2)) {
            let (dof, value) = (pair[0], real(pair[1]));
            let first = *prescribed.entry(dof).or_insert(value);
            if first != value {
                fault.get_or_insert(ShareError::PrescribedTwice { dof, first, second: value });
            }
        }
        let dofs_of = |dofs: &'_ [u64]| -> Vec<u64> { dofs[1..].iter().map(|dof| dof & !FAINT_DOF).collect() };
        let mut all: Vec<u64> = lists.clone().flat_map(|(dofs, _)| dofs_of(dofs)).collect();
        all.sort_unstable();
        let mut shared: Vec<u64> = all.windows(2).filter(|pair| pair[0] == pair[1]).map(|pair| pair[0]).collect();
        shared.dedup();
        let marked = lists.clone().flat_map(|(dofs, _)| dofs[1..].iter().filter(|&dof| dof & FAINT_DOF != 0));
        let faint: BTreeSet<u64> = marked.map(|dof| dof & !FAINT_DOF).collect();
        let mut answers = Post::default();
        for (message, (dofs, _)) in came.iter().zip(lists) {
            for (place, dof) in dofs_of(dofs).into_iter().enumerate() {
                let value = prescribed.get(&dof);
                let said = u64::from(shared.binary_search(&dof).is_ok()) * SHARED
                    | u64::from(value.is_some()) * PRESCRIBED
                    | u64::from(faint.contains(&dof)) * FAINT;
                if said != 0 {
                    let words = answers.to(message.rank);
                    words.push((place as u64) << BITS | said);
                    words.extend(value.map(|value| value.to_bits()));
                }
            }
        }
        (fault.map_or(Ok(Self { prescribed }), Err), answers)
    }
}

impl Known {
    fn of_answers(came: &[crate::Message], touched: &Touched, layout: &Layout) -> Self {
        let count = touched.dofs.len();
        let mut known =
            Self { shared: vec![false; count], faint: vec![false; count], free: vec![true; count], given: BTreeMap::new() };
        for message in came {
            let first = touched.dofs.partition_point(|&dof| dof < layout.owned(message.rank).start);
            let mut words = message.words.iter();
            while let Some(&word) = words.next() {
                let place = first + (word >> BITS) as usize;
                known.shared[place] = word & SHARED != 0;
                known.faint[place] = word & FAINT != 0;
                if word & PRESCRIBED != 0 {
                    known.free[place] = false;
                    known.given.insert(place as u32, words.next().map_or(0.0, |&bits| real(bits)));
                }
            }
        }
        known
    }
}

//! What the owner of a DOF knows of it, and tells those that use it: who else does, and whether it is prescribed.
//!
//! Each rank names its DOFs to their owners, 8 bytes each; the owners answer for those that are shared or prescribed.

use std::collections::BTreeMap;

use super::{Layout, Touched};
use crate::ranks::{Post, Ranks, real};
use crate::share::ShareError;

/// Of the DOFs of a rank's equations, by place.
pub(crate) struct Known {
    /// Whether equations of other ranks name it too.
    pub shared: Vec<bool>,
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
        for part in touched.dofs.chunk_by(|&a, &b| layout.owner(a) == layout.owner(b)) {
            let words = post.to(layout.owner(part[0]));
            words.push(part.len() as u64);
            words.extend_from_slice(part);
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
        let mut all: Vec<u64> = lists.clone().flat_map(|(dofs, _)| dofs[1..].iter().copied()).collect();
        all.sort_unstable();
        let mut shared: Vec<u64> = all.windows(2).filter(|pair| pair[0] == pair[1]).map(|pair| pair[0]).collect();
        shared.dedup();
        let mut answers = Post::default();
        for (message, (dofs, _)) in came.iter().zip(lists) {
            for (place, dof) in dofs[1..].iter().enumerate() {
                let is_shared = u64::from(shared.binary_search(dof).is_ok()) * SHARED;
                match prescribed.get(dof) {
                    Some(value) => {
                        let words = answers.to(message.rank);
                        words.extend([(place as u64) << 2 | PRESCRIBED | is_shared, value.to_bits()]);
                    }
                    None if is_shared != 0 => answers.to(message.rank).push((place as u64) << 2 | SHARED),
                    None => (),
                }
            }
        }
        (fault.map_or(Ok(Self { prescribed }), Err), answers)
    }
}

impl Known {
    fn of_answers(came: &[crate::Message], touched: &Touched, layout: &Layout) -> Self {
        let count = touched.dofs.len();
        let mut known = Self { shared: vec![false; count], free: vec![true; count], given: BTreeMap::new() };
        for message in came {
            let first = touched.dofs.partition_point(|&dof| dof < layout.owned(message.rank).start);
            let mut words = message.words.iter();
            while let Some(&word) = words.next() {
                let place = first + (word >> 2) as usize;
                known.shared[place] = word & SHARED != 0;
                if word & PRESCRIBED != 0 {
                    known.free[place] = false;
                    known.given.insert(place as u32, words.next().map_or(0.0, |&bits| real(bits)));
                }
            }
        }
        known
    }
}

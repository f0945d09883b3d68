//! The owner of a DOF tells the ranks that use it whether other ranks use it too, and whether it is prescribed.
//!
//! Each rank sends each DOF that it uses but does not own to the owner, 8 bytes each. An owner answers only for DOFs that are shared, that
//! are prescribed, or that have a faint coefficient (one that may be rounding).

use std::collections::BTreeMap;

use super::{Layout, TouchedDofs};
use crate::ranks::{Message, Outbox, Ranks, real};
use crate::share::ShareError;

/// Flags and prescribed values of the DOFs of a rank's equations, by the index of the DOF in [`TouchedDofs`].
pub(crate) struct KnownDofs {
    pub flags: Vec<DofFlags>,
    /// Values of the prescribed DOFs, by the index of the DOF in [`TouchedDofs`].
    pub prescribed: BTreeMap<u32, f64>,
}

/// Flags of a DOF: shared, prescribed, and faint (a coefficient may be rounding).
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct DofFlags(u8);

/// The prescribed values of the DOFs that a rank owns.
#[derive(Clone, Debug)]
pub(crate) struct Directory {
    /// Values of the prescribed DOFs, by global DOF number.
    pub prescribed: BTreeMap<u64, f64>,
}

const SHARED: u8 = 1;
const PRESCRIBED: u8 = 2;
const FAINT: u8 = 4;
/// Number of bits for the flags in a word of an answer; the bits above hold the position of the DOF.
const BITS: u32 = 3;
/// Marks a DOF with a faint coefficient in the message to its owner.
const FAINT_DOF: u64 = 1 << 63;

impl DofFlags {
    /// Whether equations of other ranks contain this DOF too.
    pub fn is_shared(self) -> bool {
        self.0 & SHARED != 0
    }

    pub fn is_free(self) -> bool {
        self.0 & PRESCRIBED == 0
    }

    /// Whether a coefficient of this DOF may be rounding, on any rank.
    pub fn is_faint(self) -> bool {
        self.0 & FAINT != 0
    }
}

impl Directory {
    /// Exchanges flags and prescribed values with the owners of the DOFs. `prescribed` may contain DOFs of any owner. Collective.
    pub fn new(
        ranks: &dyn Ranks,
        layout: &Layout,
        touched: &TouchedDofs,
        prescribed: &[(u64, f64)],
    ) -> (Result<Self, ShareError>, KnownDofs) {
        let values = prescriptions(ranks, layout, prescribed);
        let mut known = KnownDofs::own(touched);
        let mut post = Outbox::default();
        let own = layout.owned(ranks.rank());
        for (&dof, column) in touched.dofs.iter().zip(&touched.columns).filter(|(dof, _)| !own.contains(dof)) {
            post.to(layout.owner(dof)).push(if column.is_faint { dof | FAINT_DOF } else { dof });
        }
        let came = post.send(ranks);
        let directory = Self { prescribed: values.as_ref().map_or_else(|_| BTreeMap::new(), Clone::clone) };
        let answers = directory.answers(&came, touched, &mut known);
        known.receive(&answers.send(ranks), touched, layout);
        (values.map(|_| directory), known)
    }

    /// The answers to the ranks that asked: for each DOF with flags, its position in the rank's message, the flags, and the prescribed
    /// value if there is one. Also merges the flags that other ranks sent into those of this rank.
    fn answers(&self, came: &[Message], touched: &TouchedDofs, known: &mut KnownDofs) -> Outbox {
        let mut flags: BTreeMap<u64, u8> = BTreeMap::new();
        for &word in came.iter().flat_map(|message| &message.words) {
            let faint = if word & FAINT_DOF == 0 { 0 } else { FAINT };
            flags.entry(word & !FAINT_DOF).and_modify(|bits| *bits |= SHARED | faint).or_insert(faint);
        }
        for (dof, bits) in &mut flags {
            if let Ok(place) = touched.dofs.binary_search(dof) {
                *bits |= SHARED | known.flags[place].0;
                known.flags[place].0 = *bits;
            }
        }
        for (dof, &value) in &self.prescribed {
            if let Ok(place) = touched.dofs.binary_search(dof) {
                known.flags[place].0 |= PRESCRIBED;
                known.prescribed.insert(place as u32, value);
            }
            flags.entry(*dof).and_modify(|bits| *bits |= PRESCRIBED);
        }
        let mut answers = Outbox::default();
        for message in came {
            for (place, word) in message.words.iter().enumerate() {
                let dof = word & !FAINT_DOF;
                let bits = flags.get(&dof).copied().unwrap_or_default();
                if bits != 0 {
                    let words = answers.to(message.rank);
                    words.push((place as u64) << BITS | u64::from(bits));
                    words.extend(self.prescribed.get(&dof).map(|value| value.to_bits()));
                }
            }
        }
        answers
    }
}

/// The prescribed DOFs that this rank owns, with the values that any rank gave; an error if two values differ. Collective.
fn prescriptions(
    ranks: &dyn Ranks,
    layout: &Layout,
    prescribed: &[(u64, f64)],
) -> Result<BTreeMap<u64, f64>, ShareError> {
    let mut post = Outbox::default();
    prescribed.iter().for_each(|&(dof, value)| post.to(layout.owner(dof)).extend([dof, value.to_bits()]));
    let mut values: BTreeMap<u64, f64> = BTreeMap::new();
    for (_, [dof, bits]) in post.send_records(ranks) {
        let value = real(bits);
        let first = *values.entry(dof).or_insert(value);
        if first != value {
            return Err(ShareError::PrescribedTwice { dof, first, second: value });
        }
    }
    Ok(values)
}

impl KnownDofs {
    /// The flags that follow from the rank's own equations.
    fn own(touched: &TouchedDofs) -> Self {
        let flags = touched.columns.iter().map(|column| DofFlags(if column.is_faint { FAINT } else { 0 }));
        Self { flags: flags.collect(), prescribed: BTreeMap::new() }
    }

    fn receive(&mut self, came: &[Message], touched: &TouchedDofs, layout: &Layout) {
        for message in came {
            let first = touched.dofs.partition_point(|&dof| dof < layout.owned(message.rank).start);
            let mut words = message.words.iter();
            while let Some(&word) = words.next() {
                let place = first + (word >> BITS) as usize;
                let bits = (word & ((1 << BITS) - 1)) as u8;
                self.flags[place].0 |= bits;
                if bits & PRESCRIBED != 0 {
                    self.prescribed.insert(place as u32, words.next().map_or(0.0, |&bits| real(bits)));
                }
            }
        }
    }
}

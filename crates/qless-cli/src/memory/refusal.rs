//! The largest refused allocation: needed and allowed bytes.

use std::cell::Cell;
use std::fmt;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

use super::size::Size;
use super::system;

/// The limit that refused an allocation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum By {
    /// The option `--memory`.
    Option,
    /// `ulimit -v`, which counts address space.
    AddressSpace,
    /// The system, for a limit that is not known.
    System,
}

/// One refusal, in bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Refusal {
    /// Bytes requested.
    pub wanted: usize,
    /// Bytes in use at that time.
    pub held: usize,
    pub allowed: usize,
    pub by: By,
}

static KEPT: [AtomicUsize; 4] = [const { AtomicUsize::new(0) }; 4];

thread_local! {
    static HERE: Cell<bool> = const { Cell::new(false) };
}

/// The refusal with the largest need in this process, if any.
pub fn largest() -> Option<Refusal> {
    let [wanted, held, allowed, by] = [0, 1, 2, 3].map(|k| KEPT[k].load(Relaxed));
    let by = [By::Option, By::AddressSpace, By::System][by.min(2)];
    (wanted > 0).then_some(Refusal { wanted, held, allowed, by })
}

/// Whether an allocation of this thread was refused.
pub fn is_here() -> bool {
    HERE.get()
}

impl Refusal {
    pub fn of_system(wanted: usize) -> Self {
        match system::address_space_allowed() {
            Some(allowed) => Self { wanted, held: system::address_space(), allowed, by: By::AddressSpace },
            None => Self { wanted, held: system::resident(), allowed: system::physical(), by: By::System },
        }
    }

    /// Records the refusal, unless an earlier one needed more: printing the backtrace of the earlier one may cause later refusals. Does not
    /// allocate.
    pub fn keep(self) {
        HERE.set(true);
        if largest().is_some_and(|kept| kept.needed() > self.needed()) {
            return;
        }
        let numbers = [self.wanted, self.held, self.allowed, self.by as usize];
        KEPT.iter().zip(numbers).for_each(|(kept, number)| kept.store(number, Relaxed));
    }

    fn needed(self) -> usize {
        self.held.saturating_add(self.wanted)
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        // This runs when memory has run out, so it must not allocate.
        let (needed, allowed) = (Size(self.needed()), Size(self.allowed));
        write!(f, "at least {needed}")?;
        if self.by == By::AddressSpace {
            write!(f, " of address space")?;
        }
        match self.wanted {
            // A library did not report the size of its allocation.
            0 => write!(f, " and more")?,
            wanted => write!(f, " ({} of them at once)", Size(wanted))?,
        }
        match self.by {
            By::Option => write!(f, " were needed and --memory allows {allowed}"),
            By::AddressSpace => write!(f, " were needed and `ulimit -v` allows {allowed}"),
            By::System => write!(f, " were needed and the machine, which has {allowed}, gave no more"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_words_have_both_numbers_and_who_refused() {
        let refusal = Refusal { wanted: 3 << 20, held: 6 << 20, allowed: 8 << 20, by: By::Option };
        assert_eq!(
            refusal.to_string(),
            "at least 9.0 MiB (3.0 MiB of them at once) were needed and --memory allows 8.0 MiB"
        );
        let refusal = Refusal { by: By::AddressSpace, ..refusal };
        assert!(refusal.to_string().ends_with("`ulimit -v` allows 8.0 MiB"), "{refusal}");
    }
}

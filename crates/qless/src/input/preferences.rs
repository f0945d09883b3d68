//! The user's preferences for slaves and kept equations. `presolve::peel`, `diagnosis::preferred_equations` and
//! `reduction::exchange_goals` apply them.

use std::collections::HashSet;

use crate::ConstraintSystem;
use crate::input::numbering::Numbering;

/// Preferences that hold as far as the equations allow. The unmet ones are reported
/// ([`crate::Analysis::unmet_equations`], [`crate::Reduction::unmet_masters`], [`crate::Reduction::unmet_slaves`]).
///
/// A set of DOFs can be the slaves if and only if their columns are a basis of all columns. So it is enough to exchange one slave for one
/// master, or one kept equation for one dependent equation, at a time. A preference stays unmet only if the equations or other preferences
/// rule it out. A preferred slave also stays unmet if it would exceed the bound of growth.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Preferences {
    /// DOFs (0-based) that must not be slaves, such as loaded ones or interfaces to other codes. A free DOF is a slave nevertheless if the
    /// equations fix it, or if they express it by other DOFs of this list only.
    pub masters: Vec<usize>,
    /// DOFs (0-based) preferred as slaves, as long as the bound of growth holds.
    pub slaves: Vec<usize>,
    /// Equations (0-based) to keep if other equations can be dropped instead.
    pub equations: Vec<usize>,
}

/// A setting out of its range.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum OptionError {
    /// The tolerance must lie strictly between 0 and 1.
    #[error("the tolerance is {0}; it must lie between 0 and 1, such as 1e-10")]
    Tolerance(f64),
    /// A relative noise must lie strictly between 0 and 1; a noise floor must be finite and at least 0.
    #[error("the noise is {0}; it must be a number between 0 and 1, or for floors at least 0")]
    Noise(f64),
    /// A list of noise floors must have one number for each equation.
    #[error("a list of noise floors has {found} numbers; the system has {expected} equations")]
    Floors {
        /// How many numbers were given.
        found: usize,
        /// How many equations there are.
        expected: usize,
    },
    /// The bound of growth must be at least 1, because a smaller one cannot always be reached.
    #[error("the growth bound is {0}; it must be a number of at least 1, such as 4")]
    Growth(f64),
    /// A preference names a DOF or equation that does not exist.
    #[error("a preference names {what} {found}, but there are {count} (numbers from 0 to {last})", last = .count.saturating_sub(1))]
    Preference {
        /// What the preference names: "DOF" or "equation".
        what: &'static str,
        /// The number given, 0-based.
        found: usize,
        /// How many DOFs or equations there are.
        count: usize,
    },
    /// A DOF cannot be preferred as a slave and excluded from being one.
    #[error("DOF {0} (from 0) is preferred as a slave and excluded from being one; take it out of one list")]
    Contradiction(usize),
}

impl Preferences {
    pub(crate) fn validate(&self, system: &ConstraintSystem) -> Result<(), OptionError> {
        within("DOF", &self.masters, system.dofs())?;
        within("DOF", &self.slaves, system.dofs())?;
        within("equation", &self.equations, system.equations())?;
        let masters: HashSet<_> = self.masters.iter().collect();
        self.slaves.iter().find(|j| masters.contains(j)).map_or(Ok(()), |&j| Err(OptionError::Contradiction(j)))
    }
}

fn within(what: &'static str, numbers: &[usize], count: usize) -> Result<(), OptionError> {
    let outside = numbers.iter().find(|&&k| k >= count);
    outside.map_or(Ok(()), |&found| Err(OptionError::Preference { what, found, count }))
}

/// Whether a DOF is preferred as a slave; variants ascend from the least to the most preferred.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum SlavePreference {
    Master,
    None,
    Slave,
}

/// The preference for every local DOF.
pub(crate) struct SlavePreferences(Vec<SlavePreference>);

impl SlavePreferences {
    pub fn new(preferences: &Preferences, numbering: &Numbering, dofs: usize) -> Self {
        if preferences.masters.is_empty() && preferences.slaves.is_empty() {
            return Self(Vec::new());
        }
        let mut by_user = vec![SlavePreference::None; dofs];
        preferences.slaves.iter().for_each(|&j| by_user[j] = SlavePreference::Slave);
        preferences.masters.iter().for_each(|&j| by_user[j] = SlavePreference::Master);
        Self(numbering.dofs.iter().map(|&j| by_user[j as usize]).collect())
    }

    pub fn of(&self, dof: u32) -> SlavePreference {
        self.0.get(dof as usize).copied().unwrap_or(SlavePreference::None)
    }

    /// Returns true if there is any preference.
    pub fn any(&self) -> bool {
        !self.0.is_empty()
    }

    /// Local DOFs with this preference.
    pub fn with(&self, wish: SlavePreference) -> impl Iterator<Item = u32> + '_ {
        self.0.iter().zip(0..).filter(move |(w, _)| **w == wish).map(|(_, j)| j)
    }
}

//! What a report comes to, in one word.

use super::Report;
use crate::Kind;

/// The worst that is said of any equation, or that not all of them are known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "lowercase"))]
#[non_exhaustive]
pub enum Status {
    /// All equations are independent.
    Independent,
    /// Some are combinations of others, and consistent with them.
    Redundant,
    /// Some contradict others: so they do whatever was left out.
    Conflicting,
    /// No conflict was found, but something that constrains was left out, with which there may be one.
    Incomplete,
}

impl From<Kind> for Status {
    fn from(kind: Kind) -> Self {
        match kind {
            Kind::Independent => Self::Independent,
            Kind::Redundant => Self::Redundant,
            Kind::Conflicting => Self::Conflicting,
        }
    }
}

impl Report {
    /// Says what constrains and was left out of the system.
    ///
    /// ```
    /// use qless::{Options, Report, Status, SystemBuilder, analyse};
    /// let mut builder = SystemBuilder::new(2);
    /// builder.equation([(0, 1.0), (1, -1.0)], 0.0);
    /// let analysis = analyse(&builder.build()?, &Options::default())?;
    /// let report = Report::new(&analysis, Report::TERMS);
    /// assert_eq!(report.status, Status::Independent);
    /// let report = report.with_left_out(vec!["line 7: RSPLINE is not read".to_owned()]);
    /// assert_eq!((report.status, report.counts.independent), (Status::Incomplete, 1));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn with_left_out(mut self, what: Vec<String>) -> Self {
        if !what.is_empty() && self.status != Status::Conflicting {
            self.status = Status::Incomplete;
        }
        self.incomplete = what;
        self
    }
}

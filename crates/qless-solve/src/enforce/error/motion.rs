//! A motion that nothing holds, and its words.

/// DOFs that take part by less than this share of the largest are not named; in units without units.
const SHARE: f64 = 1e-6;
/// DOFs in the message.
const NAMED: usize = 8;

/// A motion that constraints and prescribed DOFs leave free, up to rounding.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Motion {
    /// The DOFs that move, ascending.
    pub dofs: Vec<usize>,
    /// How far each of them moves, in its own unit; the largest number is 1 or -1.
    pub motion: Vec<f64>,
    /// The largest force that holds it, relative to its terms: rounding, if not zero.
    pub held: f64,
}

impl Motion {
    /// From a null vector of all DOFs and the unit of each.
    pub(in super::super) fn new(u: &[f64], units: &[f64], held: f64) -> Self {
        let sizes: Vec<f64> = u.iter().zip(units).map(|(u, s)| u.abs() / s).collect();
        let most = sizes.iter().fold(0.0, |most: f64, size| most.max(*size));
        let dofs: Vec<usize> = (0..u.len()).filter(|&j| sizes[j] > SHARE * most).collect();
        let largest =
            dofs.iter().fold(0.0, |largest: f64, &j| if u[j].abs() > f64::abs(largest) { u[j] } else { largest });
        let motion = dofs.iter().map(|&j| u[j] / largest).collect();
        Self { dofs, motion, held }
    }

    /// The same where DOFs have other numbers, ascending.
    pub(in super::super) fn of(mut self, dofs: &[usize]) -> Self {
        self.dofs.iter_mut().for_each(|j| *j = dofs[*j]);
        self
    }

    /// Both, each with its largest number 1 or -1.
    pub(in super::super) fn and(&self, other: &Self) -> Self {
        let moves = |motion: &Self| motion.dofs.iter().copied().zip(motion.motion.clone()).collect::<Vec<_>>();
        let mut both = [moves(self), moves(other)].concat();
        both.sort_by_key(|&(dof, _)| dof);
        let (dofs, motion) = both.into_iter().unzip();
        Self { dofs, motion, held: self.held.max(other.held) }
    }
}

impl std::fmt::Display for Motion {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if self.dofs.is_empty() {
            return write!(f, "the equations depend on one another up to rounding, so that their multipliers are free");
        }
        write!(f, "nothing holds the motion of DOF ")?;
        for (place, (dof, value)) in self.dofs.iter().zip(&self.motion).take(NAMED).enumerate() {
            write!(f, "{}{dof} ({value:+.3})", if place > 0 { ", " } else { "" })?;
        }
        let others = self.dofs.len().saturating_sub(NAMED);
        if others > 0 {
            write!(f, " and {others} others")?;
        }
        write!(f, " but forces of {:.1e} of what they are made of, which is rounding", self.held)
    }
}

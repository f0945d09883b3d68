//! The arrays that a set evaluates into, and their update after changes of the set.

use qless::common::Identity;
use qless::{ArgumentError, Csr};

use crate::equations::hessian::HessianPlan;
use crate::set::ConstraintSet;

/// The results c, G and H of an evaluation of a set, with the patterns of the set at that time. Any other set refuses this evaluation.
#[derive(Clone, Debug)]
pub struct Evaluation {
    /// The set that allocated this evaluation.
    set: Identity,
    /// The configuration of the last evaluation of c and G.
    pub(super) u: Vec<f64>,
    pub(crate) c: Vec<f64>,
    pub(crate) g: Csr,
    pub(super) h: Csr,
    /// The version of the set at which c and G were evaluated.
    pub(super) evaluated: Identity,
    /// Identities of the patterns that G and H have.
    patterns: [Identity; 2],
}

impl PartialEq for Evaluation {
    /// Compares c, G and H; the set and the configuration may differ.
    fn eq(&self, other: &Self) -> bool {
        (&self.c, &self.g, &self.h) == (&other.c, &other.g, &other.h)
    }
}

impl Evaluation {
    /// The configuration of the last evaluation.
    pub fn u(&self) -> &[f64] {
        &self.u
    }

    /// Constraint values, length m.
    pub fn c(&self) -> &[f64] {
        &self.c
    }

    /// Sets c to zero, so that [`ConstraintSet::linearised`](crate::ConstraintSet::linearised) gives `G du = 0`.
    pub fn clear_values(&mut self) {
        self.c.fill(0.0);
    }

    /// Jacobian, m x n.
    pub fn g(&self) -> &Csr {
        &self.g
    }

    /// Effective Hessian, n x n, symmetric, both halves stored. It has no entries before its first evaluation.
    pub fn h(&self) -> &Csr {
        &self.h
    }
}

impl ConstraintSet {
    /// Arrays of the right size, with the pattern of G and the coefficients of linear equations, which are constant.
    ///
    /// The first evaluation of H makes its pattern. When the set changes, the next evaluation updates the arrays.
    pub fn allocate(&self) -> Evaluation {
        Evaluation {
            set: self.register.identity,
            u: vec![0.0; self.dofs],
            c: vec![0.0; self.equations()],
            g: self.whole_pattern(),
            h: Csr::zero(self.dofs, self.dofs).expect("the set has checked DOFs and sizes"),
            evaluated: Identity::NONE,
            patterns: [self.pattern.get(), Identity::NONE],
        }
    }

    /// After changes of the set, gives c the length and G the pattern of the current equations.
    pub(super) fn follow(&self, evaluation: &mut Evaluation) -> Result<(), ArgumentError> {
        self.own("the evaluation", evaluation.set)?;
        if evaluation.evaluated != self.version.get() {
            evaluation.evaluated = Identity::NONE;
        }
        if evaluation.patterns[0] != self.pattern.get() {
            evaluation.g = self.whole_pattern();
            evaluation.c.resize(self.equations(), 0.0);
            evaluation.patterns[0] = self.pattern.get();
        }
        Ok(())
    }

    /// After changes of the set, gives H the pattern of the current equations. Returns the plan by which their Hessians are summed.
    pub(super) fn follow_hessian(&self, evaluation: &mut Evaluation) -> &HessianPlan {
        let plan = self.plan();
        if evaluation.patterns[1] != plan.stamp {
            evaluation.h = plan.pattern().expect("the set has checked DOFs and sizes");
            evaluation.patterns[1] = plan.stamp;
        }
        plan
    }

    /// Checks that the evaluation belongs to this set, and that the set has not changed since c and G were evaluated.
    pub(super) fn current(&self, evaluation: &Evaluation) -> Result<(), ArgumentError> {
        self.own("the evaluation", evaluation.set)?;
        let what = "c and G";
        if evaluation.evaluated == self.version.get() { Ok(()) } else { Err(ArgumentError::Outdated { what }) }
    }

    /// G with the coefficients of the linear equations, which are constant, and with zeros in the rows of the nonlinear equations.
    pub(super) fn whole_pattern(&self) -> Csr {
        let (mut start, mut col) = (self.linear.start.clone(), self.linear.col.clone());
        self.nonlinear.batches.iter().for_each(|batch| batch.write_pattern(&mut start, &mut col));
        let mut val = self.linear.val.clone();
        val.resize(col.len(), 0.0);
        Csr::from_parts(self.dofs, start, col, val).expect("the set has checked DOFs and sizes")
    }
}

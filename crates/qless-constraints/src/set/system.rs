//! `G du = -c`: the set linearised at u, as linear equations for `qless`.

use qless::{ConstraintSystem, SystemBuilder};

use super::{ConstraintSet, LineariseError, Quantities};

impl ConstraintSet {
    /// The linearised equations `G du = -c` with the labels of the set; `prescribed` are increments `(DOF, du)`.
    ///
    /// ```
    /// use qless::{Options, analyse};
    /// use qless_constraints::ConstraintSet;
    /// use qless_constraints::types::Equal;
    /// let mut builder = ConstraintSet::builder(3);
    /// for (label, dofs) in [("ab", [0, 1]), ("bc", [1, 2]), ("ca", [2, 0])] {
    ///     builder.add(label, Equal::new(dofs))?;
    /// }
    /// let set = builder.build()?;
    /// let mut quantities = set.allocate();
    /// set.evaluate(&[0.0; 3], &mut quantities)?;
    /// let system = set.linearised(&quantities, &[])?;
    /// assert_eq!(system.equation_label(2), "ca");
    /// assert_eq!(analyse(&system, &Options::default())?.rank(), 2);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`LineariseError`] for quantities of another set, if an entry of G or c is not finite at this u, or a prescribed DOF is not valid.
    pub fn linearised(
        &self,
        quantities: &Quantities,
        prescribed: &[(usize, f64)],
    ) -> Result<ConstraintSystem, LineariseError> {
        self.current(quantities)?;
        let mut builder = SystemBuilder::new(self.dofs);
        for (row, &c) in quantities.c.iter().enumerate() {
            builder.labelled_equation(self.label(row)?, quantities.g.row(row), -c);
        }
        prescribed.iter().for_each(|&(dof, increment)| builder.prescribe(dof, increment));
        Ok(builder.build()?)
    }
}

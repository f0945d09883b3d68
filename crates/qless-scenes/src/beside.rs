//! `diag(A, B)`: two scenes on DOFs of their own.

use qless::{ConstraintSystem, SystemBuilder};

use crate::{Dof, Scene, SceneError, Truth};

impl Scene {
    /// Both scenes in one system: first all equations and DOFs of this one, then those of the other.
    ///
    /// What is known of both is known of the whole; it is ambiguous, or conflicting, where either is. Labels are kept where
    /// a side has any, places of DOFs where both have them. To mix rows and DOFs, [`Scene::shuffle`] the result.
    ///
    /// ```
    /// use qless_scenes::families::{Near, near, rotations};
    /// let scene = near(2, 1e-8, Near::Own)?.beside(&rotations(50)?)?;
    /// assert_eq!((scene.system.equations(), scene.system.dofs()), (6 + 100, 14 + 102));
    /// assert!(scene.truth.rank_free == Some(106) && scene.truth.ambiguous);
    /// # Ok::<(), qless_scenes::SceneError>(())
    /// ```
    ///
    /// # Errors
    /// [`SceneError::System`] where the system becomes too large.
    pub fn beside(&self, other: &Self) -> Result<Self, SceneError> {
        let first = self.system.dofs();
        let mut builder = SystemBuilder::new(first + other.system.dofs());
        append(&mut builder, &self.system, 0);
        append(&mut builder, &other.system, first);
        if !(self.system.dof_labels().is_empty() && other.system.dof_labels().is_empty()) {
            let names = |system: &ConstraintSystem| (0..system.dofs()).map(|j| system.dof_label(j)).collect::<Vec<_>>();
            builder.dof_labels([names(&self.system), names(&other.system)].concat());
        }
        let placed = !self.dofs.is_empty() && !other.dofs.is_empty();
        let moved = |dof: &Dof| Dof { node: dof.node.saturating_add(self.nodes.len()), ..*dof };
        let dofs = self.dofs.iter().copied().chain(other.dofs.iter().map(moved)).filter(|_| placed).collect();
        let nodes = if placed { [&self.nodes[..], &other.nodes].concat() } else { Vec::new() };
        Ok(Self { system: builder.build()?, truth: self.truth.beside(&other.truth, first), nodes, dofs })
    }
}

impl Truth {
    /// What holds of two systems without common DOFs, the second one's DOFs being numbered from `first` on.
    fn beside(&self, other: &Self, first: usize) -> Self {
        let sum = |a: Option<usize>, b: Option<usize>| Some(a?.saturating_add(b?));
        let moved = |&(dof, value): &(usize, f64)| (first.saturating_add(dof), value);
        let generated = self.generated.as_ref().zip(other.generated.as_ref());
        Self {
            rank_free: sum(self.rank_free, other.rank_free),
            redundant: sum(self.redundant, other.redundant),
            conflicting: self.conflicting || other.conflicting,
            generated: generated.map(|(a, b)| a.iter().copied().chain(b.iter().map(moved)).collect()),
            ambiguous: self.ambiguous || other.ambiguous,
        }
    }
}

/// Equations and boundary conditions, on DOFs from `first` on.
fn append(builder: &mut SystemBuilder, system: &ConstraintSystem, first: usize) {
    for row in 0..system.equations() {
        let terms = system.matrix().row(row).map(|(j, v)| (first + j, v));
        match system.equation_labels().get(row) {
            Some(label) => builder.labelled_equation(label, terms, system.rhs()[row]),
            None => builder.equation(terms, system.rhs()[row]),
        };
    }
    system.prescribed().iter().for_each(|&(dof, value)| builder.prescribe(first + dof, value));
}

//! Numbers DOFs by first appearance: local DOF l is the l-th DOF (from 0) that appears when the equations are read row by row.
//!
//! Models may number their DOFs in random order, but equations that share DOFs are usually adjacent. With numbers by first appearance,
//! every stage reads an array over DOFs nearly in sequence, and DOFs outside all equations cost nothing.
//! O(nnz + n) time, 4 nnz + 5 n bytes.

mod pass;

use pass::Pass;

use crate::{ConstraintSystem, Csr};

/// The local number of every coefficient's DOF, and the user's data of each local DOF.
pub(crate) struct Numbering {
    /// Local DOF of each entry of C, in the order of C.
    entries: Vec<u32>,
    /// The user's number of each local DOF.
    pub dofs: Vec<u32>,
    /// Whether each local DOF is free.
    pub free: Vec<bool>,
    /// Local prescribed DOFs with their values, in the user's order.
    prescribed: Vec<(usize, f64)>,
    /// The place of each prescribed DOF in the user's list.
    places: Vec<u32>,
}

/// The number of rows that contain a DOF, and the exclusive or of their indices. For a single row, this is the index of the row.
#[derive(Clone, Copy, Default)]
pub(crate) struct Column {
    pub count: u32,
    pub rows: u32,
}

impl Column {
    /// Adds a row that contains the DOF.
    #[inline]
    pub fn enter(&mut self, row: u32) {
        self.count += 1;
        self.rows ^= row;
    }

    /// Adds the rows that contain the same DOF in the other half of the equations.
    #[inline]
    fn join(&mut self, other: Self) {
        self.count += other.count;
        self.rows ^= other.rows;
    }

    /// Removes a row that contains the DOF.
    #[inline]
    pub fn leave(&mut self, row: u32) {
        self.count -= 1;
        self.rows ^= row;
    }
}

/// Smallest and largest exponent of a row's coefficients, biased as in the bits: plus 1023, and 0 for subnormal numbers.
#[derive(Clone, Copy)]
pub(crate) struct Exponents {
    pub least: u16,
    pub most: u16,
}

impl Exponents {
    /// Returns true if there are coefficients and all of them are subnormal.
    pub fn is_subnormal(self) -> bool {
        self.most == 0 && self.least != u16::MAX
    }

    /// The range of a row without coefficients.
    const NONE: Self = Self { least: u16::MAX, most: 0 };

    #[inline]
    fn with(self, value: f64) -> Self {
        let biased = ((value.to_bits() >> 52) & 0x7ff) as u16;
        Self { least: self.least.min(biased), most: self.most.max(biased) }
    }
}

impl Numbering {
    /// Numbers the DOFs. The same pass counts the rows of each DOF and finds the range of exponents of each row.
    pub fn new(system: &ConstraintSystem) -> (Self, Vec<Column>, Vec<Exponents>) {
        let (entries, pass) = pass::number(system.matrix());
        let named = system.prescribed().iter().zip(0..).filter_map(|(&(j, value), place)| {
            let l = pass.find(j)?;
            Some(((l as usize, value), place))
        });
        let (prescribed, places): (Vec<_>, Vec<_>) = named.unzip();
        let Pass { dofs, columns, exponents, .. } = pass;
        let mut free = vec![true; dofs.len()];
        prescribed.iter().for_each(|&(l, _)| free[l] = false);
        (Self { entries, dofs, free, prescribed, places }, columns, exponents)
    }

    /// The system in local numbers, with `rhs` as its right-hand sides.
    pub fn view<'a>(&'a self, system: &'a ConstraintSystem, rhs: &'a [f64]) -> LocalSystem<'a> {
        LocalSystem { system, matrix: system.matrix(), numbering: self, rhs, prescribed: &self.prescribed }
    }
}

/// A [`ConstraintSystem`] in local numbers.
#[derive(Clone, Copy)]
pub(crate) struct LocalSystem<'a> {
    system: &'a ConstraintSystem,
    matrix: &'a Csr,
    pub numbering: &'a Numbering,
    rhs: &'a [f64],
    prescribed: &'a [(usize, f64)],
}

impl<'a> LocalSystem<'a> {
    /// The system with other values of the prescribed DOFs, in the order of [`LocalSystem::prescribed`].
    pub fn with_prescribed(self, prescribed: &'a [(usize, f64)]) -> Self {
        Self { prescribed, ..self }
    }

    pub fn equations(self) -> usize {
        self.system.equations()
    }

    /// Number of DOFs that occur in equations.
    pub fn dofs(self) -> usize {
        self.numbering.dofs.len()
    }

    pub fn rhs(self) -> &'a [f64] {
        self.rhs
    }

    #[inline]
    pub fn free(self) -> &'a [bool] {
        &self.numbering.free
    }

    /// Local prescribed DOFs and their values.
    pub fn prescribed(self) -> &'a [(usize, f64)] {
        self.prescribed
    }

    /// Local prescribed DOFs and their places in the user's list.
    pub fn prescribed_places(self) -> impl Iterator<Item = (usize, usize)> + 'a {
        let numbering = self.numbering;
        numbering.prescribed.iter().zip(&numbering.places).map(|(&(l, _), &place)| (l, place as usize))
    }

    /// DOFs and coefficients of an equation, ascending by the user's numbers.
    #[inline]
    pub fn parts(self, i: usize) -> (&'a [u32], &'a [f64]) {
        let c = self.matrix;
        let range = c.start[i]..c.start[i + 1];
        (&self.numbering.entries[range.clone()], &c.val[range])
    }

    /// Number of coefficients of an equation.
    #[inline]
    pub fn length(self, i: usize) -> usize {
        let start = &self.matrix.start;
        start[i + 1] - start[i]
    }

    /// The entries `(DOF, coefficient)` of an equation.
    #[inline]
    pub fn row(self, i: usize) -> impl ExactSizeIterator<Item = (usize, f64)> + Clone + 'a {
        let (dofs, values) = self.parts(i);
        dofs.iter().zip(values).map(|(&j, &v)| (j as usize, v))
    }

    /// The coefficient of a DOF in an equation that contains it.
    pub fn coefficient(self, i: usize, dof: u32) -> f64 {
        let (dofs, values) = self.parts(i);
        dofs.iter().position(|&j| j == dof).map_or(1.0, |k| values[k])
    }
}

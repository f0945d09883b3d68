//! Faults that only some cards can have, such as those of Nastran's fields and of rigid elements.

/// A fault that only some cards can have, and its remedy.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CardFault {
    /// A line in free field has data after the field of its continuation mark.
    #[error("{found} follows the {count} data fields and the continuation field of the line; use a continuation line")]
    TooManyFields {
        /// The number of data fields that a line may have.
        count: usize,
        /// The surplus text, quoted.
        found: String,
    },
    /// A card gives a scalar point a component above 1.
    #[error("{node} is a scalar point, which has no component {component}; write 0 or leave the field blank")]
    ScalarComponent {
        /// The point.
        node: u32,
        /// The component.
        component: u8,
    },
    /// A card gives a grid point without a component.
    #[error("{node} is a grid point and needs a component; write digits from 1 to 6")]
    NoComponent {
        /// The number of the grid point.
        node: u32,
    },
    /// The line that should continue a card is missing.
    #[error(
        "the card continues at `+{expected}`, but no remaining line begins with it; add the line or remove the mark"
    )]
    NoContinuation {
        /// The name of the continuation line that the card expects.
        expected: Box<str>,
    },
    /// No card expects this continuation line.
    #[error("the line continues a card at `+{found}`, but no card names it; put the line right after its card")]
    Orphan {
        /// The name at the start of the continuation line.
        found: Box<str>,
    },
    /// The solver does not find this continuation line.
    #[error("MYSTRAN silently ignores this continuation, because it does not follow its card directly; move it there")]
    ContinuationDropped,
    /// A line has data beyond its last field, which the solver does not read.
    #[error("MYSTRAN silently ignores everything after the 8 data fields of a line; use a continuation line")]
    FieldsDropped,
    /// Two elements have the same number.
    #[error("element {id} is already defined in {other}; give it another number")]
    ElementTwice {
        /// The element number.
        id: u32,
        /// File and line of the other card.
        other: Box<str>,
    },
    /// The two ends of a joint are at different places.
    #[error("grid points {a} and {b} of the joint have to be at the same place; correct one of them")]
    JointApart {
        /// The grid point at one end.
        a: u32,
        /// The grid point at the other end.
        b: u32,
    },
    /// Two cards define the same object differently.
    #[error("{what} {id} has another definition in {other}; keep one of the two")]
    DefinedTwice {
        /// The kind of the object: "grid point", "coordinate system" or "GRDSET".
        what: &'static str,
        /// The number of the object.
        id: u32,
        /// File and line of the other card.
        other: Box<str>,
    },
    /// A card gives a rigid body more or fewer than six independent components.
    #[error("{found} independent components are given; a rigid body has 6, give exactly that many")]
    IndependentCount {
        /// Number of independent components found.
        found: usize,
    },
    /// The six independent components of a rigid body leave some rigid motion free.
    #[error("the 6 independent components do not fix the body: some motion moves none of them; choose others")]
    IndependentSingular,
    /// A component is both dependent and independent.
    #[error("{node}:{component} is both dependent and independent; remove it from one list")]
    OnBothSides {
        /// The grid point.
        node: u32,
        /// The component.
        component: u8,
    },
    /// The dependent component of a rod is at right angles to the rod.
    #[error("{node}:{component} is at right angles to the rod and cannot depend on it; choose another component")]
    AcrossRod {
        /// The grid point.
        node: u32,
        /// The component.
        component: u8,
    },
    /// MYSTRAN drops terms of an equation of a weighted mean.
    #[error(
        "MYSTRAN drops terms of the equation of {node}:{component}, which needs {node}:{missing}; write 123456 as REFC"
    )]
    MeanCut {
        /// The reference grid point.
        node: u32,
        /// The component of the equation.
        component: u8,
        /// The component that the equation needs, and REFC lacks.
        missing: u8,
    },
    /// A weighted mean does not determine a component of its reference point.
    #[error(
        "the connected components do not determine {node}:{component}; connect more of them, or remove it from REFC"
    )]
    MeanUndetermined {
        /// The reference grid point.
        node: u32,
        /// The component.
        component: u8,
    },
    /// The list after UM of an `RBE3` has the wrong length.
    #[error("UM names {found} components, but REFC has {expected}; name as many")]
    UmCount {
        /// The number of components in the UM list.
        found: usize,
        /// The number of components in REFC, which the UM list must have.
        expected: usize,
    },
    /// The equations of an `RBE3` cannot be solved for the components in its UM list.
    #[error("the element cannot be solved for the components after UM; choose others that it connects")]
    UmSingular,
    /// An element connects no components.
    #[error("nothing is connected; name at least one grid point and component")]
    NothingConnected,
}

//! Faults that only some cards can have, such as those of Nastran's fields and of rigid elements.

/// A fault that only some cards can have, and its remedy.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CardFault {
    /// A line in free field has data beyond the field of its continuation mark.
    #[error("{found} follows the {count} data fields and the continuation field of the line; use a continuation line")]
    TooManyFields {
        /// Data fields a line has.
        count: usize,
        /// The surplus text, quoted.
        found: String,
    },
    /// A scalar point is given a component above 1.
    #[error("{node} is a scalar point, which has no component {component}; write 0 or leave the field blank")]
    ScalarComponent {
        /// The point.
        node: u32,
        /// The component.
        component: u8,
    },
    /// A grid point is given no component.
    #[error("{node} is a grid point and needs a component; write digits from 1 to 6")]
    NoComponent {
        /// The grid point.
        node: u32,
    },
    /// The line that should continue a card is missing.
    #[error(
        "the card continues at `+{expected}`, but no remaining line begins with it; add the line or remove the mark"
    )]
    NoContinuation {
        /// The continuation name in the card.
        expected: Box<str>,
    },
    /// No card names this continuation line.
    #[error("the line continues a card at `+{found}`, but no card names it; put the line right after its card")]
    Orphan {
        /// The continuation name at the start of the line.
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
        /// One end.
        a: u32,
        /// The other end.
        b: u32,
    },
    /// One object has two different definitions.
    #[error("{what} {id} has another definition in {other}; keep one of the two")]
    DefinedTwice {
        /// "grid point", "coordinate system", "GRDSET".
        what: &'static str,
        /// Its number.
        id: u32,
        /// File and line of the other card.
        other: Box<str>,
    },
    /// A rigid body is given more or fewer than six independent components.
    #[error("{found} independent components are given; a rigid body has 6, give exactly that many")]
    IndependentCount {
        /// Number of independent components found.
        found: usize,
    },
    /// Six independent components leave some rigid motion free.
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
    /// The UM list of an element has the wrong length.
    #[error("UM names {found} components, but REFC has {expected}; name as many")]
    UmCount {
        /// Components after UM.
        found: usize,
        /// Components of REFC.
        expected: usize,
    },
    /// The element's equations cannot be solved for the UM components.
    #[error("the element cannot be solved for the components after UM; choose others that it connects")]
    UmSingular,
    /// An element connects no components.
    #[error("nothing is connected; name at least one grid point and component")]
    NothingConnected,
}

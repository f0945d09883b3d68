//! What can be wrong in a Nastran card beside what can be wrong in any deck, and what to do about it.

/// What is wrong in a Nastran card.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CardFault {
    /// A line in free field with data beyond the place of its mark.
    #[error(
        "{found} stands after the {count} data fields of the line and the place of a mark; go on in a continuation line"
    )]
    TooManyFields {
        /// Data fields a line has.
        count: usize,
        /// The text beyond, quoted.
        found: String,
    },
    /// A component above 1 of a scalar point.
    #[error("{node} is a scalar point, which has no component {component}; write 0 or leave the field blank")]
    ScalarComponent {
        /// The point.
        node: u32,
        /// The component.
        component: u8,
    },
    /// No component where a grid point needs one.
    #[error("{node} is a grid point, of which a component has to be given; write digits from 1 to 6")]
    NoComponent {
        /// The grid point.
        node: u32,
    },
    /// A card that goes on in a line that is not there.
    #[error("the card goes on as `+{expected}`, but no line left begins with that; add the line or remove the mark")]
    NoContinuation {
        /// The name that the card gives its continuation.
        expected: Box<str>,
    },
    /// A continuation that no card names.
    #[error("the line goes on with a card as `+{found}`, but no card names it; put it right after its card")]
    Orphan {
        /// The name that the line begins with.
        found: Box<str>,
    },
    /// A continuation that the solver does not find.
    #[error("MYSTRAN drops this continuation in silence, as it is not the line after its card; put it there")]
    ContinuationDropped,
    /// Data beyond the last field of a line, which the solver does not read.
    #[error("MYSTRAN drops what stands after the 8 data fields of a line in silence; go on in a continuation line")]
    FieldsDropped,
    /// Two elements of one number.
    #[error("element {id} is that of {other} already; give it another number")]
    ElementTwice {
        /// The number.
        id: u32,
        /// File and line of the other.
        other: Box<str>,
    },
    /// A joint whose ends are apart.
    #[error("grid points {a} and {b} of the joint have to be at the same place; correct one of them")]
    JointApart {
        /// One end.
        a: u32,
        /// The other.
        b: u32,
    },
    /// Two definitions of one thing.
    #[error("{what} {id} is defined otherwise in {other}; keep one of the two")]
    DefinedTwice {
        /// "grid point", "coordinate system", "GRDSET".
        what: &'static str,
        /// Its number.
        id: u32,
        /// File and line of the other.
        other: Box<str>,
    },
    /// Not six independent components.
    #[error("{found} independent components are given; a rigid body has 6, give exactly that many")]
    IndependentCount {
        /// How many were found.
        found: usize,
    },
    /// Six components that leave a motion free.
    #[error("the 6 independent components do not fix the body: some motion moves none of them; choose others")]
    IndependentSingular,
    /// A component that is dependent and independent.
    #[error("{node}:{component} is both dependent and independent; remove it from one list")]
    OnBothSides {
        /// The grid point.
        node: u32,
        /// The component.
        component: u8,
    },
    /// A rod whose dependent component is at right angles.
    #[error("{node}:{component} is at right angles to the rod and cannot depend on it; choose another component")]
    AcrossRod {
        /// The grid point.
        node: u32,
        /// The component.
        component: u8,
    },
    /// A mean that does not determine a component of its reference.
    #[error(
        "the connected components do not determine {node}:{component}; connect more of them, or remove it from REFC"
    )]
    MeanUndetermined {
        /// The reference grid point.
        node: u32,
        /// The component.
        component: u8,
    },
    /// An UM list of the wrong length.
    #[error("UM names {found} components, but REFC has {expected}; name as many")]
    UmCount {
        /// Components after UM.
        found: usize,
        /// Components of REFC.
        expected: usize,
    },
    /// The UM components cannot be solved for.
    #[error("the element cannot be solved for the components after UM; choose others that it connects")]
    UmSingular,
    /// A constraint that couples a component to nothing.
    #[error("nothing is connected; name at least one grid point and component")]
    NothingConnected,
}

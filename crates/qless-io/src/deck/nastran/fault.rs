//! What can be wrong in a Nastran card, and what to do about it.

use crate::NumberFault;
use crate::fault::quote;

/// What is wrong in a card. Where it is (file, line, card, field) stands beside it.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CardFault {
    /// A line in free field with data beyond its last field.
    #[error("{found} stands after the {count} data fields of the line; go on in a continuation line")]
    TooManyFields {
        /// Data fields a line has.
        count: usize,
        /// The text beyond.
        found: String,
    },
    /// A field that has to be filled is blank.
    #[error("the field is blank; give {what}")]
    Blank {
        /// What belongs there.
        what: &'static str,
    },
    /// No whole number where one is needed.
    #[error("expected {what}, found {found}; give a whole number from 1 to {}", u32::MAX)]
    Whole {
        /// What belongs there.
        what: &'static str,
        /// The text found.
        found: String,
    },
    /// No usable real number.
    #[error("{what} is {found}: {problem}")]
    Real {
        /// Which number.
        what: &'static str,
        /// The text found.
        found: String,
        /// What is wrong with it.
        problem: NumberFault,
    },
    /// No component numbers.
    #[error("expected component numbers, found {found}; write digits from 1 to 6 without blanks, as in 1246")]
    Components {
        /// The text found.
        found: String,
    },
    /// Several components where one is needed, or none.
    #[error("expected one component from 1 to 6, found {found}; write one equation for each component")]
    OneComponent {
        /// The text found.
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
    /// A list that runs backwards or stops in its middle.
    #[error("the list goes from {from} THRU {to}; give the smaller number first")]
    Range {
        /// First.
        from: u32,
        /// Last.
        to: String,
    },
    /// A continuation that names another card's.
    #[error("the line continues {found}, but the card before it goes on as {expected}; put it right after its card")]
    Continuation {
        /// The name the card gives.
        expected: String,
        /// The name the line gives.
        found: String,
    },
    /// A continuation with nothing before it.
    #[error("a continuation line without a card before it; put it right after its card")]
    NothingToContinue,
    /// Two definitions of one thing.
    #[error("{what} {id} is defined differently in {other}; keep one of the two")]
    DefinedTwice {
        /// "grid point", "frame".
        what: &'static str,
        /// Its number.
        id: u32,
        /// File and line of the other.
        other: String,
    },
    /// A frame that nothing defines.
    #[error("coordinate system {frame} is not defined; add its CORD card or correct the number")]
    UnknownFrame {
        /// The frame.
        frame: u32,
    },
    /// A grid point that nothing defines.
    #[error("grid point {node} is not defined; add its GRID card or correct the number")]
    UnknownGrid {
        /// The grid point.
        node: u32,
    },
    /// A frame that rests on itself.
    #[error("the coordinate system rests on itself through {frame}; define one of them in coordinate system 0")]
    FrameCycle {
        /// The next frame of the cycle.
        frame: u32,
    },
    /// The three points of a frame lie in a line.
    #[error("the three points of the coordinate system lie in a line or coincide; move one of them")]
    FrameInLine,
    /// A set that contains itself.
    #[error("set {set} contains itself; remove it from the list")]
    SetCycle {
        /// The set.
        set: u32,
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
    /// A rod without length.
    #[error("the ends {a} and {b} of the rod are at the same place; move one, or use RBE2")]
    NoLength {
        /// First end.
        a: u32,
        /// Second end.
        b: u32,
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
        "the connected components do not determine {node}:{component}; connect more grid points or components, or remove it from REFC"
    )]
    MeanUndetermined {
        /// The reference grid point.
        node: u32,
        /// The component.
        component: u8,
    },
    /// Weights that cannot be used.
    #[error("the weights add up to {sum}; give positive weights")]
    Weights {
        /// Their sum.
        sum: f64,
    },
    /// An UM list of the wrong length.
    #[error("UM names {found} components, but REFC has {expected}; name as many")]
    UmCount {
        /// Components after UM.
        found: usize,
        /// Components of REFC.
        expected: usize,
    },
    /// A component after UM that the element does not connect.
    #[error("{node}:{component} is named after UM, but the element does not connect it; remove it")]
    UmUnconnected {
        /// The grid point.
        node: u32,
        /// The component.
        component: u8,
    },
    /// The UM components cannot be solved for.
    #[error("the element cannot be solved for the components after UM; choose others")]
    UmSingular,
    /// A constraint that couples a component to nothing.
    #[error("no grid point is connected; give at least one")]
    NothingConnected,
    /// The file ends within a quoted name.
    #[error("the file name is not closed; end it with `'`")]
    OpenQuote,
}

impl CardFault {
    pub(super) fn too_many_fields(count: usize, found: &[u8]) -> Self {
        Self::TooManyFields { count, found: quote(found) }
    }
}

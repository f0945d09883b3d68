//! The stated rank and its confidence are right, doubt does not disappear as a system gets worse, and components do not affect each other.
//!
//! The reference is a dense SVD ([`qless_scenes::oracle::singular_values`]) and residuals computed here. The systems are all scene
//! families at small sizes and 2,000 seeded random ones. A failure names family, seed and options, so that it can be repeated.

#[macro_use]
mod support;

mod rank_confidence {
    /// The checks of one analysis against the reference.
    mod checks;
    /// Two unconnected systems analysed together give the results that each gives alone.
    mod component_law;
    /// What each effort promises.
    mod efforts;
    /// Exact arithmetic confirms what is sure.
    mod exact;
    /// Doubt never disappears as a system gets worse.
    mod monotone;
    /// Random systems of several classes.
    mod random;
    /// `C u - b`, computed independently of the library.
    mod residual;
    /// All scene families at small sizes.
    mod scenes;
    /// The dense SVD and what it allows to conclude.
    mod svd_reference;
    /// Coefficients of 1e-25 to 1e-300 together with normal ones.
    mod tiny_coefficients;
    /// The same verdict in all units of equations and DOFs.
    mod units;
    /// Residual check, rank and false alarms over all systems.
    mod verdicts;
}

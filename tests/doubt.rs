//! What is said of a rank is true, doubt grows with danger, and what stands beside a component changes nothing.
//!
//! The judges are a dense SVD ([`qless_scenes::oracle::singular_values`]) and residuals computed here; systems are all families of
//! scenes at small sizes and 2,000 seeded random ones. A fault names family, seed and options: enough to make it again.

#[macro_use]
mod support;

mod doubt {
    /// What stands beside a component changes nothing.
    mod beside;
    /// What is wrong with what is said of a system.
    mod judge;
    /// Doubt that has come does not go while a system gets worse.
    mod monotone;
    /// Random systems of several classes.
    mod random;
    /// `C u - b` by code of its own.
    mod residual;
    /// All families of scenes, small.
    mod scenes;
    /// Entries of no size beside others.
    mod tiny;
    /// Singular values and what they allow to say.
    mod truth;
    /// Gate, sigma, rank and alarms over all systems.
    mod verdicts;
}

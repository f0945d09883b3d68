//! Certificates, growth, residuals and distances against dense algorithms that share no code with the library.
//!
//! `properties.rs` checks exactly that every equation of a certificate is needed.

#[macro_use]
mod support;

mod dense_reference {
    /// Certificates for rows of any size and DOFs in any unit, relative to their terms.
    mod certificates;
    /// Rank against a dense SVD, and the distance of the kept equations from dependence.
    mod distance;
    /// `max |T_ij|` is within the bound of a dense strong rank-revealing QR.
    mod growth;
    /// Rows that are dependent to within the tolerance.
    mod near_tolerance;
    /// `|C_i u - b_i|` is within 1e-13 times the reported distance.
    mod residual;
    /// A dense strong rank-revealing QR.
    mod rrqr;
    /// The systems under test.
    mod scenes;
    /// Small numbers in certificates and equations.
    mod small_numbers;
}

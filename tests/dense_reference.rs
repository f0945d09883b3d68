//! Certificates, growth, residuals and sigma against dense algorithms that share no code with the library.
//!
//! `properties.rs` checks exactly that every equation of a certificate is needed.

#[macro_use]
mod support;

mod dense_reference {
    /// Certificates for rows of any size and DOFs in any unit, relative to their terms.
    mod certificates;
    /// The smallest relative change of coefficients that makes the kept equations dependent.
    mod distance;
    /// `max |T_ij|` is within the bound of a dense strong rank-revealing QR.
    mod growth;
    /// `|C_i u - b_i|` is within 1e-13 times the reported condition number.
    mod residual;
    /// A dense strong rank-revealing QR.
    mod rrqr;
    /// The systems under test.
    mod scenes;
    /// Rank and `sigma_kept` against a dense SVD.
    mod sigma;
}

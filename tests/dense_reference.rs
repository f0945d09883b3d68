//! Certificates, growth, residuals and sigma against dense algorithms that share no code with the library.
//!
//! `properties.rs` shows exactly that no equation of a certificate can be left out.

#[macro_use]
mod support;

mod dense_reference {
    /// Certificates in rows and units of any size, relative to their terms.
    mod certificates;
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

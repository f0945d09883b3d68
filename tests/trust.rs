//! What a result may be trusted for, against dense algorithms that share no code with the product.
//!
//! That no equation of a certificate can be left out is shown exactly in `properties.rs`.

#[macro_use]
mod support;

mod trust {
    /// Certificates, relative to their parts in rows and units of any size.
    mod certificates;
    /// `max |T_ij|` stays within what a dense strong rank-revealing QR guarantees.
    mod growth;
    /// `|C_i u - b_i|` within 1e-13 times the condition reported.
    mod residual;
    /// A dense strong rank-revealing QR.
    mod rrqr;
    /// The systems.
    mod scenes;
    /// Rank and `sigma_kept` against a dense SVD.
    mod sigma;
}

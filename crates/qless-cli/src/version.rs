//! What `--version` says: the release, the backends compiled in, and the licence where it differs.

#[cfg(feature = "spqr")]
pub const LONG: &str = concat!(
    env!("CARGO_PKG_VERSION"),
    "\nbackends: faer (default), sparse, gauss, spqr\n",
    "licence:  GPL-2.0-or-later, because SuiteSparseQR is compiled in; qless itself is MIT OR Apache-2.0",
);

#[cfg(not(feature = "spqr"))]
pub const LONG: &str = concat!(
    env!("CARGO_PKG_VERSION"),
    "\nbackends: faer (default), sparse, gauss; spqr is not compiled in (rebuild with `--features spqr`)\n",
    "licence:  MIT OR Apache-2.0",
);

//! The exact rank of typed numbers against whole-number arithmetic, and its independence of order, blocks and threads.

mod exact {
    mod laws;
    mod models;
    mod primes;
    mod whole;
}

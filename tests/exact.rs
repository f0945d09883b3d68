//! The exact rank: of numbers as typed against whole-number arithmetic, and the laws that it shares with every other result.

mod exact {
    mod laws;
    mod models;
    mod primes;
    mod whole;
}

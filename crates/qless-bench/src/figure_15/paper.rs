//! The paper's own times: averages of three trials, Table 1.

use super::crossing::Pair;

/// Percent, equations, seconds of the block-wise Gauss elimination and of the Q-less sparse QR.
#[rustfmt::skip]
const TABLE_1: [(u32, u32, [f64; 3], [f64; 3]); 7] = [
    (50, 7_580, [1.807, 1.895, 1.818], [3.061, 3.127, 3.029]),
    (60, 10_300, [4.894, 4.926, 4.853], [5.929, 5.939, 5.992]),
    (70, 13_808, [10.239, 10.099, 10.149], [11.510, 11.475, 11.442]),
    (80, 17_408, [20.795, 20.799, 20.954], [20.999, 21.185, 20.908]),
    (90, 22_360, [42.539, 42.525, 43.309], [39.294, 38.614, 38.267]),
    (100, 26_888, [67.737, 68.974, 68.636], [60.456, 60.309, 61.426]),
    (110, 31_832, [126.666, 128.127, 128.739], [99.192, 96.681, 96.195]),
];

/// All levels.
pub fn pairs() -> Vec<Pair> {
    let mean = |trials: [f64; 3]| trials.iter().sum::<f64>() / 3.0;
    let pair = |(percent, equations, gauss, qr): (u32, u32, [f64; 3], [f64; 3])| Pair {
        size: format!("{percent} %"),
        equations: f64::from(equations),
        gauss: mean(gauss),
        qr: mean(qr),
    };
    TABLE_1.map(pair).into()
}

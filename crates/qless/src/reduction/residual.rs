//! For random u_q and u_p: `max_i |C_i u - b_i| / (|C_i D| 1 max_j(s_j / d_j) + |b_i|)`, where s_j is the sum of the sizes of
//! the parts that make u_j and D the scaling of columns.

use super::rows::Relation;
use crate::generated::randoms;
use crate::scale::{Scaling, ldexp};

pub(super) fn residual(relation: &Relation, independent: &[bool], scaling: &Scaling) -> f64 {
    let (u, largest) = expand(relation, scaling);
    let system = relation.system;
    let mut worst = 0.0_f64;
    for i in (0..system.equations()).filter(|&i| independent[i]) {
        let b = system.rhs()[i];
        let (mut sum, mut size) = (-b, 0.0);
        for (j, v) in system.row(i) {
            sum += v * u[j];
            size += ldexp(v.abs(), scaling.col(j));
        }
        if sum != 0.0 {
            worst = worst.max(sum.abs() / (size * largest + b.abs()));
        }
    }
    worst
}

/// u, and `max_j s_j / d_j`.
fn expand(relation: &Relation, scaling: &Scaling) -> (Vec<f64>, f64) {
    let mut u: Vec<f64> = randoms(1).take(relation.row_of.len()).collect();
    let mut largest = 0.0_f64;
    for (j, u) in u.iter().enumerate().filter(|&(j, _)| relation.row_of[j] == u32::MAX) {
        largest = largest.max(ldexp(u.abs(), -scaling.col(j)));
    }
    for (i, &slave) in relation.slave.iter().enumerate() {
        let constant = relation.constant[i];
        let (mut sum, mut size) = (constant, constant.abs());
        for (j, v) in relation.entries(i) {
            let part = v * u[j as usize];
            sum += part;
            size += part.abs();
        }
        u[slave as usize] = sum;
        largest = largest.max(ldexp(size, -scaling.col(slave as usize)));
    }
    (u, largest)
}

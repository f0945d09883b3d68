//! `u_p - sum_k N_k u_k = 0` for each field: what every tie of a node to others comes down to.

use std::borrow::Cow;

use crate::Store;

/// Adds the F equations; masters that have no weight are left out.
pub(super) fn interpolate<'a, const F: usize>(
    store: &mut Store,
    part: impl Fn(usize) -> Cow<'static, str>,
    slave: &[usize; F],
    masters: impl Iterator<Item = (&'a [usize; F], f64)> + Clone,
) {
    for (k, &dof) in slave.iter().enumerate() {
        let terms = masters.clone().filter(|&(_, n)| n != 0.0).map(|(dofs, n)| (dofs[k], -n));
        store.equation(part(k), terms.chain([(dof, 1.0)]), 0.0);
    }
}

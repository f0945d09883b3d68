"""Linear programs through SciPy's HiGHS."""

import numpy as np
import pytest
import scipy.sparse as sp
from scipy.optimize import linprog

import qless


def transport(factories, shops, rng):
    """Costs, A_eq, b_eq of a transport problem: supplies and demands, one of which follows from the others."""
    flows = np.arange(factories * shops).reshape(factories, shops)
    rows = [np.isin(np.arange(flows.size), group) for group in [*flows, *flows.T]]
    demand = rng.integers(1, 20, shops).astype(float)
    supply = np.diff(np.r_[0.0, np.sort(rng.choice(np.arange(1, demand.sum()), factories - 1, replace=False)), demand.sum()])
    return rng.integers(1, 30, flows.size), sp.csr_array(np.array(rows, dtype=float)), np.r_[supply, demand]


@pytest.mark.parametrize("seed", range(10))
def test_transport_problems_have_the_same_optimum_and_full_duals(seed):
    cost, A, b = transport(4, 5, np.random.default_rng(seed))
    p = qless.presolve(A, b)
    assert p.redundant.size == 1 and np.linalg.matrix_rank(p.A.toarray()) == p.A.shape[0] == 8
    p.raise_if_conflicting()
    whole, small = linprog(cost, A_eq=A, b_eq=b), linprog(cost, A_eq=p.A, b_eq=p.b)
    assert abs(whole.fun - small.fun) <= 1e-10 * abs(whole.fun)
    y = p.lift_duals(small.eqlin.marginals)
    assert abs(b @ y - small.fun) <= 1e-10 * abs(small.fun)
    assert (cost - A.T @ y >= -1e-9).all()


def test_infeasible_equations_carry_a_proof():
    cost, A, b = transport(3, 3, np.random.default_rng(0))
    b[0] += 1.0
    p = qless.presolve(A.toarray(), b)
    with pytest.raises(qless.Conflict) as raised:
        p.raise_if_conflicting()
    (y,) = ([of.get(i, 0.0) for i in range(6)] for of in raised.value.multipliers)
    assert np.abs(np.array(y) @ A.toarray()).max() < 1e-12 and abs(np.dot(y, b)) > 0.5
    assert linprog(cost, A_eq=A, b_eq=b).status == 2


def test_duals_of_a_wrong_length_are_refused():
    with pytest.raises(ValueError, match="shape"):
        qless.presolve(np.eye(2), [1, 2]).lift_duals([1, 2, 3])

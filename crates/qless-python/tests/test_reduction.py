"""The reduced form against a dense oracle: Lagrange multipliers on random systems with dependent rows."""

import numpy as np
import pytest
import scipy.sparse as sp

import qless


def system(seed):
    """Random sparse equations, some of them combinations of others, and a stiffness matrix."""
    rng = np.random.default_rng(seed)
    n, r = int(rng.integers(6, 20)), int(rng.integers(1, 5))
    free = np.round(rng.normal(size=(r, n)) * (rng.random((r, n)) < 0.5), 2)
    free[np.arange(r), rng.permutation(n - 1)[:r]] = rng.integers(1, 4, r)
    C = np.vstack([free, rng.integers(-2, 3, (2, r)) @ free])
    x = np.round(rng.normal(size=n), 2)
    A = rng.normal(size=(n, n)) * (rng.random((n, n)) < 0.3)
    K = A @ A.T + np.eye(n)
    prescribed = {n - 1: float(x[-1])} if seed % 2 else {}
    return C, C @ x, K, rng.normal(size=n), prescribed


def oracle(C, b, K, f, prescribed):
    """u of K u + C^T lambda = f, C u = b, by least squares on the saddle point system."""
    n = K.shape[0]
    given = np.zeros((len(prescribed), n))
    given[np.arange(len(prescribed)), list(prescribed)] = 1.0
    full = np.vstack([C, given])
    A = np.block([[K, full.T], [full, np.zeros((len(full),) * 2)]])
    return np.linalg.lstsq(A, np.r_[f, b, list(prescribed.values())], rcond=1e-12)[0][:n]


@pytest.mark.parametrize("seed", range(60))
def test_condensed_solutions_are_those_of_lagrange(seed):
    C, b, K, f, prescribed = system(seed)
    r = qless.analyse(C, b, prescribed)
    expected = oracle(C, b, K, f, prescribed)
    L, u0 = r.L, r.u0
    np.testing.assert_allclose(C @ u0, b, atol=1e-12)
    assert np.abs(C @ L.toarray()).max(initial=0.0) < 1e-12
    assert L.shape[1] == np.linalg.matrix_rank(L.toarray())
    for matrix in (sp.csr_array(K), sp.csc_matrix(K), sp.coo_array(K), K):
        K_q, f_q = r.condense(matrix, f)
        dense = K_q if isinstance(K_q, np.ndarray) else K_q.toarray()
        np.testing.assert_allclose(dense, L.T @ K @ L.toarray(), atol=1e-11)
        u = r.expand(np.linalg.solve(dense, f_q))
        np.testing.assert_allclose(u, expected, atol=1e-10)
    residual = f - K @ u
    balance = r.multipliers(residual) @ C - residual
    balance[list(prescribed)] = 0.0
    assert np.abs(balance).max() < 1e-9
    np.testing.assert_allclose(r.reactions(residual), (r.multipliers(residual) @ C - residual)[list(prescribed)], atol=1e-12)


def test_expand_restrict_and_the_operator_agree_with_l():
    C, b, _, f, _ = system(3)
    r = qless.analyse(C, b)
    L, x = r.L, np.random.default_rng(0).normal(size=(len(r.masters), 3))
    np.testing.assert_allclose(r.expand(x), L @ x + r.u0[:, None], atol=1e-13)
    np.testing.assert_allclose(r.expand_increment(x[:, 0]), L @ x[:, 0], atol=1e-13)
    np.testing.assert_allclose(r.restrict(f), L.T @ f, atol=1e-13)
    operator = r.operator()
    np.testing.assert_allclose(operator @ x, L @ x, atol=1e-13)
    np.testing.assert_allclose(operator.T @ f, L.T @ f, atol=1e-13)
    assert r.expand(np.zeros((len(r.masters), 0))).shape == (C.shape[1], 0)


def test_nullspace_of_a_conflicting_system():
    C = np.array([[1.0, -1, 0], [1, -1, 0]])
    N = qless.analyse(C, [0, 1]).nullspace()
    assert N.shape == (3, 2) and np.abs(C @ N.toarray()).max() == 0


def test_a_pattern_that_comes_again_is_used_again_with_new_values():
    C, b, K, f, _ = system(4)
    r = qless.analyse(C, b)
    for factor in (1.0, 2.0, 3.0):
        K_q, _ = r.condense(sp.csr_array(factor * K), f)
        np.testing.assert_allclose(K_q.toarray(), factor * (r.L.T @ K @ r.L.toarray()), atol=1e-11)

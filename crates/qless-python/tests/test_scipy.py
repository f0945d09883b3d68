"""Linear programs with implied rows through SciPy and HiGHS, against a dense oracle of the optimal basis."""

import numpy as np
import optional
import pytest
import scipy.sparse as sp
from scipy.optimize import linprog

import qless
import qless.scipy

highspy = optional.package("highspy")


def program(seed, implied=6):
    """min c x, A x = b, x >= 0, with a known optimal basis: (c, A, b, x, y of the independent rows); `implied` rows are sums of others."""
    rng = np.random.default_rng(seed)
    m, n = 8, 20
    A, x = rng.integers(-3, 4, (m, n)).astype(float), np.zeros(n)
    A[:, :m] += 10 * np.eye(m)
    basis = rng.permutation(n)[:m]
    A[:, basis] += 7 * np.eye(m)
    x[basis] = rng.uniform(1, 2, m)
    y = rng.normal(size=m)
    gap = rng.uniform(0.5, 2, n)
    gap[basis] = 0.0
    mix = rng.integers(-2, 3, (implied, m)).astype(float)
    mix[:, 0] += 5
    whole = np.vstack([A, mix @ A])
    return A.T @ y + gap, whole, whole @ x, x, basis


def duals_of_basis(c, A, rows, basis):
    """y of the kept rows: the reduced costs of basic columns are zero."""
    y = np.zeros(len(A))
    y[rows] = np.linalg.lstsq(A[rows][:, basis].T, c[basis], rcond=None)[0]
    return y


@pytest.mark.parametrize("seed", range(10))
@pytest.mark.parametrize("make", [np.asarray, np.ndarray.tolist, sp.csr_array], ids=["dense", "list", "sparse"])
def test_linprog(seed, make):
    c, A, b, x, basis = program(seed)
    res = qless.scipy.linprog(c, A_eq=make(A), b_eq=b)

    assert res.status == 0 and res.presolved.redundant.size == 6
    assert abs(res.fun - c @ x) <= 1e-10 * abs(c @ x)
    y = duals_of_basis(c, A, res.presolved.rows, basis)
    assert np.abs(res.eqlin.marginals - y).max() <= 1e-10 * np.abs(y).max()
    assert abs(b @ res.eqlin.marginals - res.fun) <= 1e-10 * abs(res.fun)
    assert res.con.shape == res.eqlin.residual.shape == (14,) and np.abs(res.con).max() <= 1e-9


@pytest.mark.parametrize("seed", range(10))
def test_highs(seed):
    """Equations between inequalities that do not bind, so that rows have other numbers than equations."""
    c, A, b, x, basis = program(seed)
    h = highspy.Highs()
    h.silent()
    lp = highspy.HighsLp()
    loose, order = np.ones((2, 20)), [0, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14]
    M = np.zeros((16, 20))
    M[order], M[[1, 15]] = A, loose
    lower, upper = np.full(16, -highspy.kHighsInf), np.full(16, 1e3)
    lower[order] = upper[order] = b
    lp.num_col_, lp.num_row_, lp.col_cost_ = 20, 16, c
    lp.col_lower_, lp.col_upper_, lp.row_lower_, lp.row_upper_ = np.zeros(20), np.full(20, highspy.kHighsInf), lower, upper
    columns = sp.csc_array(M)
    lp.a_matrix_.start_, lp.a_matrix_.index_, lp.a_matrix_.value_ = columns.indptr, columns.indices, columns.data
    h.passModel(lp)

    reduced = qless.scipy.highs(h)
    h.run()
    assert h.getNumRow() == 10 == reduced.rows.size and reduced.removed.size == 6 and set(reduced.removed) <= set(order)
    assert abs(h.getObjectiveValue() - c @ x) <= 1e-10 * abs(c @ x)
    y = np.zeros(16)
    y[order] = duals_of_basis(c, A, reduced.presolved.rows, basis)
    assert np.abs(reduced.duals(h.getSolution().row_dual) - y).max() <= 1e-10 * np.abs(y).max()
    with pytest.raises(qless.InputError, match="there are 16 duals; 10 rows are left"):
        reduced.duals(np.zeros(16))


def test_conflicting_equations():
    c, A, b, *_ = program(0)
    b = b.copy()
    b[-1] += 1.0
    with pytest.raises(qless.Conflict, match="conflicts with others"):
        qless.scipy.linprog(c, A_eq=A, b_eq=b)
    assert linprog(c, A_eq=A, b_eq=b).status == 2
    h = highspy.Highs()
    h.silent()
    first = h.addVariable(name="first")
    h.addConstr(first == 1.0, name="one")
    h.addConstr(first == 2.0, name="two")
    with pytest.raises(qless.Conflict, match='row 1 "two"'):
        qless.scipy.highs(h)
    assert h.getNumRow() == 2


def test_linprog_without_equations():
    res = qless.scipy.linprog([1.0, 2.0], A_ub=[[-1.0, -1.0]], b_ub=[-1.0])
    assert res.fun == 1.0
    with pytest.raises(qless.InputError, match="without b_eq"):
        qless.scipy.linprog([1.0], A_eq=[[1.0]])
    infeasible = qless.scipy.linprog([1.0], A_ub=[[1.0]], b_ub=[0.5], A_eq=[[1.0], [1.0]], b_eq=[1.0, 1.0])
    assert infeasible.status == 2 and infeasible.presolved.redundant.tolist() == [1]

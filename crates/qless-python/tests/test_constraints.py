"""Constraint types against the motions that they must allow and forbid."""

import numpy as np
import pytest
import scipy.sparse as sp

import qless

RNG = np.random.default_rng(7)


def rank(matrix):
    # Before NumPy 2.3, an empty matrix has no rank.
    return np.linalg.matrix_rank(matrix.toarray()) if matrix.shape[0] else 0


def rigid_motions(points):
    """All rigid motions of points (nodes, d) as rows."""
    nodes, d = points.shape
    motions = [np.tile(axis, nodes) for axis in np.eye(d)]
    for i, j in [(0, 1)] if d == 2 else [(0, 1), (1, 2), (2, 0)]:
        turn = np.zeros((nodes, d))
        turn[:, i], turn[:, j] = -points[:, j], points[:, i]
        motions.append(turn.ravel())
    return np.array(motions)


def clouds():
    for d in (2, 3):
        for nodes in (1, 2, 3, 4, 7):
            yield RNG.normal(size=(nodes, d))
        yield np.outer(np.linspace(0, 1, 5), RNG.normal(size=d))
        yield np.repeat(RNG.normal(size=(1, d)), 3, axis=0)
        yield 1e3 + RNG.normal(size=(6, d))
    yield np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0.0]])


@pytest.mark.parametrize("points", list(clouds()))
def test_rigid_allows_rigid_motions_and_no_others(points):
    dofs = np.arange(points.size).reshape(points.shape)
    c = qless.Constraints(points.size + 2)
    c.rigid(dofs, points)
    motions = rigid_motions(points - points.mean(axis=0))
    allowed = np.linalg.matrix_rank(motions)
    assert rank(c.C) == len(c) == points.size - allowed
    assert np.abs(c.C[:, : points.size] @ motions.T).max(initial=0.0) < 1e-12
    r = c.analyse()
    assert (r.status, r.rank) == ("independent", len(c))


def test_rigid_takes_points_by_either_side():
    points = RNG.normal(size=(5, 2))
    dofs = np.arange(10).reshape(5, 2)
    a, b = qless.Constraints(10), qless.Constraints(10)
    a.rigid(dofs, points), b.rigid(dofs.T, points.T)
    assert (a.C != b.C).nnz == 0


@pytest.mark.parametrize("d", [2, 3])
def test_rigid_follows_a_reference(d):
    points, centre = RNG.normal(size=(4, d)), RNG.normal(size=d)
    free = d + (1 if d == 2 else 3)
    c = qless.Constraints(4 * d + free)
    c.rigid(np.arange(4 * d).reshape(4, d), points, reference=4 * d + np.arange(free), centre=centre)
    r = c.analyse(masters=(4 * d + np.arange(free)).tolist())
    assert r.masters.tolist() == list(range(4 * d, 4 * d + free))
    motion = RNG.normal(size=free)
    turn = np.array([[0, -motion[2]], [motion[2], 0]]) if d == 2 else np.cross(np.eye(3), motion[3:]).T * -1
    if d == 3:
        turn = np.array([[0, -motion[5], motion[4]], [motion[5], 0, -motion[3]], [-motion[4], motion[3], 0]])
    np.testing.assert_allclose(r.expand(motion)[: 4 * d].reshape(4, d), motion[:d] + (points - centre) @ turn.T, atol=1e-13)


def test_equal_mpc_equation_and_matrix_say_the_same():
    c = qless.Constraints(6)
    assert c.equal([0, 1], [2, 3], offset=[0.5, 0.25], label="tie") == range(0, 2)
    c.mpc([0, 1], [[2], [3]], 1.0, offset=[0.5, 0.25])
    c.equation([0, 2], [2, -2], 1.0, label="user")
    c.add(sp.csr_array(([1.0, -1.0], ([0, 0], [1, 3])), shape=(1, 6)), 0.25)
    c.add([[1, 0, -1, 0, 0, 0.0]], [0.5], label=["last"])
    assert c.labels == ["tie [0]", "tie [1]", "equation 2", "equation 3", "user", "equation 5", "last"]
    r = c.analyse()
    assert (r.rank, r.redundant.tolist(), len(c)) == (2, [2, 3, 4, 5, 6], 7)
    assert str(r.because(4)) == 'row 4 "user" = 2 * row 0 "tie [0]"'


def test_periodic_with_numbers_and_with_dofs():
    E = np.array([[0.01, 0.02], [0.0, -0.03]])
    dx = np.array([2.0, 1.0])
    a, b, strain = np.array([[0, 1], [2, 3]]), np.array([[4, 5], [6, 7]]), np.array([[8, 9], [10, 11]])
    fixed, free, alike = qless.Constraints(12), qless.Constraints(12), qless.Constraints(12)
    fixed.periodic(a, b, dx, E), free.periodic(a, b, dx, strain_dofs=strain), alike.periodic(a, b)
    free.prescribe(dict(zip(strain.ravel(), E.ravel(), strict=True)))
    for c, jump in ((fixed, E @ dx), (free, E @ dx), (alike, [0, 0])):
        r = c.analyse()
        u = r.expand(RNG.normal(size=len(r.masters)))
        np.testing.assert_allclose(u[a] - u[b], np.tile(jump, (2, 1)), atol=1e-15)


def test_a_strain_of_integers_is_a_strain():
    c = qless.Constraints(4)
    c.periodic([[0, 1]], [[2, 3]], [1.0, 2.0], [[0, 1], [1, 0]])
    u = c.analyse().expand(np.zeros(2))
    np.testing.assert_array_equal(u[:2] - u[2:], [2, 1])
    with pytest.raises(qless.InputError, match="not both"):
        c.periodic([[0, 1]], [[2, 3]], [1.0, 2.0], np.eye(2), strain_dofs=[[0, 1], [2, 3]])


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda c: c.equal([0], [9], label="tie"), r"row 0 \(tie\) names DOF 9"),
        (lambda c: c.equation([0, -1], [1, 1]), "names DOF -1"),
        (lambda c: c.equation([0.5], [1]), "integers"),
        (lambda c: c.add(np.eye(3)), "3 columns"),
        (lambda c: c.add(np.eye(4), [1, 2]), "2 numbers for 4"),
        (lambda c: c.add(np.eye(4), label=["a"]), "1 labels for 4"),
        (lambda c: c.rigid([[0, 1, 2, 3]], [[0, 1, 2, 3.0]]), "d = 2 or 3"),
        (lambda c: c.rigid([[0, 1]], [[0, 1.0]], reference=[2, 3]), "2 translations and 1 rotations"),
        (lambda c: c.periodic([[0, 1]], [[2, 3]], [1, 0], np.eye(3)), "2 x 2"),
        (lambda c: c.prescribe({0: 1.0, 9: 2.0}), "DOF 9"),
        (lambda c: (c.prescribe(0, 1.0), c.prescribe(0, 2.0)), "twice"),
        (lambda c: c.mpc(0, [1, 2], [1.0]), r"shape \(1,\), but \(1, 2\) is needed"),
        (lambda c: c.mpc([0, 1], [2, 3, 0], 1.0), r"shape \(3,\) for 2 slaves"),
        (lambda c: c.mpc([0, 1, 2], [[1, 2, 3], [2, 3, 0]], 1.0), r"shape \(2, 3\) for 3 slaves"),
        (lambda c: c.mpc([], [1, 2], 1.0), r"shape \(2,\) for 0 slaves"),
        (lambda c: c.equation([0, 1], [1.0]), r"shape \(1,\), but \(2,\) is needed"),
        (lambda c: c.equal([0, 1], [1, 2, 3]), "2 DOFs and 3 DOFs"),
        (lambda c: c.equal([0, 1], [2, 3], np.ma.masked_array([1.0, 2.0], [0, 1])), "masked entries"),
        (lambda c: c.equal(np.ma.masked_array([0, 1], [0, 1]), [2, 3]), "masked entries"),
        (lambda c: c.periodic([[0, 1]], [[2, 3]], [1.0], np.eye(2)), r"shape \(1,\), but \(1, 2\) is needed"),
        (lambda c: c.label_dofs("abcd"), "the text 'abcd'"),
    ],
)
def test_bad_constraints_are_named(call, message):
    c = qless.Constraints(4)
    with pytest.raises(qless.InputError, match=message):
        call(c)
    assert len(c) == 0


@pytest.mark.parametrize("dofs", [-1, 1.5, 2**32, "4", None])
def test_a_number_of_dofs_is_a_whole_number(dofs):
    with pytest.raises(qless.InputError, match="number of DOFs"):
        qless.Constraints(dofs)


def test_one_row_of_coefficients_serves_all_slaves():
    c = qless.Constraints(6)
    c.mpc([0, 1], [[2, 3], [4, 5]], [0.25, 0.75])
    assert c.C.toarray().tolist() == [[1, 0, -0.25, -0.75, 0, 0], [0, 1, 0, 0, -0.25, -0.75]]


def test_prescribe_takes_arrays():
    c = qless.Constraints(4)
    c.prescribe([0, 1], [0.5, 0.25])
    c.prescribe(np.array([2, 3]), 1.0)
    assert c.prescribed == {0: 0.5, 1: 0.25, 2: 1.0, 3: 1.0}
    assert repr(c) == "Constraints(0 equations on 4 DOFs, 4 prescribed)"

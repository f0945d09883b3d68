"""The arrays for dolfinx_mpc, against the reduced form, by numpy alone: dolfinx has no wheel."""

import numpy as np
import pytest

import qless
import qless.dolfinx


def cell(n=5):
    """A periodic cell whose corners are tied around, with an offset and a prescribed corner."""
    nodes = np.arange(n * n).reshape(n, n)
    c = qless.Constraints(2 * n * n)
    dofs = lambda list_: np.stack([2 * list_, 2 * list_ + 1], axis=1)
    E = np.array([[0.01, 0.002], [0.0, -0.03]])
    c.periodic(dofs(nodes[-1]), dofs(nodes[0]), [1.0, 0.0], E)
    c.periodic(dofs(nodes[:, -1]), dofs(nodes[:, 0]), [0.0, 1.0], E)
    c.mpc(2 * nodes[2, 2], 2 * nodes[[1, 3], 2], [0.25, 0.75])
    c.prescribe([0, 1], [0.5, -0.5])
    return c, c.analyse()


def test_the_arrays_are_the_reduced_form():
    c, r = cell()
    a = qless.dolfinx.arrays(r)
    types = [array.dtype for array in (a.slaves, a.masters, a.coefficients, a.owners, a.offsets)]
    assert types == [np.int32, np.int64, np.float64, np.int32, np.int32]
    assert (r.redundant.size, len(a.offsets), a.offsets[-1]) == (2, len(a.slaves) + 1, len(a.masters))
    assert not set(a.slaves) & set(a.masters) and len(set(a.slaves)) == len(a.slaves) and not a.owners.any()

    # Any admissible motion, slave by slave as dolfinx_mpc computes it.
    u = r.expand(np.random.default_rng(0).normal(size=len(r.masters)))
    for i, slave in enumerate(a.slaves):
        here = slice(a.offsets[i], a.offsets[i + 1])
        assert abs(a.coefficients[here] @ u[a.masters[here]] + a.constants[i] - u[slave]) <= 1e-14
    assert np.abs(c.C @ u - c.b).max() <= 1e-14
    K = np.zeros((len(a.slaves), c.dofs))
    K[np.repeat(np.arange(len(a.slaves)), np.diff(a.offsets)), a.masters] = a.coefficients
    np.testing.assert_array_equal(K[:, r.masters], r.T.toarray())
    np.testing.assert_array_equal(K[:, r.prescribed], r.G.toarray())


def test_three_processes_have_the_rows_of_one():
    _, r = cell()
    one = qless.dolfinx.arrays(r)
    rows = {slave: (one.masters[a:b].tolist(), g) for slave, a, b, g in zip(one.slaves, one.offsets, one.offsets[1:], one.constants)}
    ranges, seen = [0, 20, 20, 50], set()
    for rank in range(3):
        first, last = ranges[rank], ranges[rank + 1]
        ghosts = [49, 9] if rank == 0 else [8, 1, 9] if rank == 2 else []
        a = qless.dolfinx.arrays(r, ranges, rank, ghosts)
        known = [*range(first, last), *ghosts]
        for i, slave in enumerate(a.slaves):
            assert rows[known[slave]] == (a.masters[a.offsets[i] : a.offsets[i + 1]].tolist(), a.constants[i])
        assert {known[slave] for slave in a.slaves} == set(rows) & set(known) and (np.diff(a.slaves) > 0).all()
        assert all(ranges[owner] <= master < ranges[owner + 1] for owner, master in zip(a.owners, a.masters))
        seen |= {known[slave] for slave in a.slaves}
    assert seen == set(rows)


def test_bad_input_is_named():
    _, r = cell()
    for ranges in ([0, 20], [0, 30, 20, 50], [1, 50], [[0, 50]]):
        with pytest.raises(qless.InputError, match="number of DOFs, 50"):
            qless.dolfinx.arrays(r, ranges)
    with pytest.raises(qless.InputError, match="rank 2: ranges are those of 2 processes"):
        qless.dolfinx.arrays(r, [0, 20, 50], 2)

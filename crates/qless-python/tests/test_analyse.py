"""Diagnosis: inputs of all types, options, errors, conflicts, texts."""

import pickle
import threading

import numpy as np
import pytest
import scipy.sparse as sp

import qless

C = np.array([[1.0, -1, 2], [1, 2, -1], [2, 1, 1]])
B = np.array([1.0, 0, 1])


MASKED = np.ma.masked_array(C, mask=[[0, 0, 0], [0, 0, 0], [1, 1, 1]])


def outside(matrix):
    """A COO matrix with a row that it does not have."""
    matrix.row[-1] = 9
    return matrix


def forms(dense):
    """The same matrix in every form that is taken."""
    yield dense
    yield np.asfortranarray(dense)
    yield dense.tolist()
    for make in (sp.csr_matrix, sp.csr_array, sp.csc_matrix, sp.coo_array, sp.lil_matrix):
        yield make(dense)
    wide = sp.csr_array(dense)
    wide.indices, wide.indptr = wide.indices.astype(np.int64), wide.indptr.astype(np.int64)
    yield wide
    yield dense.astype(np.float32)
    yield sp.csr_array(dense.astype(np.float32))
    yield dense.astype(int)
    yield dense.astype(int).astype(object)
    yield np.ma.masked_array(dense)
    yield tuple(map(tuple, dense.tolist()))
    yield np.repeat(dense, 2, axis=1)[:, ::2]


@pytest.mark.parametrize("matrix", list(forms(C)))
def test_every_form_of_a_matrix_gives_the_same(matrix):
    r = qless.analyse(matrix, B)
    assert (r.rank, r.kinds.tolist(), r.status) == (2, [0, 0, 1], "redundant")
    assert [row for row, _ in r.because(2).terms] == [0, 1]
    np.testing.assert_allclose([c for _, c in r.because(2).terms], 1.0, rtol=1e-14)
    assert (r.slaves.tolist(), r.masters.tolist()) == ([0, 1], [2])
    np.testing.assert_allclose(r.g, [2 / 3, -1 / 3], rtol=1e-14)
    np.testing.assert_allclose(r.T.toarray(), [[-1.0], [1.0]], rtol=1e-14)


def test_repeated_entries_are_summed():
    twice = sp.csr_array((np.array([1.0, 1.0, -2.0]), np.array([0, 0, 1]), np.array([0, 3])), shape=(1, 2))
    assert qless.analyse(twice).T.toarray().tolist() == [[1.0]]


def test_conflicts_carry_rows_and_explanations():
    r = qless.analyse(C, [1, 0, 2], labels=["weld", "bolt", "glue"])
    assert (r.conflicting.tolist(), r.independent.tolist()) == ([2], [0, 1])
    with pytest.raises(qless.Conflict, match=r'row 2 "glue" = 1 \* row 0 "weld" \+ 1 \* row 1 "bolt".*differ by 1') as raised:
        _ = r.slaves
    assert raised.value.rows == [2]
    y = raised.value.multipliers[0]
    y = np.array([y.get(i, 0.0) for i in range(3)])
    assert np.abs(y @ C).max() < 1e-14 and abs(y @ [1, 0, 2] - 1) < 1e-14
    assert qless.analyse(C, B).raise_if_conflicting().rank == 2


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: qless.analyse([[1, np.nan]], labels=["weld"]), 'row 0, DOF 1 is NaN.*row 0 is "weld"'),
        (lambda: qless.analyse(C, [0, np.inf, 0]), "right-hand side of row 1 is inf"),
        (lambda: qless.analyse(C, [0, 0]), "3"),
        (lambda: qless.analyse(C, [[0], [0], [0]]), r"shape \(3, 1\)"),
        (lambda: qless.analyse(C, 0.5), r"shape \(\)"),
        (lambda: qless.analyse(C, sp.csr_array(np.zeros((3, 1)))), "sparse"),
        (lambda: qless.analyse(C, prescribed={7: 0.0}), "DOF 7"),
        (lambda: qless.analyse(C, prescribed=[0, 1]), "neither"),
        (lambda: qless.analyse(C, prescribed=[0, 1, 2]), "neither"),
        (lambda: qless.analyse(C, prescribed=1), "neither"),
        (lambda: qless.analyse(C, prescribed={-1: 0.0}), "-1"),
        (lambda: qless.analyse(C, prescribed=([1, 1], [0.0, 2.0])), "prescribed twice"),
        (lambda: qless.analyse(C, tolerance=2.0), "tolerance"),
        (lambda: qless.analyse(C, backend="spqr"), "this build has"),
        (lambda: qless.analyse(C, colour=1), "no option `colour`"),
        (lambda: qless.analyse(C * 1j), "complex"),
        (lambda: qless.analyse(np.ones(3)), "dimensions"),
        (lambda: qless.analyse(sp.coo_array(np.ones(3))), "1 dimension;"),
        (lambda: qless.analyse(C, "three"), "no real numbers"),
        (lambda: qless.analyse([[10**400, 1]]), "no real numbers"),
        (lambda: qless.analyse([["1", 2]]), "no real numbers"),
        (lambda: qless.analyse(np.zeros((1, 1), "M8[s]")), r"no real numbers: they are of type datetime64\[s\]"),
        (lambda: qless.analyse(C, np.zeros(3, "m8[s]")), "timedelta64"),
        (lambda: qless.analyse([[1, 2], [1]]), "no array"),
        (lambda: qless.analyse([[2**53 + 1, 2**53], [2**53, 2**53]]), "9007199254740993 is not exact in f64"),
        (lambda: qless.analyse(sp.csr_array(np.array([[2**63 + 1, 1]], np.uint64))), "9223372036854775809 is not exact"),
        (lambda: qless.analyse(np.array([[2**70 + 1, 1]], object)), "1180591620717411303425 is not exact"),
        (lambda: qless.analyse(C, prescribed={0: 2**53 + 1}), "not exact"),
        (lambda: qless.analyse(MASKED), "masked entries"),
        (lambda: qless.analyse(list(MASKED)), "masked entries"),
        (lambda: qless.analyse(C, MASKED[2]), "masked entries"),
        (lambda: qless.analyse(C, prescribed={0: np.ma.masked}), "masked entries"),
        (lambda: qless.analyse(C, prescribed=(np.ma.masked_array([0, 1], [0, 1]), 0.0)), "masked entries"),
        (lambda: qless.analyse(C, prescribed=(np.array([2**64 - 1], np.uint64), 0.0)), "18446744073709551615 is too large"),
        (lambda: qless.analyse(C, labels="abc"), "the text 'abc'"),
        (lambda: qless.analyse(C, masters=[-1]), "masters=-1: give DOFs as a list"),
        (lambda: qless.analyse(C, slaves=[True, False, True]), "slaves is a mask"),
        (lambda: qless.analyse(C, keep=2), "keep=2: give rows as a list"),
        (lambda: qless.analyse(C, keep=[0.5]), "keep=0.5"),
        (lambda: qless.analyse(C, memory=-5), "memory=-5: give a whole number of bytes"),
        (lambda: qless.analyse(C, memory=2**70), "memory=1180591620717411303424"),
        (lambda: qless.analyse(C, effort=None), "effort=None"),
        (lambda: qless.analyse(C, backend=["faer"] * 50), r"backend=\['faer'.*\.\.\.: give the name of a backend"),
        (lambda: qless.analyse(C, presolve="no"), "presolve='no': give True or False"),
        (lambda: qless.analyse(C, growth="high"), "growth='high'"),
        (lambda: qless.analyse(C, labels=["a"]), "labels"),
        (lambda: qless.analyse(np.zeros((2, 0))), "no DOFs"),
        (lambda: qless.analyse(C).because(3), "out of range"),
        (lambda: qless.analyse(C).because(-1), "-1"),
        (lambda: qless.analyse(C).because(2.5), "row 2.5 is no whole number"),
        (lambda: qless.analyse(C).because(2**70), "out of range"),
        (lambda: qless.analyse(C).because_fixed(3), "DOF 3 is out of range; give a whole number from 0, below 3"),
        (lambda: qless.analyse(C).explain_fixed(99), "DOF 99 is out of range"),
        (lambda: qless.analyse(C).to_json(-1), "number of terms -1"),
        (lambda: qless.analyse(C, prescribed={0: 1.0}).with_values(prescribed=[1.0, 2.0]), r"shape \(2,\), but \(1,\)"),
        (lambda: qless.analyse(C, prescribed={0: 1.0}).with_values(prescribed={0: np.ma.masked}), "masked entries"),
        (lambda: qless.analyse(C, prescribed={0: 1.0}).refresh(prescribed={0: np.ma.masked}), "masked entries"),
        (lambda: qless.analyse(C).condense(outside(sp.coo_array(C))), "row indices are 0 to 9"),
        (lambda: qless.analyse(C).expand([1.0, 2.0]), "list of masters"),
        (lambda: qless.analyse(C).expand([np.nan]), "finite"),
        (lambda: qless.analyse(C).condense(np.eye(2)), "2 x 2"),
    ],
)
def test_bad_input_is_named(call, message):
    with pytest.raises(qless.InputError, match=message):
        call()


@pytest.mark.parametrize("bad", [-1, 3, 100_000_000])
@pytest.mark.parametrize("kind", ["csc", "coo", "bsr"])
def test_indices_outside_a_sparse_matrix_are_named(kind, bad):
    broken = sp.csr_array(C).asformat(kind)
    if kind == "coo":
        broken.row[0] = bad
    else:
        broken.indices[0] = bad
    with pytest.raises(qless.InputError, match=f"{kind.upper()} matrix is not valid"):
        qless.analyse(broken)


def test_whole_numbers_above_2_to_the_53_are_taken_if_they_are_exact():
    r = qless.analyse(np.array([[2**60, -(2**53)], [2**54, -(2**47)]]))
    assert (r.rank, [c for _, c in r.because(1).terms]) == (1, [2.0**-6])


def test_rows_given_as_two_tuples_are_a_matrix():
    assert qless.analyse(((1, -1), (2, -2))).rank == 1


def test_dofs_beyond_32_bits_with_a_sign():
    far = 2**31 + 3
    r = qless.analyse(sp.csr_array(([1.0, 1.0], ([0, 0], [1, far])), shape=(1, far + 1)), prescribed={1: 2.0})
    assert r.with_values([1.0]).fixed == {far: -1.0} and r._system.matrix()[1].tolist() == [1, far]


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16, np.uint32, np.uint64, np.int16])
def test_indices_of_every_integer_type(dtype):
    c = qless.Constraints(3)
    c.equation(np.array([0, 2], dtype), [1.0, -1.0])
    assert c.analyse(masters=np.array([0], dtype)).masters.tolist() == [0, 1]


def test_an_error_names_row_and_dof():
    broken = sp.csr_array((np.ones(2), np.array([0, 5]), np.array([0, 1, 2])), shape=(2, 6))
    broken._shape = (2, 3)
    with pytest.raises(qless.InputError) as raised:
        qless.analyse(broken, labels=["a", "b"])
    assert (raised.value.row, raised.value.dof) == (1, 5)


def test_options():
    for backend in ("faer", "sparse", "gauss"):
        assert qless.analyse(C, B, backend=backend, presolve=False).rank == 2
    for effort in ("quick", "checked", "proved", "exact"):
        assert qless.analyse(C, B, effort=effort).rank == 2
    with pytest.raises(qless.InputError):
        qless.analyse(C, B, effort="thorough")
    assert qless.analyse(C, B, masters=[0]).masters.tolist() == [0]
    assert qless.analyse(C, B, keep=[2]).independent.tolist() in ([0, 2], [1, 2])
    # The four-bar linkage with a row of rounding: a caller who knows the floor settles it.
    noisy = np.array([[1.0, 0.5], [3e-17, -2e-17]])
    assert qless.analyse(noisy, noise="none").rank == 2
    assert qless.analyse(noisy, noise=1e-12).rank == 1
    assert qless.analyse(noisy, noise=(np.full(2, 1e-15), np.full(2, 1e-15))).rank == 1


def test_prescribed_and_fixed():
    r = qless.analyse([[1, -1, 0], [0, 1, -1]], [0.5, 0], prescribed={2: 1.0})
    assert r.fixed == {0: 1.5, 1: 1.0}
    assert (r.prescribed.tolist(), r.masters.tolist(), r.u0.tolist()) == ([2], [], [1.5, 1.0, 1.0])
    assert r.G.toarray().tolist() == [[1.0], [1.0]]
    assert r.because_fixed(1)
    r.refresh(prescribed={2: 3.0})
    assert r.u0.tolist() == [3.5, 3.0, 3.0] and r.fixed == {0: 3.5, 1: 3.0}
    r.refresh(b=[0.0, 0.0], prescribed=[4.0])
    assert r.u0.tolist() == [4.0, 4.0, 4.0]
    for change in (r.refresh, r.with_values):
        with pytest.raises(qless.InputError, match="not prescribed"):
            change(prescribed={0: 1.0})


def test_refresh_refuses_conflicts_and_changes_nothing():
    r = qless.analyse([[1, -1], [2, -2]], [0, 0])
    r.refresh([1, 2])
    before = r.g.tolist()
    with pytest.raises(qless.Conflict) as raised:
        r.refresh([1, 1])
    assert raised.value.rows == [1] and raised.value.explanations[0].terms == [(0, 2.0)]
    assert r.g.tolist() == before == [1.0]


def test_refresh_finds_what_an_analysis_finds():
    r = qless.analyse([[1, 1], [0, 1], [1, 1]], [1000, 1, 1000])
    assert not r.ambiguous
    with pytest.raises(qless.Conflict):
        r.refresh([1000, 2e10, 1001])
    r.refresh([1000, 1, 1000 + 1e-7])
    assert r.ambiguous and r.doubt == "mismatch"
    r.refresh([1000, 1, 1000])
    assert not r.ambiguous


def test_texts():
    r = qless.analyse(C, B)
    assert repr(r) == r.report() and "row 2 = 1 * row 0 + 1 * row 1" in r.report() and "Rank 2 on 3 DOFs" in r.report()
    assert "<td>redundant</td>" in r._repr_html_()
    assert "&lt;b&gt;" in qless.analyse(C, B, labels=["<b>", "x", "y"])._repr_html_()
    assert '"status":"redundant"' in r.to_json()
    assert "All 1 equations are independent." in repr(qless.analyse([[1, 1]]))


def test_pickle_and_save(tmp_path):
    r = qless.analyse(C, B, prescribed={2: 0.5}, labels=["a", "b", "c"], growth=2.0)
    r.refresh(prescribed={2: 0.75})
    r.save(tmp_path / "r.pickle")
    for same in (pickle.loads(pickle.dumps(r)), qless.load(tmp_path / "r.pickle")):
        assert same.u0.tolist() == r.u0.tolist() and same.labels == r.labels and same.because(2) == r.because(2)


def test_threads_share_a_result():
    r = qless.analyse(sp.random_array((200, 400), density=0.02, rng=np.random.default_rng(1)).tocsr())
    x, found = np.ones(len(r.masters)), []
    work = lambda: found.append((r.expand(x).tobytes(), r.multipliers(np.ones(400)).tobytes(), r.refresh(np.zeros(200))))
    threads = [threading.Thread(target=work) for _ in range(4)]
    [thread.start() for thread in threads]
    [thread.join() for thread in threads]
    assert len({(u, y) for u, y, _ in found}) == 1 and len(found) == 4


def test_without_equations():
    r = qless.analyse(np.zeros((0, 3)))
    assert (r.rank, r.masters.tolist(), r.L.toarray().tolist()) == (0, [0, 1, 2], np.eye(3).tolist())

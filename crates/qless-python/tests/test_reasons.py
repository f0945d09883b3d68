"""Explanations over equations and prescribed values, and repairs."""

import numpy as np
import pytest

import qless

#: u0 = u1 + 0.25 and u1 = u2, with both ends prescribed.
CHAIN = np.array([[1.0, -1, 0], [0, 1, -1]])
LABELS, DOF_LABELS = ["weld", "bolt"], ["left", "middle", "right"]


def chain(right, labels=LABELS, dof_labels=DOF_LABELS):
    return qless.analyse(CHAIN, [0.25, 0], prescribed={0: 0.5, 2: right}, labels=labels, dof_labels=dof_labels)


def total(r, C, b, reason):
    """The sum of the members over all DOFs, and its right-hand side."""
    vector, value = np.zeros(C.shape[1]), 0.0
    for member in reason.members:
        if isinstance(member, qless.RowTerm):
            vector, value = vector + member.coefficient * C[member.row], value + member.coefficient * b[member.row]
        else:
            vector[member.dof] += member.coefficient
            value += member.coefficient * member.value
    return vector, value


def test_a_conflict_names_the_prescribed_values():
    r = chain(0.0)
    (row,) = r.conflicting
    reason = r.explain(row)
    assert (reason.rows, reason.dofs, reason.conflicts, reason.irreducible) == ([1 - row], [0, 2], True, True)
    vector, value = total(r, CHAIN, [0.25, 0], reason)
    np.testing.assert_allclose(vector, CHAIN[row], atol=1e-15)
    assert abs(value - reason.right_hand_side) < 1e-15 and abs(reason.asked - reason.right_hand_side) == 0.25
    assert '(DOF 0 "left" = 0.5)' in str(reason) and "right-hand sides differ by" in str(reason)
    assert r.explain(1 - row) is None


def test_the_exception_says_what_to_change():
    with pytest.raises(qless.Conflict, match=r'\(DOF 0 "left" = 0.5\)(.|\n)*to cure row 1, change.*DOF 2 "right": 0 -> 0.25'):
        chain(0.0).raise_if_conflicting()


def test_repairs_cure():
    r = chain(0.0)
    (repair,) = r.repairs()
    assert repair.conflicts == r.conflicting.tolist() and repair.total == len(repair.ways) == 4
    for ((row, dof, old, new, _),) in repair.ways:
        b, values = np.array([0.25, 0.0]), {0: 0.5, 2: 0.0}
        place = b if dof is None else values
        key = row if dof is None else dof
        assert place[key] == old
        place[key] = new
        assert not qless.analyse(CHAIN, b, prescribed=values).conflicting.size
    assert chain(0.25).repairs() == []


def test_a_plausible_change_comes_first():
    same = np.tile([1.0, -1], (4, 1))
    repair = qless.analyse(same, [0.01, 0.1, 0.01, 0.01]).repairs()[0]
    (change,) = repair.ways[0]
    assert (change.row, change.dof, change.old, change.new) == (1, None, 0.1, 0.01)
    assert "change b of row 1: 0.1 -> 0.01" in str(repair)


def test_ways_that_were_not_verified_are_counted():
    n = 30
    ties = np.eye(n) - np.eye(n, k=1)
    repair = qless.analyse(np.vstack([ties, np.ones(n) @ ties]), np.r_[np.zeros(n), 1.0]).repairs()[0]
    assert (len(repair.ways), repair.total) == (16, n + 1)
    assert str(repair).endswith(", or 12 other ways; 15 more were not verified")


def test_why_a_dof_is_fixed():
    r = qless.analyse(CHAIN[:1], [0.25], prescribed={0: 0.5}, labels=LABELS[:1], dof_labels=DOF_LABELS)
    reason = r.explain_fixed(1)
    vector, value = total(r, CHAIN[:1], [0.25], reason)
    assert vector.tolist() == [0, 1, 0] and value == reason.right_hand_side == r.fixed[1] == 0.25
    assert str(reason) == 'DOF 1 "middle" = 0.25, from - 1 * row 0 "weld" + 1 * (DOF 0 "left" = 0.5)'
    assert reason.irreducible and r.explain_fixed(0) is None and r.explain_fixed(2) is None
    with pytest.raises(qless.InputError, match="DOF -1"):
        r.explain_fixed(-1)


def test_explanations_are_shorter_than_certificates():
    """In a grid of equal DOFs, a redundant tie follows from the three others of its square."""
    n = 12
    grid = np.arange(n * n).reshape(n, n)
    c = qless.Constraints(n * n)
    c.equal(grid[:, 1:], grid[:, :-1])
    c.equal(grid[1:], grid[:-1])
    r = c.analyse()
    C, reasons = c.C.toarray(), [r.explain(row) for row in r.redundant]
    assert r.redundant.size == (n - 1) ** 2 and max(len(reason.members) for reason in reasons) == 3
    for row, reason in zip(r.redundant, reasons, strict=True):
        np.testing.assert_allclose(total(r, C, c.b, reason)[0], C[row], atol=1e-14)
        assert np.linalg.matrix_rank(C[reason.rows]) == len(reason.rows)


@pytest.mark.parametrize(("last", "irreducible"), [(1.0, True), (2.0**-27, False)])
def test_a_reason_that_is_too_long_to_be_examined_is_marked(last, irreducible):
    n = 160
    rows = sum(np.eye(n, n + 2, k=k) * a for k, a in enumerate([1, 4, 1]))
    r = qless.analyse(np.vstack([rows, np.r_[np.ones(n - 1), last] @ rows]))
    reason = r.explain(r.redundant[0])
    assert (len(reason.members), reason.irreducible) == (n, irreducible)


def test_a_row_of_rounding_says_that_it_counts_as_zero():
    r = qless.analyse([[1.0, 0.5], [3e-17, -2e-17]], noise=1e-12)
    for text in (str(r.because(1)), str(r.explain(1))):
        assert text == "row 1 = 0 (without 2 coefficients that count as zero, as rounding)"


def test_a_reason_says_that_it_does_not_hold():
    assert str(qless.Reason([], 0.0, 0.0, False, 1.0, False, "row 3")) == "row 3 = 0 (only to a relative error of 1.0e+00)"
    assert str(qless.Reason([], 0.0, 0.0, False, 1e-12, True, "row 3")) == "row 3 = 0"


def test_the_empty_equation_and_long_texts():
    reason = qless.analyse([[0.0, 0.0]], [1.0]).explain(0)
    assert (reason.members, reason.right_hand_side) == ([], 0.0)
    assert str(reason) == "row 0 = 0, but the right-hand sides differ by 1"
    n = 30
    rows = np.vstack([np.eye(n) - np.eye(n, k=1), np.ones((1, n)) @ (np.eye(n) - np.eye(n, k=1))])
    said = str(qless.analyse(rows, np.r_[np.zeros(n), 1.0]).explain(n))
    assert said.endswith("differ by 1") and ("and 18 more" in said or len(said) < 200)
    with pytest.raises(qless.InputError, match="out of range"):
        qless.analyse(rows).explain(n + 1)

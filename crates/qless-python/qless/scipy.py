"""SciPy and HiGHS: linear programs whose equations imply others.

    res = qless.scipy.linprog(c, A_eq=A, b_eq=b)            # arguments and result of scipy.optimize.linprog
    lp = qless.scipy.highs(h)                               # a highspy.Highs whose model is loaded; removes rows
    h.run(); y = lp.duals(h.getSolution().row_dual)         # duals of all rows

Rows that follow from others make duals ambiguous and bases singular. Only equations are examined: inequalities stay as they are. Dropped
rows have the dual 0, which is one of the optimal choices.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ._errors import InputError
from ._matrix import is_sparse
from ._presolve import Presolved, presolve


def linprog(
    c: Any,
    A_ub: Any = None,  # noqa: N803
    b_ub: Any = None,
    A_eq: Any = None,  # noqa: N803
    b_eq: Any = None,
    *args: Any,
    presolve_options: dict[str, Any] | None = None,
    **kwargs: Any,
) -> Any:
    """``scipy.optimize.linprog`` on the independent equations; ``eqlin`` and ``con`` of the result have all rows.

    The result has the :class:`qless.Presolved` as ``presolved``. Raises :class:`qless.Conflict` with a proof if the equations alone are
    infeasible. `presolve_options` are those of :func:`qless.analyse`.
    """
    from scipy import optimize

    if A_eq is None:
        return optimize.linprog(c, A_ub, b_ub, A_eq, b_eq, *args, **kwargs)
    if b_eq is None:
        raise InputError("A_eq is given without b_eq; give the right-hand sides of the equations")
    matrix = A_eq if is_sparse(A_eq) else np.asarray(A_eq)
    found = presolve(matrix, b_eq, **(presolve_options or {})).raise_if_conflicting()
    result = optimize.linprog(c, A_ub, b_ub, found.A, found.b, *args, **kwargs)
    result.presolved = found
    if result.get("x") is not None:
        result.con = np.asarray(b_eq, dtype=float) - matrix @ result.x
        if "eqlin" in result and result.eqlin.marginals is not None:
            result.eqlin.residual = result.con
            result.eqlin.marginals = found.lift_duals(result.eqlin.marginals)
    return result


class Reduced:
    """A program of HiGHS without equations that others imply."""

    def __init__(self, found: Presolved, equations: np.ndarray, rows: int) -> None:
        #: The verdict on the equations; its rows are those of :attr:`equations`.
        self.presolved = found
        #: Rows of the original program that are equations.
        self.equations = equations
        #: Rows of the original program that were removed.
        self.removed: np.ndarray = equations[found.redundant]
        #: Rows of the original program that are left, in their order.
        self.rows: np.ndarray = np.setdiff1d(np.arange(rows), self.removed)
        self._count = rows

    def duals(self, row_dual: Any) -> np.ndarray:
        """Duals of all rows of the original program from those of the rows that are left; zero for removed rows."""
        given = np.asarray(row_dual, dtype=float)
        if given.shape != self.rows.shape:
            raise InputError(f"there are {given.size} duals; {self.rows.size} rows are left, give one for each")
        all_duals = np.zeros(self._count)
        all_duals[self.rows] = given
        return all_duals


def highs(h: Any, **options: Any) -> Reduced:
    """Removes the equations that others imply from the model of a ``highspy.Highs``.

    Equations are rows with equal bounds. Raises :class:`qless.Conflict` with a proof if they are infeasible; nothing is removed then. Its
    rows count among the equations, and are labelled by the names of HiGHS, or by ``row`` and their number in the program.
    """
    lp = h.getLp()
    lower, upper = np.asarray(lp.row_lower_, dtype=float), np.asarray(lp.row_upper_, dtype=float)
    equations = np.flatnonzero((lower == upper) & np.isfinite(lower))
    names = list(lp.row_names_)
    labels = [(names[i] if i < len(names) and names[i] else f"row {i}") for i in equations.tolist()]
    found = presolve(_matrix(lp)[equations], lower[equations], labels=labels, **options).raise_if_conflicting()
    reduced = Reduced(found, equations, len(lower))
    if reduced.removed.size:
        h.deleteRows(len(reduced.removed), reduced.removed.astype(np.int32))
    return reduced


def _matrix(lp: Any) -> Any:
    """The matrix of a program in compressed rows."""
    from scipy import sparse

    matrix = lp.a_matrix_
    arrays = np.asarray(matrix.value_), np.asarray(matrix.index_), np.asarray(matrix.start_)
    is_by_columns = matrix.format_.name == "kColwise"
    make = sparse.csc_array if is_by_columns else sparse.csr_array
    return make(arrays, shape=(lp.num_row_, lp.num_col_)).tocsr()

"""Removes the equations of a linear program that others imply, and computes duals for all equations."""

from __future__ import annotations

from typing import Any

import numpy as np

from ._matrix import doubles, is_sparse
from ._result import Result, make


class Presolved:
    """``A x = b`` without rows that are combinations of others.

    ``A`` and ``b`` are the independent rows of the input, in its order and type. If equations conflict, no x satisfies all of them; call
    :meth:`raise_if_conflicting` to detect this.
    """

    def __init__(self, A_eq: Any, b_eq: Any, **options: Any) -> None:  # noqa: N803
        self.result: Result = make(A_eq, b_eq, **options)
        #: Rows of `A_eq` that are kept.
        self.rows: np.ndarray = self.result.independent
        self.A: Any = A_eq.tocsr()[self.rows] if is_sparse(A_eq) else np.asarray(A_eq)[self.rows]
        self.b: np.ndarray = np.asarray(b_eq)[self.rows]

    @property
    def redundant(self) -> np.ndarray:
        """Rows that others imply."""
        return self.result.redundant

    @property
    def conflicting(self) -> np.ndarray:
        """Rows that contradict others: the program is infeasible."""
        return self.result.conflicting

    def raise_if_conflicting(self) -> Presolved:
        """Raises :class:`qless.Conflict` with ``y' A = 0, y' b != 0`` if the equations are infeasible; returns itself."""
        self.result.raise_if_conflicting()
        return self

    def lift_duals(self, duals: Any) -> np.ndarray:
        """Duals of all rows from those of the kept rows; zero for dropped rows."""
        all_duals = np.zeros(self.result.shape[0])
        all_duals[self.rows] = doubles(duals, self.rows.shape)
        return all_duals

    def __repr__(self) -> str:
        return self.result.report()


def presolve(A_eq: Any, b_eq: Any, **options: Any) -> Presolved:  # noqa: N803
    """Removes the equations of a linear program that others imply. Options are those of :func:`qless.analyse`."""
    return Presolved(A_eq, b_eq, **options)

"""Finds and explains redundant and conflicting linear constraint equations ``C u = b``, and computes their reduced form.

    >>> import qless
    >>> r = qless.analyse([[1, -1, 2], [1, 2, -1], [2, 1, 1]], b=[1, 0, 1])
    >>> r.rank, r.redundant.tolist(), str(r.because(2))
    (2, [2], 'row 2 = 1 * row 0 + 1 * row 1')
    >>> r.slaves.tolist(), r.masters.tolist(), r.T.toarray().round(12).tolist()
    ([0, 1], [2], [[-1.0], [1.0]])

Rows and DOFs count from 0. Only results that are sparse matrices need scipy.
"""

from __future__ import annotations

import warnings as _warnings
from collections.abc import Mapping, Sequence
from typing import Any

from . import _qless, _result
from ._constraints import Constraints
from ._errors import Conflict, Error, FactorError, InputError, ReadError, ReductionError
from ._presolve import Presolved, presolve
from ._qless import __version__
from ._reasons import Change, Reason, Repair, RowTerm, ValueTerm
from ._result import Digits, Explanation, Kind, Result, load

__all__ = [
    "Change",
    "Conflict",
    "Constraints",
    "Digits",
    "Error",
    "Explanation",
    "FactorError",
    "InputError",
    "Kind",
    "Presolved",
    "ReadError",
    "Reason",
    "ReductionError",
    "Repair",
    "Result",
    "RowTerm",
    "ValueTerm",
    "__version__",
    "analyse",
    "load",
    "presolve",
    "read",
]


def analyse(
    C: Any,  # noqa: N803
    b: Any = None,
    prescribed: Mapping[int, float] | tuple[Any, Any] | None = None,
    labels: Sequence[str] | None = None,
    dof_labels: Sequence[str] | None = None,
    **options: Any,
) -> Result:
    """Diagnoses ``C u = b``.

    C is m x n, a dense array or a matrix of scipy.sparse, of f32 or f64; b is zero if it is not given. `prescribed` has the
    prescribed DOFs and their values, as a mapping or as (DOFs, values).

    Options: `tolerance` (relative, 1e-10), `noise` ("auto", "none", a relative size, or floors for the coefficients and right-hand side
    of each row), `effort` ("quick", "checked", "proved", "exact"), `backend` ("faer", "sparse", "gauss"), `presolve`, `growth` (bound of
    ``max |T_ij|``, 4), `memory` (bytes for one block), `masters` and `slaves` (DOFs that should be masters or slaves, if possible), `keep`
    (rows to keep if others can be dropped instead).

    Raises :class:`InputError` with row, DOF and label for numbers that are not finite and indices out of range, and for numbers that are
    masked, dates, or whole numbers that f64 would round.
    """
    return _result.make(C, b, prescribed, labels, dof_labels, **options)


def read(path: Any, solver: str | None = None, case: str | None = None) -> Constraints:
    """Reads the equations of a deck of CalculiX, Abaqus, Nastran or ANSYS, a Matrix Market file or a case folder.

    `case` names the load case, which is required if load cases constrain differently. Constraints that are not understood are left out
    with a warning and listed in ``left_out``.
    """
    system, warnings, left_out = _qless.read(str(path), solver, case)
    constraints = Constraints._of(system)
    constraints.warnings, constraints.left_out = warnings, left_out
    for one in left_out:
        _warnings.warn(f"{path}: left out: {one}", stacklevel=2)
    return constraints

"""scikit-fem: ``u = skfem.solve(*qless.skfem.condense(result, K, f))``.

``skfem.mpc`` takes slaves, masters, T and g, but leaves ``T^T A_S`` out, so that its solution does not balance the forces of slaves.
Here the matrix is ``L^T K L``.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ._result import Result


def condense(result: Result, K: Any, f: Any = None) -> tuple[Any, np.ndarray, np.ndarray, tuple[np.ndarray, Any]]:  # noqa: N803
    """``(K_q, f_q, x, I)`` as ``skfem.solve`` takes it; its solution has all DOFs."""
    k_q, f_q = result.condense(K, f)
    return k_q, f_q, np.zeros(result.shape[1]), (np.arange(result.shape[1]), result.expand)

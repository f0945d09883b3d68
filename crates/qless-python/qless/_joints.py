"""Noise floors of Jacobians of mechanisms, which MuJoCo and Pinocchio share."""

from __future__ import annotations

from typing import Any

import numpy as np

from ._matrix import is_sparse

#: Error of a coefficient, as a fraction of the largest of its kind: kinematics loses a few digits of f64, never this many.
NOISE = 1e-12


def floors(J: Any, kinds: np.ndarray, noise: float) -> tuple[np.ndarray, np.ndarray]:  # noqa: N803
    """Sizes below which coefficients and right-hand sides count as zero, by row.

    Rows of one kind have one unit, metres or radians. A row in an unlucky direction consists of rounding only, so that its size must be
    compared with that of all rows of its kind, not with its own.
    """
    sizes = abs(J).max(axis=1)
    sizes = sizes.toarray().ravel() if is_sparse(sizes) else np.asarray(sizes).ravel()
    largest = np.zeros(len(sizes))
    for kind in np.unique(kinds):
        largest[kinds == kind] = sizes[kinds == kind].max(initial=0.0)
    return noise * largest, noise * largest

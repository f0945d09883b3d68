"""dolfinx_mpc: the arrays of ``MultiPointConstraint.add_constraint`` from a reduced form.

    a = qless.dolfinx.arrays(result)
    mpc = dolfinx_mpc.MultiPointConstraint(V)
    mpc.add_constraint(V, a.slaves, a.masters, a.coefficients, a.owners, a.offsets)
    mpc.finalize()

dolfinx_mpc assumes that no slave is a master and that each has one equation. Equations as users write them seldom are so; the reduced form
always is. dolfinx itself is not needed here.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ._errors import InputError
from ._matrix import doubles, integers
from ._result import Result


class Arrays(NamedTuple):
    """``u[slaves[i]] = sum_k coefficients[k] u[masters[k]] + constants[i]`` for k from ``offsets[i]`` to ``offsets[i + 1]``."""

    #: Slaves by the numbering of this process, int32.
    slaves: np.ndarray
    #: Masters by the numbering of all processes, int64.
    masters: np.ndarray
    coefficients: np.ndarray
    #: The process that owns each master, int32.
    owners: np.ndarray
    #: Where the masters of each slave start, int32.
    offsets: np.ndarray
    #: g. dolfinx_mpc takes homogeneous equations; add these numbers by a lift of the right-hand side, or check that they are zero.
    constants: np.ndarray


def arrays(result: Result, ranges: Any = None, rank: int = 0, ghosts: Any = ()) -> Arrays:
    """The arrays for one process; DOFs of the result have the numbering of all processes.

    `ranges` are the first DOFs of all processes and the number of DOFs, ``[0, ..., n]``; without it there is one process. `rank` is this
    process, and `ghosts` are its DOFs that others own, ``V.dofmap.index_map.ghosts`` times the block size. Prescribed DOFs are masters
    too: dolfinx_mpc takes their values from the boundary conditions.
    """
    ranges = np.array([0, result.shape[1]]) if ranges is None else integers(ranges).astype(np.int64)
    _check(ranges, rank, result.shape[1])
    starts, masters, coefficients = _rows(result)
    local = _local(result.slaves, ranges[rank], ranges[rank + 1], integers(np.asarray(ghosts, dtype=np.int64)))
    here = np.flatnonzero(local >= 0)
    # Slaves ascend by their local number.
    here = here[np.argsort(local[here])]
    counts = np.diff(starts)[here]
    offsets = np.r_[0, np.cumsum(counts)]
    places = np.repeat(starts[:-1][here] - offsets[:-1], counts) + np.arange(offsets[-1])
    owners = np.searchsorted(ranges, masters[places], side="right") - 1
    return Arrays(
        slaves=local[here].astype(np.int32),
        masters=masters[places].astype(np.int64),
        coefficients=doubles(coefficients[places]),
        owners=owners.astype(np.int32),
        offsets=offsets.astype(np.int32),
        constants=result.g[here],
    )


def _check(ranges: np.ndarray, rank: int, dofs: int) -> None:
    if ranges.ndim != 1 or len(ranges) < 2 or ranges[0] != 0 or ranges[-1] != dofs or (np.diff(ranges) < 0).any():
        raise InputError(f"ranges are {ranges.tolist()}; give ascending first DOFs of all processes, from 0 to the number of DOFs, {dofs}")
    if not 0 <= rank < len(ranges) - 1:
        raise InputError(f"rank {rank}: ranges are those of {len(ranges) - 1} processes, which count from 0")


def _rows(result: Result) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(starts, DOFs, coefficients) of T and G side by side, by slave; DOFs ascend within a slave."""
    T, G = result.T.tocoo(), result.G.tocoo()  # noqa: N806
    rows = np.r_[T.coords[0], G.coords[0]]
    dofs = np.r_[result.masters[T.coords[1]], result.prescribed[G.coords[1]]]
    order = np.lexsort((dofs, rows))
    starts = np.r_[0, np.cumsum(np.bincount(rows, minlength=len(result.slaves)))]
    return starts, dofs[order], np.r_[T.data, G.data][order]


def _local(slaves: np.ndarray, first: int, last: int, ghosts: np.ndarray) -> np.ndarray:
    """The number of each slave in this process: own DOFs first, then ghosts; -1 for slaves that this process does not know."""
    local = np.where((slaves >= first) & (slaves < last), slaves - first, -1)
    if ghosts.size:
        order = np.argsort(ghosts)
        place = np.minimum(np.searchsorted(ghosts[order], slaves), len(ghosts) - 1)
        is_ghost = ghosts[order][place] == slaves
        local[is_ghost] = last - first + order[place[is_ghost]]
    return local

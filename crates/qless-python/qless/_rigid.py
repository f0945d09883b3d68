"""Equations of a rigid body, for small rotations: ``u_i = u_0 + w x (x_i - x_0)``."""

from __future__ import annotations

from typing import Any

import numpy as np

from ._errors import InputError
from ._matrix import doubles, integers

Rows = tuple[np.ndarray, np.ndarray, np.ndarray]


def rigid_rows(dofs: np.ndarray, points: np.ndarray, reference: Any, centre: Any) -> Rows:
    """Lengths, columns and values of the rows."""
    dofs, points = _by_node(dofs, points)
    if reference is None:
        return _free(dofs, points)
    d = dofs.shape[1]
    reference = np.ravel(integers(reference))
    if len(reference) != d + _rotations(d):
        raise InputError(f"rigid: the reference has {len(reference)} DOFs; {d} translations and {_rotations(d)} rotations are needed")
    arms = points - doubles(points.mean(axis=0) if centre is None else centre)
    count = dofs.size
    motion = np.concatenate([np.tile(np.eye(d), (len(dofs), 1)), turns(arms).reshape(count, -1)], axis=1)
    return _compressed(np.c_[dofs.ravel(), np.tile(reference, (count, 1))], np.c_[np.ones(count), -motion])


def _by_node(dofs: np.ndarray, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Both arrays as (nodes, d). The axis of length 2 or 3 is that of directions; if both have such a length, the last one is."""
    if dofs.ndim != 2 or dofs.shape != points.shape:
        raise InputError(f"rigid: DOFs are {dofs.shape}, points {points.shape}; give both as (nodes, d) or (d, nodes), d = 2 or 3")
    if dofs.shape[1] not in (2, 3):
        dofs, points = dofs.T, points.T
    if dofs.shape[1] not in (2, 3):
        raise InputError(f"rigid: DOFs are {dofs.shape}; give them as (nodes, d) or (d, nodes), d = 2 or 3")
    return dofs, points


def _rotations(d: int) -> int:
    return 1 if d == 2 else 3


def turns(arms: np.ndarray) -> np.ndarray:
    """``w x arm`` as (nodes, d, rotations)."""
    if arms.shape[1] == 2:
        return np.stack([-arms[:, 1], arms[:, 0]], axis=1)[:, :, None]
    x, y, z = arms.T
    zero = np.zeros_like(x)
    return np.stack([zero, z, -y, -z, zero, x, y, -x, zero], axis=1).reshape(-1, 3, 3)


def _compressed(columns: np.ndarray, values: np.ndarray) -> Rows:
    used = values != 0.0
    return used.sum(axis=1), columns[used], values[used]


def _free(dofs: np.ndarray, points: np.ndarray) -> Rows:
    """Without a reference: carrier nodes far from each other determine the motion, and all other nodes follow it."""
    carriers = _carriers(points)
    carried, arms = dofs[carriers].ravel(), points - points[carriers[0]]
    d, nodes = dofs.shape[1], len(dofs)
    modes = np.concatenate([np.tile(np.eye(d), (nodes, 1, 1)), turns(arms)], axis=2)
    of_carriers = modes[carriers].reshape(len(carried), modes.shape[2])
    # The first equations exclude the non-rigid motions of the carriers, given by an orthonormal basis.
    full, sizes, _ = np.linalg.svd(of_carriers)
    rank = int((sizes > 1e-10 * sizes[0]).sum())
    own = full[:, rank:].T
    others = np.setdiff1d(np.arange(nodes), carriers)
    # u_i = modes_i q with q = pinv(of_carriers) u_carriers.
    follow = modes[others].reshape(len(others) * d, modes.shape[2]) @ np.linalg.pinv(of_carriers, rcond=1e-10)
    follow[np.abs(follow) < 1e-14 * np.abs(follow).max(initial=1.0)] = 0.0
    own[np.abs(own) < 1e-14] = 0.0
    carried_rows = _compressed(np.tile(carried, (len(own), 1)), own)
    rows = np.c_[dofs[others].ravel(), np.tile(carried, (len(follow), 1))]
    other_rows = _compressed(rows, np.c_[np.ones(len(follow)), -follow])
    lengths, columns, values = (np.concatenate(pair) for pair in zip(carried_rows, other_rows, strict=True))
    return lengths, columns, values


def _carriers(points: np.ndarray) -> np.ndarray:
    """The first node, the one farthest from it, and in 3D the one farthest from the line through both."""
    arms = points - points[0]
    distance = np.linalg.norm(arms, axis=1)
    far = int(distance.argmax())
    if distance[far] == 0.0:
        return np.array([0])
    carriers = [0, far]
    if points.shape[1] == 3:
        along = arms[far] / distance[far]
        aside = np.linalg.norm(arms - np.outer(arms @ along, along), axis=1)
        # A node on the line does not determine the rotation about it.
        if aside.max() > 1e-10 * distance[far]:
            carriers.append(int(aside.argmax()))
    return np.array(carriers)

"""MuJoCo: which equality constraints of a model are redundant.

``qless.mujoco.analyse(model, data)`` takes the rows of ``efc_J`` that belong to equality constraints, in the configuration of `data`;
call ``mujoco.mj_forward(model, data)`` before. Rows have the name of their constraint and a component, DOFs that of their joint.
"""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np

from ._errors import InputError
from ._joints import NOISE, floors
from ._result import Result, make

_AXES = ("x", "y", "z")
_COMPONENTS = {
    mujoco.mjtEq.mjEQ_CONNECT: _AXES,
    mujoco.mjtEq.mjEQ_WELD: (*_AXES, *(f"rotation {axis}" for axis in _AXES)),
}


def analyse(model: Any, data: Any, b: Any = None, noise: Any = NOISE, **options: Any) -> Result:
    """Diagnoses ``J v = b`` of the equality constraints that are active in `data`.

    b is zero if it is not given: the equations of velocities. ``-data.efc_pos[rows(data)]`` gives those of a position correction. `noise`
    is the relative error of the kinematics, compared with the largest coefficient of translations or rotations; other values and
    `options` are those of :func:`qless.analyse`.
    """
    J = jacobian(model, data)  # noqa: N806
    if isinstance(noise, float):
        noise = floors(J, _kinds(model, data), noise)
    return make(J, b, None, labels(model, data), dof_labels(model), noise=noise, **options)


def rows(data: Any) -> np.ndarray:
    """Rows of ``efc_J`` that belong to equality constraints."""
    return np.flatnonzero(data.efc_type == mujoco.mjtConstraint.mjCNSTR_EQUALITY)


def jacobian(model: Any, data: Any) -> Any:
    """The rows of ``efc_J`` that belong to equality constraints: a matrix of scipy.sparse if the model uses a sparse one, else dense."""
    wanted = rows(data)
    if not wanted.size:
        raise InputError("the model has no active equality constraint here; call mujoco.mj_forward(model, data) first, or check eq_active")
    if not mujoco.mj_isSparse(model):
        return data.efc_J.reshape(-1, model.nv)[wanted]
    from scipy import sparse

    counts = data.efc_J_rownnz[wanted]
    starts = np.r_[0, np.cumsum(counts)]
    places = np.repeat(data.efc_J_rowadr[wanted] - starts[:-1], counts) + np.arange(starts[-1])
    return sparse.csr_array((data.efc_J.ravel()[places], data.efc_J_colind.ravel()[places], starts), shape=(len(wanted), model.nv))


def labels(model: Any, data: Any) -> list[str]:
    """A label for each row: name of the constraint and component, such as ``loop rotation x``."""
    ids = data.efc_id[rows(data)]
    parts = _components(ids)
    return [_label(model, int(i), int(part)) for i, part in zip(ids, parts, strict=True)]


def dof_labels(model: Any) -> list[str]:
    """A label for each DOF: the name of its joint, and the number within the joint if it has several."""
    joints = model.dof_jntid.tolist()
    names = [model.joint(joint).name or f"joint {joint}" for joint in joints]
    return [
        f"{name} {k - joints.index(joint)}" if joints.count(joint) > 1 else name
        for k, (joint, name) in enumerate(zip(joints, names, strict=True))
    ]


def _components(ids: np.ndarray) -> np.ndarray:
    """The number of each row within its constraint, whose rows are adjacent."""
    first = np.r_[True, ids[1:] != ids[:-1]]
    return np.arange(len(ids)) - np.maximum.accumulate(np.where(first, np.arange(len(ids)), 0))


def _label(model: Any, constraint: int, part: int) -> str:
    name = model.equality(constraint).name or f"equality {constraint}"
    known = _COMPONENTS.get(mujoco.mjtEq(int(model.eq_type[constraint])))
    if known is not None:
        return f"{name} {known[part]}"
    return name if part == 0 else f"{name} [{part}]"


def _kinds(model: Any, data: Any) -> np.ndarray:
    """0 for translations, 1 for rotations, and a number of their own for all other constraints."""
    ids = data.efc_id[rows(data)]
    is_rotation = (model.eq_type[ids] == mujoco.mjtEq.mjEQ_WELD) & (_components(ids) >= 3)
    is_point = np.isin(model.eq_type[ids], [int(kind) for kind in _COMPONENTS])
    return np.where(is_point, is_rotation.astype(int), 2 + ids)

"""Pinocchio: which rows of rigid constraints, such as closed loops, are redundant.

``qless.pinocchio.analyse(model, q, constraints)`` computes the Jacobian of ``pinocchio.RigidConstraintModel`` objects in the configuration
q. Rows have the name of their constraint, or its number, and a component; DOFs have the name of their joint.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pinocchio

from ._errors import InputError
from ._joints import NOISE, floors
from ._result import Result, make

_COMPONENTS = ("x", "y", "z", "rotation x", "rotation y", "rotation z")


def analyse(model: Any, q: Any, constraints: Sequence[Any], b: Any = None, noise: Any = NOISE, **options: Any) -> Result:
    """Diagnoses ``J v = b`` of rigid constraints in the configuration q.

    b is zero if it is not given. `noise` is the relative error of the kinematics, compared with the largest coefficient of translations or
    rotations; other values and `options` are those of :func:`qless.analyse`.
    """
    J = jacobian(model, q, constraints)  # noqa: N806
    if isinstance(noise, float):
        noise = floors(J, np.array([part >= 3 for constraint in constraints for part in range(_size(constraint))]), noise)
    return make(J, b, None, labels(constraints), dof_labels(model), noise=noise, **options)


def jacobian(model: Any, q: Any, constraints: Sequence[Any]) -> np.ndarray:
    """The Jacobian of all constraints, rows x ``model.nv``."""
    q = np.asarray(q, dtype=float)
    if q.shape != (model.nq,):
        raise InputError(f"q has the shape {q.shape}; the model has {model.nq} coordinates")
    if not constraints:
        raise InputError("there are no constraints; give a list of pinocchio.RigidConstraintModel")
    data = model.createData()
    pinocchio.computeJointJacobians(model, data, q)
    models, datas = pinocchio.StdVec_RigidConstraintModel(), pinocchio.StdVec_RigidConstraintData()
    for constraint in constraints:
        own = constraint.createData()
        # Since Pinocchio 4, the frames of a constraint are not those of q before this call.
        if hasattr(constraint, "calc"):
            constraint.calc(model, data, own)
        models.append(constraint)
        datas.append(own)
    return np.asarray(pinocchio.getConstraintsJacobian(model, data, models, datas))


def labels(constraints: Sequence[Any]) -> list[str]:
    """A label for each row: name of the constraint and component, such as ``loop rotation x``."""
    names = [constraint.name or f"constraint {k}" for k, constraint in enumerate(constraints)]
    sizes = [_size(constraint) for constraint in constraints]
    return [f"{name} {part}" for name, size in zip(names, sizes, strict=True) for part in _COMPONENTS[:size]]


def dof_labels(model: Any) -> list[str]:
    """A label for each DOF: the name of its joint, and the number within the joint if it has several."""
    found: list[str] = []
    # The first joint is the universe, which has no DOF.
    for name, size in list(zip(model.names, model.nvs, strict=True))[1:]:
        found.extend([name] if size == 1 else [f"{name} {k}" for k in range(size)])
    return found


def _size(constraint: Any) -> int:
    return 6 if constraint.type == pinocchio.ContactType.CONTACT_6D else 3

"""Pinocchio: Bennett's linkage, closed by a rigid constraint, in many base orientations."""

import mechanisms
import numpy as np
import optional
import pytest

import qless

pin = optional.package("pinocchio")
import qless.pinocchio


def linkage(base):
    """Four links, and the constraint that the last one does not move."""
    frames = [pin.SE3(R, p) for R, p in mechanisms.links(1.0, base)]
    model, last, joint = pin.Model(), pin.SE3.Identity(), 0
    for k, frame in enumerate(frames[:4]):
        joint = model.addJoint(joint, pin.JointModelRZ(), last.inverse() * frame, f"hinge {k}")
        last = frame
    loop = pin.RigidConstraintModel(pin.ContactType.CONTACT_6D, model, joint, last.inverse() * frames[4], 0, frames[4])
    point = pin.RigidConstraintModel(pin.ContactType.CONTACT_3D, model, joint, pin.SE3.Identity(), 0, last)
    loop.name, point.name = "loop", "pin"
    return model, [loop, point]


def test_rank_of_an_overconstrained_loop_in_every_orientation():
    for base in mechanisms.bases():
        model, constraints = linkage(base)
        q = pin.neutral(model)
        r = qless.pinocchio.analyse(model, q, constraints)

        J = qless.pinocchio.jacobian(model, q, constraints)
        assert r.rank == mechanisms.rank_by_svd(J, np.arange(9)) == 3
        assert mechanisms.rank_by_svd(J, r.independent) == 3
        assert (r.redundant.size, r.conflicting.size) == (6, 0)
        assert r.doubt is None
        # One motion is left, and it keeps the loop closed.
        assert r.nullspace().shape == (4, 1) and np.abs(J @ r.nullspace().toarray()).max() <= 1e-12


def test_the_jacobian_is_that_of_the_geometry():
    """Rows are velocities of the first joint relative to the second one, up to sign, in the axes of the constraint."""
    base = mechanisms.bases()[0]
    model, constraints = linkage(base)
    J = qless.pinocchio.jacobian(model, pin.neutral(model), constraints)
    frames = mechanisms.links(1.0, base)
    R = frames[4][0]
    v, w = mechanisms.velocities(frames, frames[4][1])
    pin_v, _ = mechanisms.velocities(frames, frames[3][1])
    expected = np.vstack([R.T @ v, R.T @ w, frames[3][0].T @ pin_v])
    np.testing.assert_allclose(np.sign(J[3, 0] * expected[3, 0]) * J, expected, atol=1e-14)


def test_rows_and_dofs_have_names():
    model, constraints = linkage(np.eye(3))
    r = qless.pinocchio.analyse(model, pin.neutral(model), constraints)
    loop = [f"loop {part}" for part in ("x", "y", "z", "rotation x", "rotation y", "rotation z")]
    assert r.labels == [*loop, "pin x", "pin y", "pin z"]
    assert qless.pinocchio.dof_labels(model) == [f"hinge {k}" for k in range(4)]
    assert all(f'"{r.labels[row]}"' in str(r.because(row)) for row in r.redundant)


def test_bad_input_is_named():
    model, constraints = linkage(np.eye(3))
    with pytest.raises(qless.InputError, match=r"shape \(3,\); the model has 4 coordinates"):
        qless.pinocchio.analyse(model, np.zeros(3), constraints)
    with pytest.raises(qless.InputError, match="there are no constraints"):
        qless.pinocchio.analyse(model, pin.neutral(model), [])

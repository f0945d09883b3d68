"""MuJoCo: Bennett's linkage, closed by a weld, in many base orientations."""

import mechanisms
import numpy as np
import optional
import pytest

import qless

mujoco = optional.package("mujoco")
import qless.mujoco


def text(numbers):
    return " ".join(f"{x:.17g}" for x in np.ravel(numbers))


def linkage(base, jacobian="dense"):
    """Four bodies, one in the other, and a weld of the last one to the world."""
    frames = mechanisms.links(1.0, base)
    spec, R, p, closed = "", np.eye(3), np.zeros(3), ""
    for k, (turned, position) in enumerate(frames[:4]):
        axes = (R.T @ turned)[:, :2].T
        spec += f'<body name="link {k}" pos="{text(R.T @ (position - p))}" xyaxes="{text(axes)}">'
        spec += f'<joint name="hinge {k}" axis="0 0 1"/><geom size="0.1" contype="0"/>'
        (R, p), closed = (turned, position), closed + "</body>"
    weld = '<equality><weld name="loop" body1="link 3"/><connect name="pin" body1="link 3" anchor="0 0 0"/></equality>'
    return mujoco.MjModel.from_xml_string(
        f'<mujoco><compiler autolimits="true"/><option jacobian="{jacobian}"/><worldbody>{spec}{closed}</worldbody>{weld}</mujoco>'
    )


@pytest.mark.parametrize("jacobian", ["dense", "sparse"])
def test_rank_of_an_overconstrained_loop_in_every_orientation(jacobian):
    for base in mechanisms.bases():
        model = linkage(base, jacobian)
        data = mujoco.MjData(model)
        mujoco.mj_forward(model, data)
        r = qless.mujoco.analyse(model, data)

        J = qless.mujoco.jacobian(model, data)
        J = J if jacobian == "dense" else J.toarray()
        assert r.rank == mechanisms.rank_by_svd(J, np.arange(9)) == 3
        assert mechanisms.rank_by_svd(J, r.independent) == 3
        assert (r.redundant.size, r.conflicting.size, r.ambiguous) == (6, 0, False)
        # One motion is left, and it keeps the loop closed.
        assert r.nullspace().shape == (4, 1) and np.abs(J @ r.nullspace().toarray()).max() <= 1e-12


def test_the_jacobian_is_that_of_the_geometry():
    base = mechanisms.bases()[0]
    model = linkage(base)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    frames = mechanisms.links(1.0, base)
    v, _ = mechanisms.velocities(frames, frames[3][1])
    np.testing.assert_allclose(qless.mujoco.jacobian(model, data)[6:], v, atol=1e-14)


def test_rows_and_dofs_have_names():
    model = linkage(np.eye(3))
    data = mujoco.MjData(model)
    with pytest.raises(qless.InputError, match="mj_forward"):
        qless.mujoco.analyse(model, data)
    mujoco.mj_forward(model, data)
    r = qless.mujoco.analyse(model, data)
    loop = [f"loop {part}" for part in ("x", "y", "z", "rotation x", "rotation y", "rotation z")]
    assert r.labels == [*loop, "pin x", "pin y", "pin z"]
    assert {r.labels[row] for row in r.redundant} >= {"pin x", "pin y", "pin z"} or '"pin' in r.report()
    assert qless.mujoco.dof_labels(model) == [f"hinge {k}" for k in range(4)]
    assert all(f'"{r.labels[row]}"' in str(r.because(row)) for row in r.redundant)


def test_a_position_correction():
    """A loop that is not closed: no velocity of its joints takes all of its residual away."""
    model = linkage(mechanisms.bases()[0])
    data = mujoco.MjData(model)
    data.qpos[:] = [0.0, 0.01, 0.0, 0.0]
    mujoco.mj_forward(model, data)
    r = qless.mujoco.analyse(model, data, b=-data.efc_pos[qless.mujoco.rows(data)], noise="auto")
    assert r.rank == mechanisms.rank_by_svd(qless.mujoco.jacobian(model, data), np.arange(9)) == 4
    assert (r.redundant.size, r.conflicting.size) == (0, 5)


def test_other_equalities():
    model = mujoco.MjModel.from_xml_string("""
        <mujoco><worldbody>
          <body><freejoint name="free"/><geom size="0.1" contype="0"/></body>
          <body><joint name="a" type="slide"/><joint type="slide" axis="0 1 0"/><geom size="0.1" contype="0"/></body>
        </worldbody><equality>
          <joint name="gear" joint1="a"/><joint joint1="a"/>
        </equality></mujoco>""")
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    r = qless.mujoco.analyse(model, data)
    assert (r.rank, r.labels) == (1, ["gear", "equality 1"])
    assert str(r.because(1)) == 'row 1 "equality 1" = 1 * row 0 "gear"'
    assert qless.mujoco.dof_labels(model) == [*(f"free {k}" for k in range(6)), "a", "joint 2"]

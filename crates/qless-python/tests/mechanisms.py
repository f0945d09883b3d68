"""Bennett's linkage: four skew revolute joints in a loop that moves, although six equations on four DOFs should lock it.

frame k+1 = frame k * turn about z by t_k * shift along x by a_k * turn about x by w_k
a = (1, 2, 1, 2),  sin w_1 / a_1 = sin w_2 / a_2,  t_3 = -t_1, t_4 = -t_2
"""

import numpy as np

LENGTHS = (1.0, 2.0, 1.0, 2.0)
TWISTS = (0.4, np.pi - np.arcsin(2.0 * np.sin(0.4))) * 2


def turn(axis, angle):
    """Rotation matrix about a coordinate axis or a vector, by Rodrigues' formula."""
    x, y, z = axis / np.linalg.norm(axis)
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K


def links(angle, base):
    """(rotation, position) of the frames of the four joints, and of the frame after the last link, which is the first one again."""
    a, w = TWISTS[:2]
    other = 2 * np.arctan(np.sin((w + a) / 2) / np.sin((w - a) / 2) / np.tan(angle / 2))
    frames = [(base, np.array([0.1, -0.2, 0.3]))]
    for t, length, twist in zip((angle, other, -angle, -other), LENGTHS, TWISTS):
        R, p = frames[-1]
        R = R @ turn(np.eye(3)[2], t)
        frames.append((R @ turn(np.eye(3)[0], twist), p + R @ [length, 0, 0]))
    return frames


def bases():
    """Base orientations: 40 random ones, and some along the axes, where whole rows consist of rounding."""
    rng = np.random.default_rng(7)
    random = [turn(rng.normal(size=3), rng.uniform(0, np.pi)) for _ in range(40)]
    return [*random, np.eye(3), turn(np.eye(3)[0], np.pi / 2), turn(np.ones(3), 2 * np.pi / 3)]


def rank_by_svd(J, rows):
    """The rank of a dense matrix, with a gap of four digits that leaves no doubt; translations and rotations have the same size here."""
    sizes = np.linalg.svd(J[rows], compute_uv=False)
    rank = int((sizes > 1e-10 * np.linalg.norm(J, 2)).sum())
    assert rank == len(sizes) or sizes[rank] < 1e-4 * sizes[rank - 1]
    return rank


def velocities(frames, point):
    """Velocity of a point and angular velocity of the last link, 3 x 4 each, in world axes, for a unit rate of each joint."""
    axes = np.array([R[:, 2] for R, _ in frames[:4]])
    arms = np.array([point - p for _, p in frames[:4]])
    return np.cross(axes, arms).T, axes.T

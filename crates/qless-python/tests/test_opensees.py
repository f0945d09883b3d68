"""OpenSees: a frame of three storeys whose floors and equal DOFs overlap, against a dense oracle."""

import numpy as np
import optional
import pytest
import scipy.linalg

import qless

ops = optional.package("openseespy.opensees")
import qless.opensees

STOREYS, CORNERS, BEAMS = range(1, 4), ((0.0, 0.0), (6.0, 0.0), (6.0, 4.0), (0.0, 4.0)), ((1, 5), (5, 2), (2, 3), (3, 4), (4, 1))
LOADS = {19: [3.0, 1.0, 0.4], 29: [5.0, -2.0, 0.7], 39: [8.0, 1.5, -0.9]}


@pytest.fixture(autouse=True)
def _empty():
    yield ops.wipe()
    ops.wipe()


def frame():
    """Nodes 10 s + 1 to 4 are the corners of storey s, 5 the middle of a side, 9 the retained node of the floor."""
    ops.model("basic", "-ndm", 3, "-ndf", 6)
    for s in (0, *STOREYS):
        for k, (x, y) in enumerate(CORNERS):
            ops.node(10 * s + k + 1, x, y, 3.0 * s)
    for s in STOREYS:
        ops.node(10 * s + 5, 2.0, 0.0, 3.0 * s)
        ops.node(10 * s + 9, 2.5, 1.7, 3.0 * s)
    ops.geomTransf("Linear", 1, 1.0, 1.0, 0.0)
    ops.geomTransf("Linear", 2, 0.0, 0.0, 1.0)
    for s in STOREYS:
        columns = [(10 * (s - 1) + k + 1, 10 * s + k + 1, 1) for k in range(4)]
        beams = [(10 * s + a, 10 * s + b, 2) for a, b in BEAMS]
        for a, b, transformation in columns + beams:
            ops.element("elasticBeamColumn", 1000 * a + b, a, b, 0.09, 30e3, 12e3, 1e-3, 7e-4, 6e-4, transformation)


def loads():
    ops.timeSeries("Linear", 1)
    ops.pattern("Plain", 1, 1)
    for node, (fx, fy, moment) in LOADS.items():
        ops.load(node, fx, fy, 0.0, 0.0, 0.0, moment)


def constrain(h):
    for k in range(4):
        h.fix(k + 1, 1, 1, 1, 1, 1, 1)
    for s in STOREYS:
        h.equalDOF(10 * s + 1, 10 * s + 2, 1, 6)  # along x: both follow from the floor
        h.equalDOF(10 * s + 2, 10 * s + 3, 2, 6)  # along y
        h.equalDOF(10 * s + 9, 10 * s + 4, 6)
        h.equalDOF(10 * s + 9, 10 * s + 5, 6)  # new
        h.rigidDiaphragm(3, 10 * s + 9, *(10 * s + k + 1 for k in range(4)))
        h.fix(10 * s + 9, 0, 0, 1, 1, 1, 0)
    h.equalDOF(1, 2, 1, 2, 3)  # both are fixed


def solve(handler="Transformation"):
    ops.constraints(handler)
    ops.numberer("Plain")
    ops.system("FullGeneral")
    ops.integrator("LoadControl", 1.0)
    ops.algorithm("Linear")
    ops.analysis("Static", "-noWarnings")
    return ops.analyze(1)


def oracle():
    """u = N (N^T K N)^-1 N^T f, with N from a singular value decomposition, K and its numbering from OpenSees without constraints."""
    ops.wipe()
    frame()
    loads()
    ops.constraints("Plain")
    ops.numberer("Plain")
    ops.system("FullGeneral")
    ops.integrator("LoadControl", 1.0)
    ops.algorithm("Linear")
    ops.analysis("Static", "-noWarnings")
    ops.analyze(1)
    n = ops.systemSize()
    K = np.array(ops.printA("-ret")).reshape(n, n)
    at = {(node, k): ops.nodeDOFs(node)[k - 1] for node in ops.getNodeTags() for k in range(1, 7)}
    f, C = np.zeros(n), []
    for node, load in LOADS.items():
        f[[at[node, k] for k in (1, 2, 6)]] = load
    tie = lambda row: C.append(np.bincount([at[key] for key in row], list(row.values()), n))
    for k in range(4):
        [tie({(k + 1, dof): 1.0}) for dof in range(1, 7)]
    for s in STOREYS:
        floor, (x, y) = 10 * s + 9, (2.5, 1.7)
        [tie({(floor, dof): 1.0}) for dof in (3, 4, 5)]
        for k, (xk, yk) in enumerate(CORNERS):
            node = 10 * s + k + 1
            tie({(node, 1): 1.0, (floor, 1): -1.0, (floor, 6): yk - y})
            tie({(node, 2): 1.0, (floor, 2): -1.0, (floor, 6): x - xk})
            tie({(node, 6): 1.0, (floor, 6): -1.0})
        tie({(10 * s + 5, 6): 1.0, (floor, 6): -1.0})
    N = scipy.linalg.null_space(np.array(C))
    u = N @ np.linalg.solve(N.T @ K @ N, N.T @ f)
    return {node: u[[at[node, k] for k in range(1, 7)]] for node in ops.getNodeTags()}


def test_overlapping_floors_and_equal_dofs():
    frame()
    h = qless.opensees.Constraints(ops)
    constrain(h)
    loads()
    r = h.apply()
    assert solve() == 0
    found = {node: np.array(ops.nodeDisp(node)) for node in ops.getNodeTags()}

    # A storey has 12 rows of the floor and that of the middle node; the five others say nothing new. The ground has three that do not.
    assert (r.rank, r.redundant.size, r.conflicting.size, r.ambiguous) == (3 * 13, 3 * 5 + 3, 0, False)
    assert all(r.labels[row].startswith("equalDOF") for row in r.redundant)
    assert r.labels[r.redundant[0]] == "equalDOF 11 12 1 6, node 12 DOF 1"
    assert "node 11 DOF 1" in str(r.because(r.redundant[0]))
    # OpenSees has the independent set only.
    assert ops.getConstrainedDOFs(15, 19) == [6] and ops.getRetainedNodes() == [19, 29, 39]
    expected = oracle()
    largest = max(np.abs(u).max() for u in expected.values())
    assert largest > 1e-3
    assert max(np.abs(found[node] - u).max() for node, u in expected.items()) <= 1e-10 * largest


def test_commands_are_those_of_opensees():
    """The rows of each command alone, against the motion that OpenSees computes."""
    for command, arguments, free_ends in (
        ("rigidDiaphragm", (3, 39, 33), (0, 0, 1, 1, 1)),
        ("rigidLink", ("beam", 39, 12), ()),
        ("rigidLink", ("bar", 39, 12), (0, 0, 0, 1, 1, 1)),
    ):
        ops.wipe()
        frame()
        h = qless.opensees.Constraints(ops)
        for k in range(4):
            h.fix(k + 1, 1, 1, 1, 1, 1, 1)
        for node in (19, 29):
            h.fix(node, 1, 1, 1, 1, 1, 1)
        # What the command does not tie to the frame.
        h.fix(39, *free_ends)
        getattr(h, command)(*arguments)
        ops.timeSeries("Linear", 1)
        ops.pattern("Plain", 1, 1)
        ops.load(39, 1.0, -2.0, 0.5, 0.3, -0.2, 0.7)
        r = h.apply()
        assert solve() == 0 and not r.redundant.size
        places = [(node, k) for node in h._places for k in range(6)]
        u = np.array([ops.nodeDisp(node)[k] for node, k in places])
        assert np.abs(r.expand(u[r.masters]) - u).max() <= 1e-11 * np.abs(u).max()


def test_two_floors_over_the_same_nodes():
    """The second retained node follows from one shared node; the other shared nodes are left out as a whole."""
    frame()
    ops.node(38, 4.0, 3.0, 9.0)
    h = qless.opensees.Constraints(ops)
    h.rigidDiaphragm(3, 39, 31, 32, 33, 34)
    h.rigidDiaphragm(3, 38, 31, 32, 33, 34)
    r = h.apply("Lagrange")
    assert (r.rank, r.redundant.size) == (15, 9)
    pairs = [(c, k) for c in ops.getConstrainedNodes() for k in ops.getRetainedNodes(c)]
    assert len(pairs) == 5


def test_a_part_of_a_rigid_link_that_has_no_command():
    """Both ends of the link have one rotation fixed, so that one of its rows says nothing, and the others cannot be issued singly."""
    frame()
    h = qless.opensees.Constraints(ops)
    h.fix(11, 0, 0, 0, 1)
    h.fix(12, 0, 0, 0, 1)
    h.rigidLink("beam", 11, 12)
    with pytest.raises(qless.InputError, match=r'row 1 "rigidLink beam 11 12, node 12 DOF 2" is independent, but.*leave node 12') as raised:
        h.apply("Lagrange")
    assert raised.value.row == 1 and ops.getConstrainedNodes() == []


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (lambda h: (h.equalDOF(11, 12, 1), h.equalDOF(13, 12, 2)), r"node 12 is constrained by both equalDOF\(11, 12, 1\) and"),
        (lambda h: (h.equalDOF(11, 12, 1), h.equalDOF(12, 13, 1)), r"node 12 is retained by equalDOF\(12, 13, 1\) and constrained by"),
        (lambda h: (h.fix(12, 1, 0), h.equalDOF(11, 12, 1)), "node 12 DOF 1 is fixed and constrained by equalDOF"),
    ],
)
def test_what_the_transformation_handler_solves_wrongly_is_refused(build, message):
    frame()
    h = qless.opensees.Constraints(ops)
    build(h)
    with pytest.raises(qless.InputError, match=message):
        h.apply()
    assert ops.getConstrainedNodes() == []
    h.apply("Lagrange")
    assert ops.getConstrainedNodes()


def test_equal_dofs_of_one_pair_are_one_command():
    frame()
    h = qless.opensees.Constraints(ops)
    h.equalDOF(11, 12, 1, 2)
    h.equalDOF(11, 12, 2, 3)
    assert h.apply().redundant.size == 1
    assert ops.getConstrainedDOFs(12, 11) == [1, 2, 3]


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda h: h.equalDOF(11, 12, 7), "equalDOF 11 12: DOF 7; DOFs are 1 to 6"),
        (lambda h: h.equalDOF(11, 99, 1), "node 99 is not in the model"),
        (lambda h: h.equalDOF(11, 11, 1), "node 11 cannot be tied to itself"),
        (lambda h: h.rigidLink("rope", 11, 12), 'give "bar" or "beam"'),
        (lambda h: h.rigidDiaphragm(3, 19, 11, 21), "node 21 is not in the plane of node 19"),
        (lambda h: h.rigidDiaphragm(4, 19, 11), "a direction from 1 to 3"),
        (lambda h: h.fix(11, *[1] * 7), "7 flags"),
    ],
)
def test_bad_input_is_named(call, message):
    frame()
    with pytest.raises(qless.InputError, match=message):
        call(qless.opensees.Constraints(ops))

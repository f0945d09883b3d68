"""scikit-fem: a periodic cell with a rigid inclusion, over-constrained, against a dense oracle."""

import numpy as np
import skfem
from skfem.models.elasticity import lame_parameters, linear_elasticity

import qless
import qless.skfem


def cell():
    """Quads on the unit square, K and f of plane strain, DOFs by node."""
    mesh = skfem.MeshQuad.init_tensor(*2 * [np.linspace(0, 1, 9)])
    basis = skfem.Basis(mesh, skfem.ElementVector(skfem.ElementQuad1()))
    K = linear_elasticity(*lame_parameters(1.0, 0.3)).assemble(basis).tocsr()
    return mesh, K, np.random.default_rng(0).normal(size=K.shape[0]), basis.nodal_dofs.T


def sides(mesh, axis):
    """Nodes of opposite sides, in the same order."""
    low, high = (np.flatnonzero(mesh.p[axis] == x) for x in (0, 1))
    order = lambda nodes: nodes[np.argsort(mesh.p[1 - axis][nodes])]
    return order(high), order(low)


def test_periodic_cell_with_a_rigid_inclusion():
    mesh, K, f, dofs = cell()
    E = np.array([[0.01, 0.004], [0.0, -0.02]])
    inclusion = np.flatnonzero(np.linalg.norm(mesh.p - 0.5, axis=0) < 0.3)

    c = qless.Constraints(K.shape[0])
    for axis in (0, 1):
        high, low = sides(mesh, axis)
        c.periodic(dofs[high], dofs[low], np.eye(2)[axis], E, label=f"side {axis}")
    c.rigid(dofs[inclusion], mesh.p.T[inclusion], label="inclusion")
    c.prescribe(dofs[0], 0.0)
    r = c.analyse()
    u = skfem.solve(*qless.skfem.condense(r, K, f))

    # Corners are tied around: two of their equations say nothing new, one for each direction.
    assert r.redundant.size == 2 and not r.conflicting.size and not r.ambiguous
    assert r.rank == np.linalg.matrix_rank(np.delete(c.C.toarray(), dofs[0], axis=1))
    C = np.vstack([c.C.toarray(), np.eye(K.shape[0])[dofs[0]]])
    b = np.r_[c.b, np.zeros(2)]
    A = np.block([[K.toarray(), C.T], [C, np.zeros((len(C),) * 2)]])
    oracle = np.linalg.lstsq(A, np.r_[f, b], rcond=1e-12)[0][: K.shape[0]]
    assert np.abs(u - oracle).max() <= 1e-10 * np.abs(oracle).max()

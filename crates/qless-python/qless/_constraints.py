"""Builds ``C u = b`` from ties, rigid bodies, periodicity and matrices."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from . import _qless, _result
from ._errors import InputError
from ._matrix import csr, csr_arrays, doubles, floats, integers, is_sparse, names, natural
from ._rigid import rigid_rows


class Constraints:
    """Equations on DOFs ``0..dofs``. Methods that add equations return the rows that they added."""

    def __init__(self, dofs: int) -> None:
        self.dofs = natural(dofs, "number of DOFs", 2**32)
        self._lengths: list[np.ndarray] = []
        self._columns: list[np.ndarray] = []
        self._values: list[np.ndarray] = []
        self._rhs: list[np.ndarray] = []
        self._labels: list[tuple[int, str | list[str] | None]] = []
        self._prescribed: dict[int, float] = {}
        self._dof_labels: list[str] | None = None
        #: Warnings of the file that was read.
        self.warnings: list[str] = []
        #: Constraints of the file that were left out, so that results may not hold for all of it.
        self.left_out: list[str] = []

    def __len__(self) -> int:
        return sum(len(rhs) for rhs in self._rhs)

    def __repr__(self) -> str:
        return f"Constraints({len(self)} equations on {self.dofs} DOFs, {len(self._prescribed)} prescribed)"

    def add(self, C: Any, b: Any = 0.0, label: str | list[str] | None = None) -> range:  # noqa: N803
        """Adds the rows of a matrix, dense or of scipy.sparse, with the right-hand side b."""
        if is_sparse(C):
            starts, columns, values = csr_arrays(C)
            return self._append(np.diff(starts), columns, values, b, label, C.shape[1])
        C = np.atleast_2d(floats(C))  # noqa: N806
        rows, columns = np.nonzero(C)
        return self._append(np.bincount(rows, minlength=len(C)), columns, C[rows, columns], b, label, C.shape[1])

    def equation(self, dofs: Any, coefficients: Any, b: float = 0.0, label: str | None = None) -> range:
        """One equation ``sum coefficients_k u[dofs_k] = b``."""
        dofs = np.atleast_1d(integers(dofs))
        return self._append(np.array([len(dofs)]), dofs, doubles(coefficients, dofs.shape), b, label)

    def equal(self, a: Any, b: Any, offset: Any = 0.0, label: str | list[str] | None = None) -> range:
        """``u[a] - u[b] = offset`` for each pair of DOFs; a single DOF is paired with all of the other list."""
        a, b = np.ravel(integers(a)), np.ravel(integers(b))
        if len(a) != len(b) and 1 not in (len(a), len(b)):
            raise InputError(f"equal: there are {len(a)} DOFs and {len(b)} DOFs; give a pair for each equation")
        a, b = np.broadcast_arrays(a, b)
        return self._append_pairs([(a, 1.0), (b, -1.0)], offset, label)

    def mpc(self, slave: Any, masters: Any, coefficients: Any, offset: Any = 0.0, label: str | list[str] | None = None) -> range:
        """``u[slave] = sum_k coefficients_k u[masters_k] + offset``; an array of slaves takes one row of masters for each slave.

        `coefficients` has a number for each master, or is one number for all; one row of coefficients may serve all slaves.
        """
        slave, masters = np.ravel(integers(slave)), integers(masters)
        each, left = divmod(masters.size, len(slave)) if len(slave) else (0, masters.size)
        if left or (masters.ndim > 1 and len(masters) != len(slave)):
            raise InputError(f"mpc: masters are of shape {masters.shape} for {len(slave)} slaves; give a row of masters for each slave")
        masters = masters.reshape(len(slave), each)
        coefficients = doubles(coefficients, masters.shape)
        columns = [(slave, 1.0), *((masters[:, k], -coefficients[:, k]) for k in range(masters.shape[1]))]
        return self._append_pairs(columns, offset, label)

    def periodic(
        self,
        a: Any,
        b: Any,
        distance: Any = None,
        strain: Any = None,
        label: str | list[str] | None = None,
        *,
        strain_dofs: Any = None,
    ) -> range:
        """``u_a - u_b = E (x_a - x_b)``: opposite nodes of a periodic cell.

        a and b are DOFs, (nodes, d); `distance` is ``x_a - x_b``, d numbers or (nodes, d). The strain E is d x d: its values are `strain`,
        or its entries are the DOFs `strain_dofs`. Without a strain, both nodes have equal displacements.
        """
        a, b = np.atleast_2d(integers(a)), np.atleast_2d(integers(b))
        if a.shape != b.shape:
            raise InputError(f"periodic: a is {a.shape}, b is {b.shape}; give the DOFs of both as (nodes, d)")
        columns = [(a.ravel(), 1.0), (b.ravel(), -1.0)]
        if strain is None and strain_dofs is None:
            return self._append_pairs(columns, 0.0, label)
        if strain is not None and strain_dofs is not None:
            raise InputError("periodic: give the values of the strain, or its DOFs as strain_dofs, not both")
        distance = doubles(distance, a.shape)
        strain = integers(strain_dofs) if strain is None else doubles(strain)
        if strain.shape != (a.shape[1], a.shape[1]):
            raise InputError(f"periodic: the strain is {strain.shape}; for {a.shape[1]} DOFs a node it is {a.shape[1]} x {a.shape[1]}")
        if strain_dofs is not None:
            of_strain = [(np.tile(strain[:, k], len(a)), -np.repeat(distance[:, k], a.shape[1])) for k in range(a.shape[1])]
            return self._append_pairs([*columns, *of_strain], 0.0, label)
        return self._append_pairs(columns, (distance @ strain.T).ravel(), label)

    def rigid(self, dofs: Any, points: Any, reference: Any = None, centre: Any = None, label: str | None = None) -> range:
        """Nodes that move as one rigid body, for small rotations.

        `dofs` and `points` are (nodes, d) or (d, nodes), d = 2 or 3. With a `reference` at `centre` (by default the mean of the points),
        ``u_i = u_ref + w x (x_i - centre)``; its DOFs are d translations, then one rotation in 2D and three in 3D. Without a reference, the
        equations allow only rigid motions, which three nodes in 3D or two in 2D determine.
        """
        lengths, columns, values = rigid_rows(integers(dofs), doubles(points), reference, centre)
        return self._append(lengths, columns, values, 0.0, label)

    def prescribe(self, dofs: Any, values: Any = 0.0) -> None:
        """Prescribed values: a mapping of DOF to value, or arrays of DOFs and values."""
        given = _result.pairs(dofs if isinstance(dofs, Mapping) else (dofs, values))
        assert given is not None
        for dof, value in zip(given[0].tolist(), given[1].tolist(), strict=True):
            if not 0 <= dof < self.dofs:
                raise InputError(f"prescribed DOF {dof}: there are {self.dofs} DOFs, from 0", dof=dof)
            if self._prescribed.setdefault(dof, value) != value:
                raise InputError(f"DOF {dof} is prescribed twice, as {self._prescribed[dof]} and as {value}", dof=dof)

    def label_dofs(self, labels: Any) -> None:
        """Names of all DOFs, for messages."""
        self._dof_labels = names(labels)

    def _append_pairs(self, columns: list[tuple[np.ndarray, Any]], b: Any, label: Any) -> range:
        """Adds rows; each column gives one DOF and one coefficient of every row."""
        rows = len(columns[0][0])
        dofs = np.stack([dofs for dofs, _ in columns], axis=1)
        values = np.stack([doubles(value, (rows,)) for _, value in columns], axis=1)
        return self._append(np.full(rows, len(columns)), dofs.ravel(), values.ravel(), b, label)

    def _append(self, lengths: Any, columns: Any, values: Any, b: Any, label: Any, dofs: int | None = None) -> range:
        if dofs is not None and dofs != self.dofs:
            raise InputError(f"the matrix has {dofs} columns; there are {self.dofs} DOFs")
        outside = np.flatnonzero((columns < 0) | (columns >= self.dofs))
        first, rows = len(self), len(lengths)
        if outside.size:
            row = first + int(np.searchsorted(np.cumsum(lengths), outside[0], side="right"))
            named = f" ({label})" if isinstance(label, str) else ""
            dof = int(columns[outside[0]])
            raise InputError(f"row {row}{named} names DOF {dof}; there are {self.dofs} DOFs, from 0", row=row, dof=dof)
        if not (label is None or isinstance(label, str) or len(label) == rows):
            raise InputError(f"there are {len(label)} labels for {rows} equations")
        b = doubles(b)
        self._rhs.append(doubles(b, (rows,)) if b.ndim == 0 else np.ravel(b))
        if len(self._rhs[-1]) != rows:
            found = len(self._rhs.pop())
            raise InputError(f"the right-hand side has {found} numbers for {rows} equations")
        self._lengths.append(np.asarray(lengths, dtype=np.int64))
        self._columns.append(np.array(columns))
        self._values.append(np.array(values))
        self._labels.append((rows, label))
        return range(first, first + rows)

    # The collected equations.

    def _arrays(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        if not self._lengths:
            return np.zeros(1, dtype=np.int64), np.zeros(0, dtype=np.int64), np.zeros(0)
        starts = np.concatenate([[0], np.cumsum(np.concatenate(self._lengths))])
        return starts, np.concatenate(self._columns), doubles(np.concatenate(self._values))

    @property
    def C(self) -> Any:  # noqa: N802
        """C in compressed rows of scipy.sparse."""
        return csr(self._arrays(), (len(self), self.dofs))

    @property
    def b(self) -> np.ndarray:
        """b."""
        return np.concatenate(self._rhs) if self._rhs else np.zeros(0)

    @property
    def prescribed(self) -> dict[int, float]:
        """Prescribed values by DOF."""
        return dict(self._prescribed)

    @property
    def labels(self) -> list[str] | None:
        """A label for each equation, or None if none has one; equations of one label are numbered."""
        if all(label is None for _, label in self._labels):
            return None
        labels: list[str] = []
        for rows, label in self._labels:
            if label is None:
                labels.extend(f"equation {k}" for k in range(len(labels), len(labels) + rows))
            elif isinstance(label, str):
                labels.extend([label] if rows == 1 else [f"{label} [{k}]" for k in range(rows)])
            else:
                labels.extend(map(str, label))
        return labels

    def analyse(self, **options: Any) -> _result.Result:
        """Diagnoses the equations; options are those of :func:`qless.analyse`."""
        result = _result.make((self._arrays(), self.dofs), self.b, self._prescribed, self.labels, self._dof_labels, **options)
        result.left_out = list(self.left_out)
        return result

    @classmethod
    def _of(cls, system: _qless.System) -> Constraints:
        constraints = cls(system.shape[1])
        starts, columns, values = system.matrix()
        constraints._append(np.diff(starts), columns, values, system.rhs(), system.labels() or None)
        dofs, prescribed = system.prescribed()
        constraints._prescribed = dict(zip(dofs.tolist(), prescribed.tolist(), strict=True))
        constraints._dof_labels = system.dof_labels() or None
        return constraints

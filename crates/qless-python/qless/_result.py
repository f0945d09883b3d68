"""The result of an analysis: diagnosis, reduced form and its uses.

expand       u   = L u_q + u_0        masters -> all DOFs
restrict     f_q = L^T f              forces on all DOFs -> on masters
condense     K_q = L^T K L,  f_q = L^T (f - K u_0)
multipliers  C^T lambda = f - K u     forces of the equations
"""

from __future__ import annotations

import enum
import pickle
from collections import Counter
from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from . import _qless, _reasons, _report
from ._errors import Conflict, InputError
from ._matrix import compressed_rows, csr, doubles, floats, integers, is_sparse, names, natural, right_hand_sides, system
from ._reasons import Reason, Repair


class Kind(enum.IntEnum):
    """The verdict on an equation."""

    INDEPENDENT = 0
    REDUNDANT = 1
    CONFLICTING = 2


class Digits(NamedTuple):
    """The confidence in the rank, in digits."""

    #: -log10 of the smallest relative change of coefficients that makes the kept equations dependent.
    kept: float
    #: Number of digits in which dropped equations agree with their combinations of kept ones; infinite if all do.
    dropped: float


class Explanation(NamedTuple):
    """``row = sum c_i row_i`` over the free DOFs."""

    row: int
    #: (row, coefficient), ascending by row.
    terms: list[tuple[int, float]]
    kind: Kind
    #: ``b_k - sum c_i b_i``, prescribed DOFs moved into b.
    mismatch: float
    #: Relative error of the combination; 0 if it is at most the tolerance.
    error: float
    #: Labels of the rows, if they have any.
    labels: dict[int, str]
    #: Number of coefficients of these rows that count as zero (:attr:`Result.noise`): the combination holds without them.
    zeros: int = 0

    def __str__(self) -> str:
        return _report.explanation(self)


class Result:
    """The diagnosis of ``C u = b`` and its reduced form ``u_s = T u_q + G u_p + g``; rows and DOFs count from 0.

    The diagnosis is computed at once, the reduced form when one of its attributes is first read. A system with conflicts has no reduced
    form, so that reading it raises :class:`Conflict`.
    """

    def __init__(self, inputs: _qless.System, options: dict[str, Any], left_out: Sequence[str] = ()) -> None:
        #: Constraints of a file that were left out: the verdict covers only those that were read.
        self.left_out: list[str] = list(left_out)
        self._system = inputs
        self._options = options
        self._analysis = _qless.analyse(inputs, **options)
        self._made: _qless.Elimination | None = None

    # The diagnosis.

    @property
    def shape(self) -> tuple[int, int]:
        """Number of equations and of DOFs."""
        return self._system.shape

    @property
    def rank(self) -> int:
        """Rank of C, restricted to the columns of free DOFs."""
        return self._analysis.rank

    @property
    def kinds(self) -> np.ndarray:
        """A :class:`Kind` for each equation, for the current b and prescribed values."""
        return self._current.kinds()

    @property
    def _current(self) -> _qless.Analysis | _qless.Elimination:
        """What holds the verdicts for the current b and prescribed values."""
        return self._analysis if self._made is None else self._made

    def _rows(self, kind: Kind) -> np.ndarray:
        return np.flatnonzero(self.kinds == kind)

    @property
    def independent(self) -> np.ndarray:
        """Rows of the kept equations; ``C[independent]`` has full rank."""
        return self._rows(Kind.INDEPENDENT)

    @property
    def redundant(self) -> np.ndarray:
        """Rows that are combinations of kept equations and agree with them."""
        return self._rows(Kind.REDUNDANT)

    @property
    def conflicting(self) -> np.ndarray:
        """Rows that are combinations of kept equations but contradict their right-hand sides."""
        return self._rows(Kind.CONFLICTING)

    @property
    def status(self) -> str:
        """``"conflicting"``, else ``"incomplete"`` if constraints were left out, else ``"redundant"`` or ``"independent"``."""
        worst = Kind(int(self.kinds.max(initial=0)))
        return "incomplete" if self.left_out and worst != Kind.CONFLICTING else worst.name.lower()

    @cached_property
    def fixed(self) -> dict[int, float]:
        """Free DOFs that the equations fix, with the values for the current b and prescribed values."""
        dofs, values = self._current.fixed()
        return dict(zip(dofs.tolist(), values.tolist(), strict=True))

    @cached_property
    def labels(self) -> list[str]:
        """Labels of the equations; empty without labels."""
        return self._system.labels()

    @cached_property
    def _dof_labels(self) -> list[str]:
        return self._system.dof_labels()

    @cached_property
    def _mismatches(self) -> dict[int, float]:
        rows, mismatches = self._analysis.mismatches()
        return dict(zip(rows.tolist(), mismatches.tolist(), strict=True))

    @cached_property
    def _zeros_by_row(self) -> Counter[int | None]:
        return Counter(row for row, _, _ in self.noise)

    def _zeros(self, row: int | None, rows: np.ndarray) -> int:
        """Number of coefficients of these rows that count as zero."""
        return sum(self._zeros_by_row[i] for i in [row, *rows.tolist()])

    def because(self, row: int) -> Explanation:
        """The kept equations of which a dependent one is a combination; no terms for an independent one."""
        row = natural(row, "row", self.shape[0])
        ((rows, coefficients), error) = self._analysis.because(row)
        terms = list(zip(rows.tolist(), coefficients.tolist(), strict=True))
        named = {i: self.labels[i] for i in [row, *rows.tolist()]} if self.labels else {}
        kind = Kind(int(self._analysis.kinds()[row]))
        return Explanation(row, terms, kind, self._mismatches.get(row, 0.0), error, named, self._zeros(row, rows))

    def because_fixed(self, dof: int) -> list[tuple[int, float]]:
        """The combination ``e_dof = sum c_i row_i`` that fixes a DOF; empty for other DOFs."""
        rows, coefficients = self._analysis.because_fixed(natural(dof, "DOF", self.shape[1]))
        return list(zip(rows.tolist(), coefficients.tolist(), strict=True))

    def explain(self, row: int) -> Reason | None:
        """Why an equation is dependent, in few equations *and prescribed values*; None for an independent one.

        :meth:`because` names kept equations only, and may be long. All numbers are those of the analysis, before any :meth:`refresh`.
        """
        row = natural(row, "row", self.shape[0])
        found = self._analysis.explain(row)
        if found is None:
            return None
        members, right_hand_side, error, irreducible = _reasons.reason(found, self.labels, self._dof_labels)
        conflicts = bool(self._analysis.kinds()[row] == Kind.CONFLICTING)
        subject = _reasons.named("row", row, _reasons.label(self.labels, row))
        zeros = self._zeros(row, found[0][0])
        return Reason(members, right_hand_side, float(self._system.rhs()[row]), conflicts, error, irreducible, subject, zeros)

    def explain_fixed(self, dof: int) -> Reason | None:
        """Why a DOF of :attr:`fixed` has its value, in few equations and prescribed values; None for any other DOF."""
        dof = natural(dof, "DOF", self.shape[1])
        found = self._analysis.explain_fixed(dof)
        if found is None:
            return None
        members, right_hand_side, error, irreducible = _reasons.reason(found, self.labels, self._dof_labels)
        subject = _reasons.named("DOF", dof, _reasons.label(self._dof_labels, dof))
        return Reason(members, right_hand_side, None, False, error, irreducible, subject, self._zeros(None, found[0][0]))

    def repairs(self) -> list[Repair]:
        """The fewest right-hand sides and prescribed values to change so that no conflict is left, with their new values.

        Conflicts without a common number have a repair each. Redundant equations stay redundant.
        """
        return [_reasons.repair(found, self.labels, self._dof_labels) for found in self._analysis.repairs()]

    @property
    def digits(self) -> Digits:
        """The confidence in the rank, in digits."""
        kept, dropped, _, _ = self._current.confidence()
        return Digits(kept, dropped)

    @property
    def ambiguous(self) -> bool:
        """Whether a small change of the coefficients, or another reading of rounding, gives another verdict."""
        return self._current.confidence()[2]

    @property
    def doubt(self) -> str | None:
        """The reason of an ambiguous verdict."""
        return self._current.confidence()[3]

    @property
    def other_reading(self) -> dict[str, Any] | None:
        """Rank and number of conflicts if numbers that may be rounding are read the other way."""
        found = self._analysis.other_reading()
        return None if found is None else dict(zip(("as_zero", "rank", "conflicting", "terms"), found, strict=True))

    @property
    def noise(self) -> list[tuple[int, int, float]]:
        """(row, DOF, coefficient) of coefficients that count as zero."""
        return self._analysis.noise()

    def report(self) -> str:
        """The diagnosis as text."""
        return _report.text(self)

    def to_json(self, terms: int = 1_000_000) -> str:
        """The report of ``qless check --format json``; its rows and DOFs count from 1."""
        return self._analysis.json(natural(terms, "number of terms", 2**63))

    def raise_if_conflicting(self) -> Result:
        """Raises :class:`Conflict` if equations conflict; returns the result itself."""
        if self.conflicting.size:
            raise self._conflict()
        return self

    def _conflict(self) -> Conflict:
        rows = np.flatnonzero(self._analysis.kinds() == Kind.CONFLICTING).tolist()
        explanations = [self.because(row) for row in rows]
        return Conflict(_report.conflicts(self, rows), rows, explanations)

    def __repr__(self) -> str:
        return self.report()

    def _repr_html_(self) -> str:
        return _report.html(self)

    # The reduced form.

    @property
    def _elimination(self) -> _qless.Elimination:
        if self._made is None:
            self.raise_if_conflicting()
            self._made = self._analysis.eliminate()
        return self._made

    @property
    def slaves(self) -> np.ndarray:
        """u_s, ascending."""
        return self._elimination.slaves()

    @property
    def masters(self) -> np.ndarray:
        """u_q: all other free DOFs, ascending."""
        return self._elimination.masters()

    @property
    def prescribed(self) -> np.ndarray:
        """u_p, ascending."""
        return self._elimination.prescribed()

    @property
    def T(self) -> Any:  # noqa: N802
        """T, slaves x masters, in compressed rows."""
        return csr(self._elimination.t(), (len(self.slaves), len(self.masters)))

    @property
    def G(self) -> Any:  # noqa: N802
        """G, slaves x prescribed DOFs, in compressed rows."""
        return csr(self._elimination.g_matrix(), (len(self.slaves), len(self.prescribed)))

    @property
    def g(self) -> np.ndarray:
        """g, one number per slave."""
        return self._elimination.g()

    @property
    def u0(self) -> np.ndarray:
        """u_0 of ``u = L u_q + u_0``, all DOFs."""
        return self.expand(np.zeros(len(self.masters)))

    @property
    def L(self) -> Any:  # noqa: N802
        """L of ``u = L u_q + u_0``, DOFs x masters, in compressed rows."""
        t_starts, t_columns, t_values = self._elimination.t()
        slaves, masters, dofs = self.slaves, self.masters, self.shape[1]
        counts = np.zeros(dofs + 1, dtype=np.int64)
        counts[slaves + 1] = np.diff(t_starts)
        counts[masters + 1] = 1
        starts = np.cumsum(counts)
        columns, values = np.empty(starts[-1], dtype=t_columns.dtype), np.empty(starts[-1])
        columns[starts[masters]], values[starts[masters]] = np.arange(len(masters)), 1.0
        places = np.repeat(starts[slaves] - t_starts[:-1], np.diff(t_starts)) + np.arange(len(t_values))
        columns[places], values[places] = t_columns, t_values
        return csr((starts.astype(t_starts.dtype), columns, values), (dofs, len(masters)))

    def nullspace(self) -> Any:
        """N, DOFs x (free DOFs - rank), with ``C N = 0`` and zero rows for prescribed DOFs: a basis of all admissible motions."""
        if self._made is None and self.conflicting.size:
            return self.with_values(b=np.zeros(self.shape[0])).nullspace()
        return self.L

    @property
    def growth(self) -> float:
        """``max |T_ij|``."""
        return self._elimination.growth

    # Its uses.

    def expand(self, masters: Any) -> np.ndarray:
        """``u = L u_q + u_0``; for a matrix, each column."""
        return _each_column(self._elimination.expand, masters)

    def expand_increment(self, masters: Any) -> np.ndarray:
        """``du = L du_q``; for a matrix, each column."""
        return _each_column(self._elimination.expand_increment, masters)

    def restrict(self, forces: Any) -> np.ndarray:
        """``f_q = L^T f``; for a matrix, each column."""
        return _each_column(self._elimination.restrict, forces)

    def condense(self, K: Any, f: Any = None) -> tuple[Any, np.ndarray]:  # noqa: N803
        """``(L^T K L, L^T (f - K u_0))`` for a matrix of scipy.sparse; dense K gives dense K_q. Without f, it is zero.

        K_q has compressed columns if K has, else compressed rows. The pattern of K is analysed again only if it changes.
        """
        n = self.shape[1]
        if tuple(K.shape) != (n, n):
            raise InputError(f"K is {K.shape[0]} x {K.shape[-1]}; the equations have {n} DOFs")
        f = np.zeros(n) if f is None else doubles(f)
        if not is_sparse(K):
            load = self.restrict(f - floats(K) @ self.u0)
            return self.restrict(np.ascontiguousarray(self.restrict(floats(K)).T)).T, load
        by_columns = K.format == "csc"
        lines = K if by_columns else compressed_rows(K)
        arrays = integers(lines.indptr), integers(lines.indices), doubles(lines.data)
        k_q, f_q = self._elimination.condense(arrays, by_columns, f)
        return csr(k_q, (len(f_q), len(f_q)), "csc" if by_columns else "csr"), f_q

    def multipliers(self, residual: Any) -> np.ndarray:
        """lambda of ``K u + C^T lambda = f`` by equation from ``residual = f - K u``; zero for dependent equations."""
        return self._elimination.multipliers(doubles(residual))

    def reactions(self, residual: Any) -> np.ndarray:
        """``C^T lambda - (f - K u)`` at the prescribed DOFs, in the order of :attr:`prescribed`."""
        residual = doubles(residual)
        return self._elimination.reactions(residual, self.multipliers(residual))

    def operator(self) -> Any:
        """L as a ``scipy.sparse.linalg.LinearOperator``: DOFs x masters, with its transpose."""
        from scipy.sparse.linalg import LinearOperator

        # scipy may pass a vector as one column.
        return LinearOperator(
            (self.shape[1], len(self.masters)),
            dtype=np.float64,
            matvec=lambda x: self.expand_increment(np.ravel(x)),
            rmatvec=lambda x: self.restrict(np.ravel(x)),
            matmat=self.expand_increment,
            rmatmat=self.restrict,
        )

    def refresh(self, b: Any = None, prescribed: Any = None) -> Result:
        """Sets new right-hand sides and prescribed values (a mapping, or numbers in the order of :attr:`prescribed`), in place.

        Slaves and T stay, and g is computed again. Raises :class:`Conflict` if equations conflict now; nothing has changed then.
        """
        elimination = self._elimination
        rhs = elimination.rhs() if b is None else right_hand_sides(b)
        try:
            elimination.update(rhs, _changed(self.prescribed, elimination.prescribed_values(), prescribed))
        except Conflict as error:
            changed = self.with_values(rhs, prescribed)
            raise (changed._conflict() if changed.conflicting.size else error) from None
        self.__dict__.pop("fixed", None)
        return self

    def with_values(self, b: Any = None, prescribed: Any = None) -> Result:
        """Analyses the same equations with another b and other prescribed values."""
        sides = self._sides()
        dofs, values = sides["prescribed"]
        if b is not None:
            sides["rhs"] = right_hand_sides(b)
        sides["prescribed"] = dofs, _changed(dofs, values, prescribed)
        return Result(system((self._system.matrix(), self.shape[1]), sides), self._options, self.left_out)

    # Files.

    def _sides(self) -> dict[str, Any]:
        inputs, made = self._system, self._made
        dofs, values = inputs.prescribed()
        return {
            "rhs": inputs.rhs() if made is None else made.rhs(),
            "prescribed": (dofs, values if made is None else made.prescribed_values()),
            "labels": inputs.labels() or None,
            "dof_labels": inputs.dof_labels() or None,
        }

    def __reduce__(self) -> tuple[Any, ...]:
        return _restored, (self._system.matrix(), self.shape[1], self._sides(), self._options, self.left_out)

    def save(self, path: Any) -> None:
        """Writes the equations and options by pickle; :func:`load` analyses them again, with the same bits."""
        with open(path, "wb") as file:
            pickle.dump(self, file)


def load(path: Any) -> Result:
    """Reads what :meth:`Result.save` wrote. Like every pickle, read only files that you trust."""
    with open(path, "rb") as file:
        found = pickle.load(file)
    if not isinstance(found, Result):
        raise InputError(f"{path}: it holds no result of qless")
    return found


def _restored(arrays: Any, dofs: int, sides: dict[str, Any], options: dict[str, Any], left_out: list[str]) -> Result:
    """The saved result. Verdicts are not stored but computed again, so that no unchecked verdict is read."""
    return Result(system((arrays, dofs), sides), options, left_out)


def _each_column(apply: Any, vectors: Any) -> np.ndarray:
    vectors = doubles(vectors)
    if vectors.ndim == 1:
        return apply(vectors)
    if vectors.ndim != 2:
        raise InputError(f"the array has {vectors.ndim} dimensions; give a vector, or vectors as columns")
    columns = [apply(column) for column in vectors.T]
    return np.stack(columns, axis=1) if columns else apply(np.zeros(vectors.shape[0]))[:, None][:, :0]


def make(
    C: Any,  # noqa: N803
    b: Any = None,
    prescribed: Any = None,
    labels: Sequence[str] | None = None,
    dof_labels: Sequence[str] | None = None,
    **options: Any,
) -> Result:
    """The result for a matrix and its other data, which :func:`qless.analyse` describes."""
    if type(C).__module__ == "qless._qless":
        return Result(C, options)
    sides = {
        "rhs": None if b is None else right_hand_sides(b),
        "prescribed": pairs(prescribed),
        "labels": names(labels),
        "dof_labels": names(dof_labels),
    }
    return Result(system(C, sides), options)


def pairs(prescribed: Any) -> tuple[np.ndarray, np.ndarray] | None:
    """Prescribed DOFs and values as two arrays, from a mapping or such a pair; a single value is that of all DOFs."""
    if prescribed is None:
        return None
    is_mapping = isinstance(prescribed, Mapping)
    given, values = (list(prescribed.keys()), list(prescribed.values())) if is_mapping else two_lists(prescribed)
    dofs, values = np.ravel(integers(given)).astype(np.int64), doubles(values)
    return dofs, doubles(values, dofs.shape) if values.ndim == 0 else np.ravel(values)


def _changed(dofs: np.ndarray, values: np.ndarray, prescribed: Any) -> np.ndarray:
    """The values of the prescribed DOFs after a change: a mapping of some of them, or a number for each."""
    if prescribed is None:
        return values
    if not isinstance(prescribed, Mapping):
        return doubles(prescribed, dofs.shape)
    changed = dict(zip(dofs.tolist(), values.tolist(), strict=True))
    given = pairs(prescribed)
    assert given is not None
    for dof, value in zip(given[0].tolist(), given[1].tolist(), strict=True):
        if dof not in changed:
            raise InputError(f"DOF {dof} is not prescribed; analyse again to prescribe it", dof=dof)
        changed[dof] = value
    return np.array(list(changed.values()))


def two_lists(prescribed: Any) -> tuple[Any, Any]:
    """Prescribed DOFs and values from a pair. A list of two numbers is none: it may be two DOFs, or a DOF and its value."""
    pair = list(prescribed) if np.iterable(prescribed) else []
    if len(pair) != 2 or (isinstance(prescribed, list) and np.ndim(pair[0]) == 0):
        raise InputError("prescribed is neither {DOF: value, ...} nor a pair (DOFs, values)")
    return pair[0], pair[1]

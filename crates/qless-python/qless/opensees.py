"""OpenSees: records ``fix``, ``equalDOF``, ``rigidLink`` and ``rigidDiaphragm``, and issues only an independent set of them.

    h = qless.opensees.Constraints(ops)      # then h.rigidDiaphragm(...) instead of ops.rigidDiaphragm(...)
    print(h.analyse())                       # which rows say nothing new, and why
    h.apply()                                # issues the others to OpenSees

Commands have the arguments of openseespy. An OpenSees model does not tell the coefficients of its constraints, so that they must be
recorded. Redundant rows make the matrix of the Lagrange handler singular. The Transformation handler keeps one constraint of a node and
drops others without an error; :meth:`Constraints.apply` refuses sets that it would solve wrongly. The Lagrange handler of OpenSees 3.7.1
ends the process if a constraint does not tie all DOFs of its node; newer versions do not.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ._constraints import Constraints as Equations
from ._errors import InputError
from ._result import Kind, Result, make
from ._rigid import turns


@dataclass
class _Group:
    """The rows of one command for one constrained node: ``u[dofs] = motion @ u_retained``."""

    command: str
    arguments: tuple[Any, ...]
    retained: int
    constrained: int
    dofs: list[int]
    motion: np.ndarray

    def label(self, k: int) -> str:
        arguments = " ".join(map(str, self.arguments))
        return f"{self.command} {arguments}, node {self.constrained} DOF {self.dofs[k]}"

    def is_equality(self, k: int) -> bool:
        """Whether row k says that one DOF is the same at both nodes."""
        return np.array_equal(np.flatnonzero(self.motion[k]), [self.dofs[k] - 1]) and self.motion[k, self.dofs[k] - 1] == 1.0


@dataclass
class _Command:
    """A command to issue, and the pair of nodes and the DOFs that it ties."""

    name: str
    arguments: tuple[Any, ...]
    retained: int
    constrained: int
    dofs: tuple[int, ...]

    def __str__(self) -> str:
        return f"{self.name}({', '.join(map(str, self.arguments))})"


class Constraints:
    """The constraints of an OpenSees model with 3 DOFs a node in 2D or 6 in 3D. Nodes and DOFs have their numbers in OpenSees."""

    def __init__(self, ops: Any) -> None:
        self._ops = ops
        self._dimensions = int(ops.getNDM()[0])
        self._size = 3 if self._dimensions == 2 else 6
        self._groups: list[_Group] = []
        self._fixed: list[tuple[int, tuple[int, ...]]] = []
        self._places: dict[int, int] = {}

    def fix(self, node: int, *flags: int) -> None:
        """Fixes the DOFs of a node whose flags are 1."""
        if len(flags) > self._size:
            raise InputError(f"fix {node}: there are {len(flags)} flags; a node has {self._size} DOFs")
        self._place(node)
        self._fixed.append((node, (*flags, *(0,) * (self._size - len(flags)))))

    def equalDOF(self, retained: int, constrained: int, *dofs: int) -> None:  # noqa: N802
        """The same motion of both nodes in these DOFs, which count from 1."""
        for dof in dofs:
            if not 1 <= dof <= self._size:
                raise InputError(f"equalDOF {retained} {constrained}: DOF {dof}; DOFs are 1 to {self._size}")
        self._add("equalDOF", (retained, constrained, *dofs), retained, constrained, list(dofs), np.eye(self._size))

    def rigidLink(self, kind: str, retained: int, constrained: int) -> None:  # noqa: N802
        """A rigid link: a "beam" ties all DOFs, a "bar" makes the translations equal."""
        if kind not in ("bar", "beam"):
            raise InputError(f'rigidLink {kind} {retained} {constrained}: give "bar" or "beam"')
        dofs = range(1, (self._size if kind == "beam" else self._dimensions) + 1)
        motion = self._rigid(retained, constrained) if kind == "beam" else np.eye(self._size)
        self._add("rigidLink", (kind, retained, constrained), retained, constrained, list(dofs), motion)

    def rigidDiaphragm(self, direction: int, retained: int, *constrained: int) -> None:  # noqa: N802
        """A floor that moves in its plane as a rigid body; `direction` is that of the normal, 1 to 3."""
        if self._dimensions != 3 or direction not in (1, 2, 3):
            raise InputError(f"rigidDiaphragm {direction} {retained}: it needs a model in 3D, and a direction from 1 to 3")
        dofs = [k for k in (1, 2, 3) if k != direction] + [3 + direction]
        for node in constrained:
            arm = self._arm(retained, node)
            if abs(arm[direction - 1]) > 1e-12 * max(np.abs(arm).max(), 1e-300):
                raise InputError(f"rigidDiaphragm {direction} {retained}: node {node} is not in the plane of node {retained}")
            motion = np.zeros((self._size, self._size))
            motion[:, np.array(dofs) - 1] = self._rigid(retained, node)[:, np.array(dofs) - 1]
            self._add("rigidDiaphragm", (direction, retained), retained, node, dofs, motion)

    def analyse(self, **options: Any) -> Result:
        """Diagnoses all constraints. Rows of rigid links and floors are kept rather than those of `equalDOF`, which can be split."""
        rigid = [row for group, rows in self._rows() if group.command != "equalDOF" for row in rows]
        return self._equations().analyse(**{"keep": rigid, **options})

    def apply(self, handler: str = "Transformation", **options: Any) -> Result:
        """Issues the fixed DOFs and an independent set of rows to OpenSees; returns the diagnosis.

        `handler` is the name that the model gives to ``ops.constraints``. Raises :class:`InputError` if this handler would solve the set
        wrongly, or if OpenSees has no command for the independent rows of a rigid constraint alone; nothing has been issued then.
        """
        result = self.analyse(**options)
        kept = result.kinds == Kind.INDEPENDENT
        if any(group.command != "equalDOF" and 0 < kept[rows].sum() < len(rows) for group, rows in self._rows()):
            kept = self._whole(options)
        commands = self._commands(kept)
        if handler == "Transformation":
            self._refuse_chains(commands)
        for node, flags in self._fixed:
            self._ops.fix(node, *flags)
        for command in commands:
            getattr(self._ops, command.name)(*command.arguments)
        return result

    # Commands.

    def _commands(self, kept: np.ndarray) -> list[_Command]:
        """The commands for the kept rows; all `equalDOF` of one pair of nodes are one command."""
        commands: list[_Command] = []
        equal: dict[tuple[int, int], _Command] = {}
        for group, rows in self._rows():
            wanted = np.flatnonzero(kept[rows])
            dofs, pair = tuple(group.dofs[k] for k in wanted), (group.retained, group.constrained)
            if group.command != "equalDOF" and len(wanted) == len(rows):
                nodes = (group.constrained,) if group.command == "rigidDiaphragm" else ()
                commands.append(_Command(group.command, (*group.arguments, *nodes), *pair, dofs))
            elif wanted.size:
                self._refuse_partial(group, wanted, rows)
                if pair not in equal:
                    equal[pair] = _Command("equalDOF", pair, *pair, ())
                    commands.append(equal[pair])
                equal[pair].arguments += dofs
                equal[pair].dofs += dofs
        return commands

    def _refuse_chains(self, commands: list[_Command]) -> None:
        """The Transformation handler takes one constraint of a node; its retained node is not constrained, and its DOFs are not fixed."""
        fixed = {(node, dof) for node, flags in self._fixed for dof, flag in enumerate(flags, 1) if flag}
        by_node: dict[int, _Command] = {}
        for command in commands:
            other = by_node.setdefault(command.constrained, command)
            if other is not command:
                self._refuse(f"node {command.constrained} is constrained by both {other} and {command}")
        for command in commands:
            if command.retained in by_node:
                self._refuse(f"node {command.retained} is retained by {command} and constrained by {by_node[command.retained]}")
            for dof in command.dofs:
                if (command.constrained, dof) in fixed:
                    self._refuse(f"node {command.constrained} DOF {dof} is fixed and constrained by {command}")

    def _refuse(self, what: str) -> None:
        raise InputError(
            f"{what}, which the Transformation handler solves wrongly without an error; retain one common node in both, or name"
            ' another handler: apply("Lagrange")'
        )

    def _refuse_partial(self, group: _Group, wanted: np.ndarray, rows: np.ndarray) -> None:
        for k in wanted:
            if not group.is_equality(k):
                raise InputError(
                    f'row {rows[k]} "{group.label(k)}" is independent, but another row of this command is not, and OpenSees has no command'
                    f" for the one without the other; leave node {group.constrained} out, and tie it by elements or equalDOF",
                    row=int(rows[k]),
                )

    # Rows.

    def _rows(self) -> list[tuple[_Group, np.ndarray]]:
        """Each group with its rows."""
        ends = np.cumsum([0, *(len(group.dofs) for group in self._groups)])
        return [(group, np.arange(first, last)) for group, first, last in zip(self._groups, ends[:-1], ends[1:], strict=True)]

    def _whole(self, options: dict[str, Any]) -> np.ndarray:
        """The rows that each add to those before them, rigid links and floors first, so that few of these are split."""
        equations = self._equations()
        C, kept = equations.C, np.zeros(len(equations), dtype=bool)  # noqa: N806
        prescribed = equations.prescribed
        for _, rows in sorted(self._rows(), key=lambda one: one[0].command == "equalDOF"):
            before = np.flatnonzero(kept)
            some = np.r_[before, rows]
            found = make(C[some], None, prescribed, **{**options, "keep": list(range(len(before)))})
            kept[some[found.independent]] = True
        return kept

    def _equations(self) -> Equations:
        equations = Equations(self._size * len(self._places))
        for group, _ in self._rows():
            for k in range(len(group.dofs)):
                self._equation(equations, group, k)
        equations.prescribe({self._dof(node, k): 0.0 for node, flags in self._fixed for k, flag in enumerate(flags, 1) if flag})
        equations.label_dofs(f"node {node} DOF {k}" for node in self._places for k in range(1, self._size + 1))
        return equations

    def _equation(self, equations: Equations, group: _Group, k: int) -> None:
        """``u_constrained - motion u_retained = 0`` for one DOF."""
        used = np.flatnonzero(group.motion[k])
        dofs = [self._dof(group.constrained, group.dofs[k]), *(self._dof(group.retained, int(j) + 1) for j in used)]
        equations.equation(dofs, np.r_[1.0, -group.motion[k, used]], label=group.label(k))

    def _add(self, command: str, arguments: tuple[Any, ...], retained: int, constrained: int, dofs: list[int], motion: Any) -> None:
        if retained == constrained:
            raise InputError(f"{command} {' '.join(map(str, arguments))}: node {constrained} cannot be tied to itself")
        self._place(retained)
        self._place(constrained)
        self._groups.append(_Group(command, arguments, retained, constrained, dofs, motion[np.array(dofs, dtype=int) - 1]))

    def _rigid(self, retained: int, constrained: int) -> np.ndarray:
        """The motion of the constrained node from that of the retained one, for small rotations."""
        d, motion = self._dimensions, np.eye(self._size)
        motion[:d, d:] = turns(self._arm(retained, constrained)[None])[0]
        return motion

    def _arm(self, retained: int, constrained: int) -> np.ndarray:
        return np.subtract(self._ops.nodeCoord(constrained), self._ops.nodeCoord(retained))

    def _place(self, node: int) -> int:
        if node not in self._places and node not in self._ops.getNodeTags():
            raise InputError(f"node {node} is not in the model; define it before its constraints")
        return self._places.setdefault(node, len(self._places))

    def _dof(self, node: int, dof: int) -> int:
        return self._size * self._place(node) + dof - 1

"""Why an equation is dependent or a DOF fixed, over equations and prescribed values, and how to cure conflicts."""

from __future__ import annotations

from typing import Any, NamedTuple

#: Most terms of a reason, and ways of a repair, that a text names.
_TERMS, _WAYS = 12, 4
#: A text names relative errors above this one.
_SAME = 1e-9


class RowTerm(NamedTuple):
    """``coefficient`` times an equation."""

    row: int
    coefficient: float
    #: Label of the equation, if it has one.
    label: str | None = None

    def __str__(self) -> str:
        return named("row", self.row, self.label)


class ValueTerm(NamedTuple):
    """``coefficient`` times ``u_dof = value``, a prescribed value."""

    dof: int
    coefficient: float
    value: float
    #: Label of the DOF, if it has one.
    label: str | None = None

    def __str__(self) -> str:
        return f"({named('DOF', self.dof, self.label)} = {self.value:.6g})"


class Reason(NamedTuple):
    """Equations and prescribed values whose sum is another equation, or the value of a fixed DOF.

    The members may be redundant equations, not only kept ones.
    """

    #: Equations, ascending, then prescribed values, ascending; empty for the equation ``0 = b``.
    members: list[RowTerm | ValueTerm]
    #: ``sum c_i b_i + sum d_j value_j``: the right-hand side with which the equation is redundant, or the value of the fixed DOF.
    right_hand_side: float
    #: The right-hand side that the explained equation asks for; None for a DOF.
    asked: float | None
    #: Whether the equation conflicts with its members.
    conflicts: bool
    #: Relative error of the sum.
    error: float
    #: No smaller set of the members explains the same. False if that is not known: more than 128 equations, some with small coefficients;
    #: members of which rounding does not tell whether they are independent; or an error above rounding.
    irreducible: bool
    #: The explained equation or DOF, such as ``row 2 "glue"``.
    subject: str
    #: Number of coefficients of the rows that count as zero (:attr:`qless.Result.noise`): the sum holds without them.
    zeros: int = 0

    @property
    def rows(self) -> list[int]:
        """Rows of the members that are equations."""
        return [member.row for member in self.members if isinstance(member, RowTerm)]

    @property
    def dofs(self) -> list[int]:
        """DOFs of the members that are prescribed values."""
        return [member.dof for member in self.members if isinstance(member, ValueTerm)]

    def __str__(self) -> str:
        is_of_dof = self.asked is None
        said = f"{self.subject} = {self.right_hand_side:.6g}, from {self._sum()}" if is_of_dof else f"{self.subject} = {self._sum()}"
        if self.conflicts and self.asked is not None:
            said += f", but the right-hand sides differ by {self.asked - self.right_hand_side:.6g}"
        return said + caveat(self.error if self.error > _SAME else 0.0, self.zeros)

    def _sum(self) -> str:
        signs = ["-" if member.coefficient < 0 else "+" for member in self.members]
        terms = [f"{sign} {abs(member.coefficient):.6g} * {member}" for sign, member in zip(signs, self.members, strict=True)]
        more = f" + ... and {len(terms) - _TERMS} more" if len(terms) > _TERMS else ""
        return (" ".join(terms[:_TERMS]).removeprefix("+ ") or "0") + more


class Change(NamedTuple):
    """Another value for a right-hand side or a prescribed value."""

    #: The equation whose right-hand side changes; None if a prescribed value changes.
    row: int | None
    #: The DOF whose prescribed value changes; None if a right-hand side changes.
    dof: int | None
    #: The present value.
    old: float
    #: The value that cures, rounded to 12 digits.
    new: float
    #: Label of the equation or DOF, if it has one.
    label: str | None = None

    def __str__(self) -> str:
        place = f"b of {named('row', self.row, self.label)}" if self.row is not None else named("DOF", self.dof, self.label)
        return f"{place}: {self.old:.12g} -> {self.new:.12g}"


class Repair(NamedTuple):
    """Ways to cure conflicts that have numbers in common."""

    #: The conflicting equations, ascending.
    conflicts: list[int]
    #: Changes that cure all of them together, each verified, the most plausible way first; all ways have the same number of changes, and
    #: at most 16 are listed. Empty if more than 64 conflicts have no single change that cures them.
    ways: list[list[Change]]
    #: Number of ways of this size: the listed ones, and others that were not verified.
    total: int

    def __str__(self) -> str:
        rows = ", ".join(map(str, self.conflicts[:_TERMS])) + (", ..." if len(self.conflicts) > _TERMS else "")
        if not self.ways:
            return f"no single change cures the conflicts of rows {rows}"
        ways = [" and ".join(map(str, way)) for way in self.ways[:_WAYS]]
        more = f", or {len(self.ways) - len(ways)} other ways" if len(self.ways) > len(ways) else ""
        more += f"; {self.total - len(self.ways)} more were not verified" if self.total > len(self.ways) else ""
        return f"to cure row{'s' * (len(self.conflicts) > 1)} {rows}, change {', or '.join(ways)}{more}"


def caveat(error: float, zeros: int) -> str:
    """How far a sum of rows is not the explained row: its relative error, and the coefficients that count as zero."""
    text = f" (only to a relative error of {error:.1e})" if error > 0 else ""
    if zeros:
        text += f" (without {zeros} coefficient{'s' * (zeros > 1)} that count{'s' * (zeros == 1)} as zero, as rounding)"
    return text


def named(what: str, place: Any, label: str | None) -> str:
    """``row 2 "glue"``."""
    return f"{what} {place}" if label is None else f'{what} {place} "{label}"'


def reason(found: Any, labels: list[str], dof_labels: list[str]) -> tuple[list[RowTerm | ValueTerm], float, float, bool]:
    """Members, right-hand side, error and irreducibility from the arrays of the extension module."""
    (rows, of_rows), (dofs, of_dofs, values), right_hand_side, error, irreducible = found
    equations = [RowTerm(i, c, label(labels, i)) for i, c in zip(rows.tolist(), of_rows.tolist(), strict=True)]
    of_values = zip(dofs.tolist(), of_dofs.tolist(), values.tolist(), strict=True)
    prescribed = [ValueTerm(j, c, value, label(dof_labels, j)) for j, c, value in of_values]
    return [*equations, *prescribed], right_hand_side, error, irreducible


def repair(found: Any, labels: list[str], dof_labels: list[str]) -> Repair:
    """A repair from the numbers of the extension module."""
    conflicts, ways, total = found

    def change(row: int | None, dof: int | None, old: float, new: float) -> Change:
        return Change(row, dof, old, new, label(labels, row) if dof is None else label(dof_labels, dof))

    return Repair(conflicts, [[change(*numbers) for numbers in way] for way in ways], total)


def label(labels: list[str], place: int | None) -> str | None:
    """The label of a row or DOF, or None without labels."""
    return labels[place] if labels and place is not None else None

"""Exceptions. Rows and DOFs count from 0."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ._result import Explanation


class Error(Exception):
    """Base of all exceptions of qless."""


class InputError(Error, ValueError):
    """Numbers, indices, lengths or options that are not valid."""

    def __init__(self, message: str, *, row: int | None = None, dof: int | None = None) -> None:
        super().__init__(message)
        #: The equation concerned, if there is one.
        self.row = row
        #: The DOF concerned, if there is one.
        self.dof = dof


class FactorError(Error):
    """A block needs more memory than is allowed, or could not be factored."""

    def __init__(self, message: str, *, row: int | None = None, dof: int | None = None) -> None:
        super().__init__(message)


class ReductionError(Error):
    """The equations are too nearly dependent to be solved for slaves."""

    def __init__(self, message: str, *, row: int | None = None, dof: int | None = None) -> None:
        super().__init__(message)
        self.row = row
        self.dof = dof


class ReadError(Error):
    """A file cannot be read; the message names the file, the line and what to do."""

    def __init__(self, message: str, **_: Any) -> None:
        super().__init__(message)


class Conflict(Error):
    """Equations contradict others, so no u satisfies all of them."""

    def __init__(self, message: str, rows: list[int], explanations: list[Explanation] | None = None) -> None:
        super().__init__(message)
        #: The conflicting equations.
        self.rows = rows
        #: For each conflicting equation, the equations that it contradicts.
        self.explanations = explanations or []

    @property
    def multipliers(self) -> list[dict[int, float]]:
        """For each conflict, y by row with ``y' C = 0`` over the free DOFs and ``y' b != 0``, prescribed DOFs moved into b."""
        return [{**{row: -c for row, c in one.terms}, one.row: 1.0} for one in self.explanations]

"""Texts of a result. Rows and DOFs count from 0."""

from __future__ import annotations

import html as _html
from typing import TYPE_CHECKING

from ._errors import FactorError
from ._reasons import caveat

if TYPE_CHECKING:
    from ._result import Explanation, Result

#: Most dependent equations, and terms of each, that a text names.
_LINES, _TERMS = 10, 12


def _row(row: int, labels: dict[int, str]) -> str:
    return f'row {row} "{labels[row]}"' if row in labels else f"row {row}"


def explanation(one: Explanation) -> str:
    """``row 2 = 1 * row 0 + 1 * row 1``."""
    if one.kind == 0:
        return f"{_row(one.row, one.labels)} is independent"
    terms = [f"{abs(c):.6g} * {_row(row, one.labels)}" for row, c in one.terms[:_TERMS]]
    signs = ["-" if c < 0 else "+" for _, c in one.terms]
    said = " ".join(f"{sign} {term}" for sign, term in zip(signs, terms)).removeprefix("+ ") or "0"
    if len(one.terms) > _TERMS:
        said += f" + ... and {len(one.terms) - _TERMS} more"
    text = f"{_row(one.row, one.labels)} = {said}"
    if one.kind == 2:
        text += f", but the right-hand sides differ by {one.mismatch:.6g}"
    return text + caveat(one.error, one.zeros)


def conflicts(result: Result, rows: list[int]) -> str:
    """The message of :class:`qless.Conflict`."""
    lines = [str(result.explain(row)) for row in rows[:_LINES]]
    if len(rows) > _LINES:
        lines.append(f"and {len(rows) - _LINES} more; `repairs()` tells which numbers to change")
    else:
        lines.extend(_repairs(result))
    count = len(rows)
    head = "1 equation conflicts with others" if count == 1 else f"{count} equations conflict with others"
    return "\n  ".join([f"{head}; correct its right-hand side or that of one in its combination, or remove it:", *lines])


def _repairs(result: Result) -> list[str]:
    """What cures the conflicts, unless it needs more memory than is allowed: the conflicts themselves are the message."""
    try:
        return [str(repair) for repair in result.repairs()]
    except FactorError:
        return []


def _counted(result: Result) -> str:
    redundant, conflicting, all_rows = len(result.redundant), len(result.conflicting), result.shape[0]
    if not redundant and not conflicting:
        return f"All {all_rows} equations are independent."
    parts = [f"{count} {word}" for count, word in ((redundant, "redundant"), (conflicting, "conflicting")) if count]
    return f"Of {all_rows} equations {' and '.join(parts)}; the rest ({all_rows - redundant - conflicting}) independent."


def _lines(result: Result) -> list[str]:
    digits = result.digits
    lines = [f"Rank {result.rank} on {result.shape[1]} DOFs. It stands unless coefficients are wrong in digit {int(digits.kept) + 1}."]
    if result.left_out:
        lines.append(f"INCOMPLETE: {len(result.left_out)} constraints of the file were left out, and the verdict is of the others.")
    if result.fixed:
        few = ", ".join(f"DOF {dof} = {value:.6g}" for dof, value in list(result.fixed.items())[:_TERMS])
        more = f" and {len(result.fixed) - _TERMS} more" if len(result.fixed) > _TERMS else ""
        lines.append(f"The equations fix {len(result.fixed)} free DOFs: {few}{more}.")
    if result.ambiguous:
        lines.append(f"AMBIGUOUS ({result.doubt}): another rank or verdict is possible.")
    other = result.other_reading
    if other:
        reading = "count as zero" if other["as_zero"] else "are taken as given"
        lines.append(
            f"If coefficients that may be rounding {reading}, the rank is {other['rank']}, with {other['conflicting']} conflicts;"
            " `noise` decides which reading holds."
        )
    if result.noise:
        lines.append(f"{len(result.noise)} coefficients count as zero, because they are rounding of others.")
    return lines


def _dependent(result: Result) -> list[int]:
    kinds = result.kinds
    return sorted(kinds.nonzero()[0].tolist(), key=lambda row: (-int(kinds[row]), row))


def text(result: Result) -> str:
    """The diagnosis for people, conflicts first."""
    rows = _dependent(result)
    said = [f"  {result.because(row)}" for row in rows[:_LINES]]
    if len(rows) > _LINES:
        said.append(f"  and {len(rows) - _LINES} more")
    return "\n".join([_counted(result), *said, *_lines(result)])


def html(result: Result) -> str:
    """The same for notebooks: a table of the dependent equations."""
    rows = _dependent(result)
    kinds = result.kinds
    cells = "".join(
        f"<tr><td>{row}</td><td>{'conflicting' if kinds[row] == 2 else 'redundant'}</td>"
        f"<td style='text-align:left'>{_html.escape(str(result.because(row)))}</td></tr>"
        for row in rows[:_LINES]
    )
    more = f"<p>and {len(rows) - _LINES} more</p>" if len(rows) > _LINES else ""
    table = f"<table><tr><th>row</th><th>kind</th><th>because</th></tr>{cells}</table>{more}" if cells else ""
    said = "".join(f"<p>{_html.escape(line)}</p>" for line in _lines(result))
    return f"<div><p><b>{_html.escape(_counted(result))}</b></p>{table}{said}</div>"

"""Converts input and output matrices: dense arrays, and those of scipy.sparse if it is installed."""

from __future__ import annotations

import operator
from numbers import Integral
from typing import Any

import numpy as np

from . import _qless
from ._errors import InputError

#: (starts, indices, values) of compressed rows or columns.
Arrays = tuple[np.ndarray, np.ndarray, np.ndarray]

#: All whole numbers up to this one are exact in f64.
_EXACT = 2**53


def is_sparse(matrix: Any) -> bool:
    """Whether a matrix is one of scipy.sparse; does not import it."""
    return hasattr(matrix, "tocsr")


def array(values: Any) -> np.ndarray:
    """An array of whatever numpy makes one of, without masked entries: numpy would read the numbers behind the mask."""
    rows = values if isinstance(values, (list, tuple)) else (values,)
    if any(isinstance(row, np.ma.MaskedArray) and np.ma.is_masked(row) for row in rows):
        raise InputError("the array has masked entries, which have no value; fill them, or leave their equations out")
    try:
        return np.asarray(values)
    except ValueError as error:
        raise InputError(f"this is no array: {error}") from None


def floats(values: Any) -> np.ndarray:
    """Real numbers as they are if they are f32 or f64, else as f64. Whole numbers must be exact in f64."""
    values = array(values)
    kind = values.dtype.kind
    if kind == "c":
        raise InputError("complex numbers are not supported; give the real and the imaginary equations")
    if values.dtype == np.float64 or values.dtype == np.float32:
        return values
    if kind not in "biufO":
        raise InputError(f"these are no real numbers: they are of type {values.dtype}")
    try:
        rounded = values.astype(np.float64)
    except (TypeError, ValueError, OverflowError) as error:
        raise InputError(f"these are no real numbers: {error}") from None
    large = np.abs(rounded) >= _EXACT
    for value, double in zip(values[large].tolist(), rounded[large].tolist(), strict=True):
        if isinstance(value, Integral) and int(value) != double:
            raise InputError(f"the whole number {value} is not exact in f64, as all up to 2**53 are; scale its equation, or round it")
    return rounded


def integers(values: Any) -> np.ndarray:
    """Indices as they are if they are int32 or int64, else as int64."""
    values = array(values)
    if values.dtype == np.int32 or values.dtype == np.int64:
        return values
    if values.size and values.dtype.kind not in "iu":
        raise InputError(f"indices are of type {values.dtype}; give integers")
    if values.size and values.max() > np.iinfo(np.int64).max:
        raise InputError(f"the index {values.max()} is too large; rows and DOFs count from 0")
    return values.astype(np.int64)


def natural(value: Any, what: str, count: int) -> int:
    """A whole number from 0 and below `count`, such as a row or a DOF."""
    try:
        number = operator.index(value)
    except TypeError:
        raise InputError(f"{what} {value!r} is no whole number; give one from 0") from None
    if not 0 <= number < count:
        raise InputError(f"{what} {number} is out of range; give a whole number from 0, below {count}")
    return number


def names(labels: Any) -> list[str] | None:
    """Labels as text. A single text is no list of labels, although Python takes it for a list of letters."""
    if isinstance(labels, str):
        raise InputError(f"labels are the text {labels!r}; give a list of labels")
    return None if labels is None else list(map(str, labels))


def doubles(values: Any, shape: tuple[int, ...] | None = None) -> np.ndarray:
    """Numbers as f64. With `shape`: one number, which is repeated, or an array of this shape or of its last axes."""
    values = floats(values).astype(np.float64, copy=False)
    if shape is None or values.shape == shape:
        return values
    if values.ndim > len(shape) or values.shape != shape[len(shape) - values.ndim :]:
        raise InputError(f"numbers are of shape {values.shape}, but {shape} is needed; give one number for all, or one for each")
    return np.array(np.broadcast_to(values, shape))


def right_hand_sides(b: Any) -> np.ndarray:
    """b as f64, a number for each equation."""
    if is_sparse(b):
        raise InputError("b is sparse; give an array with a number for each equation")
    b = doubles(b)
    if b.ndim != 1:
        raise InputError(f"b is an array of shape {b.shape}; give one with a number for each equation")
    return b


def check_indices(matrix: Any) -> None:
    """Raises :class:`InputError` for indices outside the matrix, which the conversions of scipy trust."""
    kind = getattr(matrix, "format", "")
    try:
        if kind in ("csc", "bsr"):
            matrix.check_format(full_check=True)
        indices = (("row", matrix.row), ("column", matrix.col)) if kind == "coo" else ()
        for (name, index), count in zip(indices, matrix.shape, strict=False):
            if index.size and not (index.min() >= 0 and index.max() < count):
                raise ValueError(f"{name} indices are {index.min()} to {index.max()}, but there are {count} {name}s")
    except ValueError as error:
        raise InputError(f"the {kind.upper()} matrix is not valid: {error}") from None


def compressed_rows(matrix: Any) -> Any:
    """A matrix of scipy.sparse in compressed rows, without a copy if it already has this form."""
    check_indices(matrix)
    return matrix.tocsr()


def csr_arrays(matrix: Any) -> Arrays:
    """The arrays of a matrix of scipy.sparse in compressed rows, without a copy if it already has this form and type."""
    rows = compressed_rows(matrix)
    return integers(rows.indptr), integers(rows.indices), floats(rows.data)


def system(matrix: Any, sides: dict[str, Any]) -> _qless.System:
    """The validated system of C and its other data: b, prescribed DOFs and labels."""
    if is_sparse(matrix):
        if len(matrix.shape) != 2:
            raise InputError(f"the matrix has {len(matrix.shape)} dimension; give C as an m x n matrix")
        return _qless.system_from_rows(matrix.shape[1], csr_arrays(matrix), sides)
    if isinstance(matrix, tuple) and len(matrix) == 2 and isinstance(matrix[1], int):
        arrays, dofs = matrix
        return _qless.system_from_rows(dofs, arrays, sides)
    dense = floats(matrix)
    if dense.ndim != 2:
        raise InputError(f"the matrix has {dense.ndim} dimensions; give C as an m x n array")
    return _qless.system_from_dense(dense, sides)


def csr(arrays: Arrays, shape: tuple[int, int], kind: str = "csr") -> Any:
    """A matrix of scipy.sparse on these arrays."""
    try:
        from scipy import sparse
    except ImportError as error:
        raise ImportError("sparse results need scipy: pip install scipy") from error
    make = sparse.csr_array if kind == "csr" else sparse.csc_array
    starts, index, values = arrays
    return make((values, index, starts), shape=shape)

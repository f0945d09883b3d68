"""Converts input and output matrices: dense arrays, and those of scipy.sparse if it is installed."""

from __future__ import annotations

from typing import Any

import numpy as np

from . import _qless
from ._errors import InputError

#: (starts, indices, values) of compressed rows or columns.
Arrays = tuple[np.ndarray, np.ndarray, np.ndarray]


def is_sparse(matrix: Any) -> bool:
    """Whether a matrix is one of scipy.sparse; does not import it."""
    return hasattr(matrix, "tocsr")


def floats(values: Any) -> np.ndarray:
    """Real numbers as they are if they are f32 or f64, else as f64."""
    values = np.asarray(values)
    if values.dtype.kind == "c":
        raise InputError("complex numbers are not supported; give the real and the imaginary equations")
    if values.dtype == np.float64 or values.dtype == np.float32:
        return values
    try:
        return values.astype(np.float64)
    except (TypeError, ValueError, OverflowError) as error:
        raise InputError(f"these are no real numbers: {error}") from None


def integers(values: Any) -> np.ndarray:
    """Indices as they are if they are int32 or int64, else as int64."""
    values = np.asarray(values)
    if values.dtype == np.int32 or values.dtype == np.int64:
        return values
    if values.size and values.dtype.kind not in "iu":
        raise InputError(f"indices are of type {values.dtype}; give integers")
    return values.astype(np.int64)


def doubles(values: Any, shape: tuple[int, ...] | None = None) -> np.ndarray:
    """Numbers as f64, broadcast to `shape` if it is given."""
    values = floats(values).astype(np.float64, copy=False)
    return values if shape is None or values.shape == shape else np.array(np.broadcast_to(values, shape))


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


def csr_arrays(matrix: Any) -> Arrays:
    """Compressed rows of a matrix of scipy.sparse, without a copy if it already has this form and type."""
    check_indices(matrix)
    rows = matrix.tocsr()
    return integers(rows.indptr), integers(rows.indices), floats(rows.data)


def system(matrix: Any, sides: dict[str, Any]) -> _qless.System:
    """The validated system of C and its other data: b, prescribed DOFs and labels."""
    if is_sparse(matrix):
        if len(matrix.shape) != 2:
            raise InputError(f"the matrix has {len(matrix.shape)} dimension; give C as an m x n matrix")
        return _qless.system_from_rows(matrix.shape[1], csr_arrays(matrix), sides)
    if isinstance(matrix, tuple) and len(matrix) == 2:
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

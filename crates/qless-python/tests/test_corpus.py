"""The bits of Python are those of the library: every case of the corpus through the C interface, which Rust's tests compare with Rust."""

import ctypes
import json
import os
import pathlib

import numpy as np
import pytest

import qless

CASES = sorted((pathlib.Path(__file__).resolve().parents[3] / "tests" / "corpus" / "cases").iterdir())


def library():
    path = os.environ.get("QLESS_LIBRARY")
    assert path, "QLESS_LIBRARY names no libqless_capi.so; scripts/python builds it and sets it"
    return ctypes.CDLL(path)


def address(array):
    return None if array is None else array.ctypes.data_as(ctypes.c_void_p)


def numbers(of, handle, count):
    found = [ctypes.c_int64() for _ in range(count)]
    assert of(handle, *map(ctypes.byref, found)) >= 0
    return [number.value for number in found]


def by_c(c, C, b, dofs, values):
    """Rank, kinds, and the arrays of the reduced form if there is one."""
    starts, columns = C.indptr.astype(np.int64), C.indices.astype(np.int64)
    analysis, reduced = ctypes.c_void_p(), ctypes.c_void_p()
    sizes = ctypes.c_int64(C.shape[0]), ctypes.c_int64(C.shape[1])
    arrays = address(starts), address(columns), address(C.data), address(b), ctypes.c_int64(len(dofs)), address(dofs), address(values)
    assert c.qless_analyse_64(*sizes, 0, *arrays, None, ctypes.byref(analysis)) >= 0
    rank = numbers(c.qless_counts, analysis, 5)[2]
    kinds = np.empty(C.shape[0], dtype=np.int8)
    assert c.qless_kinds(analysis, address(kinds), ctypes.c_int64(len(kinds))) == 0
    if c.qless_eliminate(analysis, ctypes.byref(reduced)) != 0:
        return rank, kinds, None
    slaves, masters, _, t, g = numbers(c.qless_sizes, reduced, 5)
    s, q, constants, u = np.empty(slaves, np.int64), np.empty(masters, np.int64), np.empty(slaves), np.empty(C.shape[1])
    T, G = ((np.empty(slaves + 1, np.int64), np.empty(entries, np.int64), np.empty(entries)) for entries in (t, g))
    x = 1.0 / (1.0 + np.arange(masters))
    assert c.qless_dofs_64(reduced, address(s), address(q), None) == 0
    assert c.qless_g_matrix_64(reduced, *map(address, G)) == 0
    assert c.qless_t_64(reduced, *map(address, T)) == 0
    assert c.qless_g(reduced, address(constants), ctypes.c_int64(slaves)) == 0
    assert c.qless_expand(reduced, address(x), ctypes.c_int64(masters), address(u), ctypes.c_int64(len(u))) == 0
    return rank, kinds, (s, q, *T, *G, constants, u)


def arrays(matrix):
    return matrix.indptr.astype(np.int64), matrix.indices.astype(np.int64), matrix.data


def test_there_is_a_corpus():
    assert len(CASES) > 25


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_python_has_the_bits_of_the_library(case):
    read = qless.read(case)
    r = read.analyse()
    dofs, values = np.array(list(read.prescribed), dtype=np.int64), np.array(list(read.prescribed.values()), dtype=float)
    rank, kinds, reduced = by_c(library(), read.C, read.b, dofs, values)
    assert (r.rank, r.kinds.tolist()) == (rank, kinds.tolist())
    if reduced is None:
        assert r.conflicting.size
        return
    x = 1.0 / (1.0 + np.arange(len(r.masters)))
    ours = r.slaves, r.masters, *arrays(r.T), *arrays(r.G), r.g, r.expand(x)
    for mine, theirs in zip(ours, reduced, strict=True):
        assert mine.tobytes() == theirs.tobytes()


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_reasons_and_repairs_are_those_of_the_report(case):
    r = qless.read(case).analyse()
    report = json.loads(r.to_json())
    for found in report["dependent"]:
        reason = r.explain(found["row"] - 1)
        ours = [(getattr(member, "row", None), getattr(member, "dof", None), member.coefficient) for member in reason.members]
        from_one = lambda number: None if number is None else number - 1
        assert ours == [(from_one(term.get("row")), from_one(term.get("dof")), term["coefficient"]) for term in found["because"]]
        assert reason.conflicts == (found["kind"] == "conflicting")
    for mine, theirs in zip(r.repairs(), report.get("repairs", []), strict=True):
        assert ([row + 1 for row in mine.conflicts], mine.total) == (theirs["conflicts"], theirs["count"])
        assert [[(c.old, c.new) for c in way] for way in mine.ways] == [[(c["from"], c["to"]) for c in way] for way in theirs["ways"]]

"""The rank of C as HiGHS finds it: presolve and simplex on `C u = C x` for a random x, u free, no objective. With such a right-hand side
the equations whose own variable stays in the basis are those that the others imply. Reads systems from standard input and writes
`rank seconds` for each, or `failed` and why; super::solvers has the format."""
import ctypes
import os
import sys
import time

import highspy
import numpy

if sys.platform == "linux":
    # PR_SET_PDEATHSIG, SIGKILL: ends with the process that started it.
    ctypes.CDLL(None).prctl(1, 9)
# HiGHS writes a banner to standard output.
answers = os.fdopen(os.dup(1), "w")
os.dup2(2, 1)


def array(kind, count):
    return numpy.frombuffer(sys.stdin.buffer.read(numpy.dtype(kind).itemsize * count), kind)


def model(rows, cols, entries):
    start, row, value = array("u8", cols + 1), array("u4", entries), array("f8", entries)
    x = numpy.random.default_rng(1).uniform(1.0, 2.0, cols)
    lp = highspy.HighsLp()
    lp.num_row_, lp.num_col_ = rows, cols
    lp.row_lower_ = lp.row_upper_ = numpy.bincount(row, value * numpy.repeat(x, numpy.diff(start.astype(int))), rows)
    lp.col_cost_ = numpy.zeros(cols)
    lp.col_lower_, lp.col_upper_ = numpy.full(cols, -highspy.kHighsInf), numpy.full(cols, highspy.kHighsInf)
    lp.a_matrix_.format_ = highspy.MatrixFormat.kColwise
    lp.a_matrix_.start_, lp.a_matrix_.index_, lp.a_matrix_.value_ = start.astype("i4"), row.astype("i4"), value
    return lp


def solve(lp):
    highs = highspy.Highs()
    highs.setOptionValue("output_flag", False)
    highs.passModel(lp)
    begin = time.perf_counter()
    highs.run()
    seconds = time.perf_counter() - begin
    if highs.getModelStatus() != highspy.HighsModelStatus.kOptimal:
        return f"failed {highs.modelStatusToString(highs.getModelStatus())}"
    basic = sum(status == highspy.HighsBasisStatus.kBasic for status in highs.getBasis().row_status)
    return f"{lp.num_row_ - basic} {seconds:.9f}"


while len(size := array("u8", 3)) == 3:
    system = model(*map(int, size))
    answer = solve(system)
    # The first run loads libraries; a short one is repeated.
    if not answer.startswith("failed") and float(answer.split()[1]) < 0.25:
        answer = solve(system)
    print(answer, file=answers, flush=True)

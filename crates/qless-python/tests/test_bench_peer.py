"""HiGHS as `qless bench` runs it: `peers/highs.py` of qless-bench reads systems and writes their ranks."""

import pathlib
import subprocess
import sys

import numpy as np
import optional
import scipy.sparse as sp

optional.package("highspy")
PROGRAM = pathlib.Path(__file__).parents[2] / "qless-bench/peers/highs.py"


def test_highs_finds_the_rank_of_seeded_systems():
    matrices = []
    for seed in range(20):
        independent = sp.random(12, 30, 0.2, random_state=seed)
        matrices.append(sp.csc_array(sp.vstack([independent, sp.random(4, 12, 0.3, random_state=seed) @ independent])))
    sent = b""
    for c in matrices:
        sent += np.array([*c.shape, c.nnz, *c.indptr], "u8").tobytes() + c.indices.astype("u4").tobytes() + c.data.tobytes()
    found = subprocess.run([sys.executable, PROGRAM], input=sent, capture_output=True, check=True).stdout.split(b"\n")
    assert [int(line.split()[0]) for line in found if line] == [np.linalg.matrix_rank(c.toarray()) for c in matrices]

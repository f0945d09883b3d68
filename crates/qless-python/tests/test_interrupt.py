"""Ctrl-C ends a long call; other threads run during it."""

import os
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import scipy.sparse as sp

import qless

#: Random rows without structure: presolve takes none of them, and the factorization takes seconds.
LONG = """
import numpy as np, scipy.sparse as sp, qless, sys
C = sp.random_array((6000, 7000), density=2e-3, rng=np.random.default_rng(0)).tocsr()
print("go", flush=True)
try:
    qless.analyse(C)
except KeyboardInterrupt:
    print("stopped", flush=True)
    import os; os._exit(0)
print("done", flush=True)
"""


def test_ctrl_c_stops_an_analysis():
    # A shell ignores Ctrl-C in what it runs in the background, and its children inherit that.
    heed = lambda: signal.signal(signal.SIGINT, signal.SIG_DFL)  # noqa: E731
    with subprocess.Popen([sys.executable, "-c", LONG], stdout=subprocess.PIPE, text=True, preexec_fn=heed) as process:
        assert process.stdout is not None and process.stdout.readline() == "go\n"
        time.sleep(0.5)
        os.kill(process.pid, signal.SIGINT)
        # Not "done": the analysis takes much longer than the wait.
        assert process.stdout.read() == "stopped\n"
    assert process.returncode == 0


def test_other_threads_run_during_an_analysis():
    C = sp.random_array((1500, 2000), density=1e-2, rng=np.random.default_rng(0)).tocsr()
    thread = threading.Thread(target=lambda: qless.analyse(C))
    thread.start()
    count = 0
    while thread.is_alive():
        count += 1
        time.sleep(0.001)
    assert count > 3

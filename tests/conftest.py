"""Settings for all tests."""

import os

# Set before numba is imported: the thread pools of parallel test workers would compete for the same cores.
os.environ.setdefault("NUMBA_NUM_THREADS", "1")
# A thread that waits must not keep a core from the other one, or from another test.
os.environ.setdefault("OMP_WAIT_POLICY", "passive")

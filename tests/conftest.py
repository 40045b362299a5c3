"""Settings that hold for all tests."""

import os

# Before numba is imported: workers with a pool of threads each take turns at the cores while they wait for each other.
os.environ.setdefault("NUMBA_NUM_THREADS", "1")

"""Settings for all tests."""

import os

# Set before numba is imported: the thread pools of parallel test workers would compete for the same cores.
os.environ.setdefault("NUMBA_NUM_THREADS", "1")

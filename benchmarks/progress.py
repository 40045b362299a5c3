"""Progress messages of benchmarks, apart from their results on stdout."""

import sys


def print_progress(text):
    print(text, file=sys.stderr, flush=True)

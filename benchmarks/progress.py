"""Progress messages of benchmarks on stderr, so that stdout contains only results."""

import sys


def print_progress(text):
    print(text, file=sys.stderr, flush=True)

"""The log of a job of the workflow: what it reported, its warnings, and why it failed."""

import logging
import sys
import traceback


def log_to(path: str) -> logging.Logger:
    """Write the messages, warnings and failure of this process to a file, and return the logger of simcore.

    The terminal shows warnings too. If the process fails on wrong input (ValueError or OSError), the terminal shows the
    message in one line instead of the traceback, which is in the file.
    """
    file = logging.FileHandler(path, mode="w", encoding="utf-8")
    terminal = logging.StreamHandler()
    terminal.setLevel(logging.WARNING)
    logging.basicConfig(format="%(message)s", handlers=[file, terminal], force=True)
    logging.captureWarnings(True)
    # The messages of other libraries, for instance on the fonts of a figure, do not concern the user.
    log = logging.getLogger("simcore")
    log.setLevel(logging.INFO)

    def report(kind, error, trace):
        file.stream.write("".join(traceback.format_exception(kind, error, trace)))
        file.flush()
        if issubclass(kind, ValueError | OSError):
            print(f"{error}\n(The traceback is in {path}.)", file=sys.stderr)
        else:
            traceback.print_exception(kind, error, trace)

    sys.excepthook = report
    return log

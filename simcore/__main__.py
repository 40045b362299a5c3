"""Command line: `python -m simcore COMMAND ...`; the commands are listed in simcore.commands."""

import argparse
import importlib
import os
import signal
import sys

from simcore.commands import COMMANDS


def main(arguments=None) -> int:
    """Run a command and return its exit status: 0 success; 1 the packing failed; 2 wrong input, with one line on it.

    The status is 141, as in a shell, if the reader of the output closes it early, such as `| head`.
    """
    options = _parser().parse_args(arguments)
    # Numba reads its number of threads when it is imported, and the variable must not change afterwards.
    if getattr(options, "threads", None) and "numba" not in sys.modules:
        os.environ.setdefault("NUMBA_NUM_THREADS", str(max(options.threads, 1)))
    try:
        status = options.run(options)
        sys.stdout.flush()
        return status
    except BrokenPipeError:
        # Otherwise Python reports an error at exit for the text that is still in the buffer.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 128 + signal.SIGPIPE
    except (ValueError, OSError) as error:
        print(f"simcore {options.command}: {error}", file=sys.stderr)
        return 2


def _parser():
    parser = argparse.ArgumentParser(prog="python -m simcore", description=__doc__)
    commands = parser.add_subparsers(dest="command", required=True)
    for name in COMMANDS:
        importlib.import_module(f"simcore.commands.{name}").add(commands)
    return parser


if __name__ == "__main__":
    sys.exit(main())

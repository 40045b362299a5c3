"""The command line, `scree COMMAND ...` or `python -m simcore COMMAND ...`; simcore.commands lists the commands."""

import argparse
import importlib
import os
import sys

from simcore.commands import COMMANDS

# Package that only some commands need: the extra of pyproject.toml that installs it.
EXTRAS = {
    "mpi4py": "mpi",
    "porespy": "pores",
    "openpnm": "pores",
}
BROKEN_PIPE, INTERRUPTED = 141, 130  # 128 + SIGPIPE, 128 + SIGINT


def main(arguments=None) -> int:
    """Run a command and return its exit status: 0 success; 1 the packing failed; 2 wrong input, with one line on it.

    As in a shell, it is 141 if the reader of the output closes it early, such as `| head`, and 130 after Ctrl-C.
    """
    called = os.path.basename(sys.argv[0])
    prog = "scree" if called in ("scree", "scree.exe") else "python -m simcore"
    try:
        options = command_parser(prog).parse_args(arguments)
    except BrokenPipeError:
        return _broken_pipe()
    # Numba reads its number of threads when it is imported, and the variable must not change afterwards.
    if getattr(options, "threads", None) and "numba" not in sys.modules:
        os.environ.setdefault("NUMBA_NUM_THREADS", str(max(options.threads, 1)))
    try:
        status = options.run(options)
        sys.stdout.flush()
        return status
    except BrokenPipeError:
        return _broken_pipe()
    except ImportError as error:
        missing = (error.name or "").partition(".")[0]
        if missing not in EXTRAS:
            raise
        print(
            f"scree {options.command}: this needs the package {missing}, which is not installed; install it with: "
            f"pip install '.[{EXTRAS[missing]}]' in the folder of Scree",
            file=sys.stderr,
        )
        return 2
    except (ValueError, OSError) as error:
        print(f"scree {options.command}: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print(f"scree {options.command}: interrupted; the same command starts again", file=sys.stderr)
        return INTERRUPTED


def _broken_pipe():
    """Return the exit status. Otherwise Python reports an error at exit for the text that is still in the buffer."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    return BROKEN_PIPE


def command_parser(prog: str) -> argparse.ArgumentParser:
    """Return the parser of all commands. prog: how the program was called, for its messages."""
    parser = argparse.ArgumentParser(prog=prog, description="Porosity of gravel beds from the form of the grains.")
    parser.add_argument("--version", action=_Version, help="print the version and a digest of the code, and exit")
    parser.add_argument(
        "--print-completion",
        action=_Completion,
        choices=("bash", "zsh", "tcsh"),
        help="print a script that completes commands and options in a shell, and exit",
    )
    commands = parser.add_subparsers(dest="command", required=True)
    for name in COMMANDS:
        importlib.import_module(f"simcore.commands.{name}").add(commands)
    return parser


class _Version(argparse.Action):
    """Prints the version, the digest of the code and, in a clone, its commit, as files of packings have them."""

    def __init__(self, option_strings, dest, help):
        super().__init__(option_strings, dest, nargs=0, help=help)

    def __call__(self, parser, namespace, values, option_string=None):
        from simcore.packing.file import code_version

        print(f"scree {code_version()}")
        parser.exit()


class _Completion(argparse.Action):
    """Prints the completion script of a shell, made by shtab."""

    def __call__(self, parser, namespace, values, option_string=None):
        import shtab

        parser.prog = "scree"
        print(shtab.complete(parser, values), flush=True)
        parser.exit()


if __name__ == "__main__":
    sys.exit(main())

"""Two hundred random inputs, with and without faults: each must get a right answer or a clear refusal.

    python -m benchmarks.correctness.inputs [--seed 1] [--number 200]

Half of the inputs are tables of measured grains for `predict`, half are specifications for `explain`. Some are right,
the others have one to three faults. Each must end with exit status 0 and a physical answer that an independent reader
of the file confirms, or with status 2 and one line that explains the error. An input without a fault must be answered;
one that can only be misread must be refused. A traceback, a warning of a library, another exit status, or an input that
takes longer than --patience is a failure: it is printed with its file, and the exit status is 1.
"""

import argparse
import collections
import contextlib
import io
import random
import re
import resource
import signal
import sys
import tempfile
import traceback
import warnings
from pathlib import Path
from typing import NamedTuple

from benchmarks.correctness import input_specifications, input_tables
from benchmarks.correctness.input_tables import Contradiction

MEMORY = 12 * 2**30  # limit of the address space [bytes]; an input that needs more fails


class Input(NamedTuple):
    """An input and the expected result.

    verdict: "answer", "refuse" or "either". confirm(output): raises Contradiction if the output is wrong.
    """

    arguments: list
    path: Path
    faults: list
    verdict: str
    confirm: object


class Ended(NamedTuple):
    """How a command ended: its exit status, None if it raised an exception, and what it printed."""

    status: int | None
    output: str
    errors: str


class OutOfTime(BaseException):
    """A command took too long. It is no Exception, so that the program does not handle it as an error of its own."""


def draw_input(seed, number, folder):
    """Write input `number` of a seed into `folder` and return it; even numbers are tables, odd ones specifications."""
    rng = random.Random(f"{seed} {number}")
    if number % 2 == 0:
        arguments, path, layout, faults, verdict = input_tables.draw_table(rng, folder, number)
        return Input(arguments, path, faults, verdict, lambda output: input_tables.confirm(path, layout, output))
    arguments, path, faults, verdict = input_specifications.draw_specification(rng, folder, number)
    return Input(arguments, path, faults, verdict, lambda output: input_specifications.confirm(path, output))


def run(arguments, patience):
    """Run a command of simcore in this process and return how it Ended; patience: maximum time [s]."""
    from simcore.__main__ import main as simcore

    def stop(*_):
        raise OutOfTime(f"it takes longer than {patience} s")

    output, errors, status = io.StringIO(), io.StringIO(), None
    before = signal.signal(signal.SIGALRM, stop)
    try:
        with contextlib.redirect_stdout(output), contextlib.redirect_stderr(errors), warnings.catch_warnings():
            warnings.simplefilter("always")
            signal.alarm(patience)
            try:
                status = simcore(arguments)
            finally:
                signal.alarm(0)
    except SystemExit as end:  # raised by argparse
        status = end.code
    except (Exception, OutOfTime):
        errors.write(traceback.format_exc())
    finally:
        signal.signal(signal.SIGALRM, before)
    return Ended(status, output.getvalue(), errors.getvalue())


def judge(tried, ended):
    """Return what is wrong with how an input ended, as text; empty if nothing is."""
    errors = ended.errors.strip()
    if ended.status is None:
        return errors.splitlines()[-1]
    if "Warning:" in errors or "Traceback" in errors:
        return f"a warning or traceback: {errors}"
    if ended.status == 2:
        if len(errors.splitlines()) != 1 or ended.output.strip():
            return f"refused with {len(errors.splitlines())} lines and {len(ended.output)} characters of output"
        return "an input without fault is refused" if tried.verdict == "answer" else ""
    if ended.status != 0:
        return f"exit status {ended.status}"
    if tried.verdict == "refuse":
        return "an input that can only be misread is answered"
    try:
        tried.confirm(ended.output)
    except Contradiction as error:
        return f"the reader contradicts: {error}"
    return ""


def try_inputs(seed, number, folder, patience=60):
    """Run `number` inputs of a seed; return a list of (Input, Ended, what is wrong)."""
    tried = []
    for i in range(number):
        given = draw_input(seed, i, folder)
        ended = run(given.arguments, patience)
        tried.append((given, ended, judge(given, ended)))
        if tried[-1][2]:
            describe_failure(*tried[-1])
    return tried


def describe_failure(given, ended, wrong):
    """Print an input that failed, with its file and its output."""
    print(f"\nFAILURE {' '.join(given.arguments)}\n  faults: {', '.join(given.faults) or 'none'}; {given.verdict}")
    print(
        f"  {wrong}\n  status {ended.status}; {ended.errors.strip()[-1500:]}\n  {given.path.read_bytes()[:1500]}",
        flush=True,
    )


def summarise(tried):
    """Return the lines of the summary: numbers of answered and refused inputs and failures, and kinds of refusals."""
    answered = sum(ended.status == 0 for _, ended, _ in tried)
    refused = [(given, ended) for given, ended, _ in tried if ended.status == 2]
    reasons = collections.Counter(kind_of_refusal(given, ended) for given, ended in refused)
    failures = sum(bool(wrong) for *_, wrong in tried)
    lines = [f"{len(tried)} inputs: {answered} answered, {len(refused)} refused, {failures} failures"]
    return lines + [f"  {number:3} {reason}" for reason, number in reasons.most_common()]


def kind_of_refusal(given, ended):
    """Return the command and the first words of a message, without file, row and values."""
    text = ended.errors.strip().replace(str(given.path), "").split(":", 1)[-1].lstrip(" :,")
    text = re.sub(r"^(row|line) \d+: ", "", text)
    text = re.sub(r"'[^']*'|\[.*?\]|(?<!\w)[-+]?\d[\d.e+-]*", "...", text)
    return f"{given.arguments[0]}: {' '.join(text.split()[:4])}"


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--number", type=int, default=200)
    parser.add_argument("--patience", type=int, default=60, help="time that an input may take [s]")
    parser.add_argument("--folder", type=Path, help="folder that keeps the inputs; by default they are deleted")
    options = parser.parse_args(arguments)
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, resource.RLIM_INFINITY))
    with tempfile.TemporaryDirectory(prefix="scree-inputs-") as temporary:
        folder = options.folder or Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        tried = try_inputs(options.seed, options.number, folder, options.patience)
    print("\n".join(summarise(tried)))
    return 1 if any(wrong for *_, wrong in tried) else 0


if __name__ == "__main__":
    sys.exit(main())

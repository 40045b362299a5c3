"""Runs the code blocks of a Markdown page in a folder, and compares what they print with what the page shows.

    ```bash      runs in the folder, one block after the other
    ```python    runs in one namespace for the whole page
    ```yaml      (or python) whose first line is a comment with a file name, `# bed.yaml`: is written to this file
    ```text      after a block that ran: each of its lines must be printed, in this order; "..." leaves out lines

A table whose first line is such a comment, in a ```csv block, is written without that line. A comment before a block
changes what happens: `<!-- test: fails -->`, the command must fail; `<!-- test: within 10 % -->`, before shown text:
numbers may differ by this share, since packings differ between processors, and their errors (after ±) by a factor of
three; errors and intervals of differences over seeds are not compared; `<!-- test: dry run -->`, Snakemake only plans;
`<!-- test: not run, REASON -->`.
"""

import contextlib
import io
import os
import re
import subprocess
import sys
from typing import NamedTuple

from simcore.paths import ROOT
from tests.helpers.workplace import Workplace

_FENCE = re.compile(r"```(\w*)$")
_MARK = re.compile(r"<!-- test: (.*) -->$")
_FILE = re.compile(r"# ([\w/]+\.(?:yaml|py|csv))$")
_NUMBER = re.compile(r"[-+−]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")
_ERROR = re.compile(r"± ?(\d+(?:\.\d+)?)")
# The interval of a difference, "−0.01 to +0.03", which few packings know only within a factor
_INTERVAL = re.compile(r"[+−]\d+(?:\.\d+)? to [+−]\d+(?:\.\d+)?")


class Block(NamedTuple):
    """A code block of a page."""

    language: str
    content: str
    mark: str  # of the comment before it, "" if there is none
    line: int  # of its fence


def blocks_of(text):
    """Return the code blocks of a page, a list of `Block`."""
    blocks, mark, open_block = [], "", None
    for number, line in enumerate(text.splitlines(), start=1):
        if open_block is not None:
            if line == "```":
                language, start, lines, its_mark = open_block
                blocks.append(Block(language, "\n".join(lines) + "\n", its_mark, start))
                open_block = None
            else:
                open_block[2].append(line)
        elif fence := _FENCE.match(line):
            open_block, mark = (fence[1], number, [], mark), ""
        elif found := _MARK.match(line):
            mark = found[1]
        elif line.strip():
            mark = ""
    assert open_block is None, f"the block of line {open_block[1]} has no end"
    return blocks


def difference(shown, printed, share=0.0):
    """Return the first shown line that is not printed after the lines before it, or None; share: error of numbers."""
    rest = iter(printed.splitlines())
    for line in shown.splitlines():
        if line.strip() not in ("...", "") and not any(_same(line, other, share) for other in rest):
            return line
    return None


def _same(line, other, share):
    if share == 0.0:
        return line.rstrip() == other.rstrip()
    errors, other_errors = ([float(n) for n in _ERROR.findall(text)] for text in (line, other))
    if not _INTERVAL.search(line) and not all(
        a <= 3.0 * b and b <= 3.0 * a for a, b in zip(errors, other_errors, strict=False)
    ):
        return False
    line, other = (_INTERVAL.sub("interval", _ERROR.sub("error", text)) for text in (line, other))
    ours, theirs = ([float(n.replace("−", "-")) for n in _NUMBER.findall(text)] for text in (line, other))
    words, other_words = (_NUMBER.sub("#", text).split() for text in (line, other))
    close = all(abs(a - b) <= share * max(abs(a), abs(b)) for a, b in zip(ours, theirs, strict=False))
    return words == other_words and len(ours) == len(theirs) and close


class PageRun:
    """Runs the blocks of a page in an empty folder that has links to the files of the project."""

    def __init__(self, folder):
        self.folder = folder
        Workplace(folder)
        (folder / "examples").symlink_to(ROOT / "examples")
        programs = folder / ".programs"
        programs.mkdir()
        for name, words in {"scree": "-m simcore", "python": "", "snakemake": "-m snakemake --nocolor"}.items():
            (programs / name).write_text(f'#!/bin/sh\nexec "{sys.executable}" {words} "$@"\n')
            (programs / name).chmod(0o755)
        path = f"{programs}:{os.path.dirname(sys.executable)}:{os.environ['PATH']}"
        python_path = os.pathsep.join(filter(None, [str(ROOT), os.environ.get("PYTHONPATH")]))
        self.environment = {**os.environ, "PATH": path, "PYTHONPATH": python_path, "COLUMNS": "120"}
        self.names, self.printed = {}, None

    def run(self, text):
        """Run all blocks of a page; AssertionError with the line of the page where something differs."""
        for block in blocks_of(text):
            place = f"line {block.line}"
            file = _FILE.match(block.content.splitlines()[0]) if block.content else None
            if block.mark.startswith("not run"):
                self.printed = None
            elif block.language in ("yaml", "python", "csv") and file:
                path = self.folder / file[1]
                path.parent.mkdir(parents=True, exist_ok=True)
                content = block.content.partition("\n")[2] if block.language == "csv" else block.content
                path.write_text(content, encoding="utf-8")
            elif block.language == "bash":
                self._shell(block, place)
            elif block.language == "python":
                printed = io.StringIO()
                with contextlib.redirect_stdout(printed):
                    exec(compile(block.content, place, "exec"), self.names)
                self.printed = printed.getvalue()
            elif block.language == "text" and self.printed is not None:
                share = re.match(r"within (\d+) %", block.mark)
                missing = difference(block.content, self.printed, float(share[1]) / 100 if share else 0.0)
                assert missing is None, f"{place}: not printed: {missing}\nprinted:\n{self.printed}"

    def _shell(self, block, place):
        content = (
            re.sub(r"^snakemake ", "snakemake -n ", block.content, flags=re.M)
            if block.mark == "dry run"
            else block.content
        )
        done = subprocess.run(
            ["bash", "-euo", "pipefail", "-c", content],
            cwd=self.folder,
            env=self.environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        self.printed = done.stdout
        assert (done.returncode != 0) == (block.mark == "fails"), f"{place}: exit {done.returncode}\n{done.stdout}"

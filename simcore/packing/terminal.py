"""Progress of a packing for the person in front of it: a bar in a terminal, a line in a log."""

import atexit
import sys
from contextlib import suppress
from pathlib import Path

from simcore.packing.cost import estimate
from simcore.packing.outlook import duration_text, outlook, parse_progress


def reporter(log: Path | None = None, stream=None):
    """Return a function report(line) for a packing; stream: where lines go, None: stderr.

    Each line is printed and, if `log` is a path, added to this file, which is emptied first. If the stream is a
    terminal and rich is installed, progress lines move a bar there instead of being printed.
    """
    stream = sys.stderr if stream is None else stream
    if log is not None:
        log.parent.mkdir(parents=True, exist_ok=True)
        log.write_text("")
    return _Reporter(log, _bar(stream) if stream.isatty() else None, stream)


def expect(report, specification: dict) -> None:
    """Set the length of the bar of a reporter to the estimated duration of a packing, if it has a bar.

    specification: resolved; if its cost cannot be estimated, the bar has no length, and `pack` reports the error.
    """
    if getattr(report, "bar", None) is not None:
        with suppress(ValueError):
            report.cost = estimate(specification)


class _Reporter:
    def __init__(self, log, bar, stream):
        self.log, self.bar, self.stream = log, bar, stream
        self.cost = None

    def __call__(self, line):
        if self.log is not None:
            try:
                with self.log.open("a") as file:
                    print(line, file=file)
            except OSError as error:  # a packing is worth more than its log
                unwritten, self.log = self.log, None
                self(f"{unwritten} cannot be written ({error.strerror}); the lines that follow are missing in it")
        if self.bar is None:
            print(line, file=self.stream, flush=True)
            return
        progress = parse_progress(line)
        if progress is None:
            self.bar.write(line)
        else:
            self.bar.move(progress, outlook(progress, self.cost))


class _Bar:
    """A bar at the end of the terminal, drawn only when a line arrives, so that no thread runs beside the packing."""

    def __init__(self, rich_progress, rich_console, stream):
        console = rich_console.Console(file=stream, highlight=False)
        columns = [
            rich_progress.TextColumn("{task.description}"),
            rich_progress.BarColumn(),
            rich_progress.TextColumn("{task.fields[about]}"),
        ]
        self.progress = rich_progress.Progress(*columns, console=console, auto_refresh=False, transient=True)
        self.task = None
        atexit.register(self.progress.stop)  # the cursor is hidden while there is a bar

    def move(self, line, ahead):
        has_share = ahead.share == ahead.share
        share = f"{100.0 * ahead.share:3.0f} %, about {duration_text(ahead.left)} left, " if has_share else ""
        about = f"{share}{line.grains} grains, {line.rate:.0f} steps/s"
        description = f"{line.name}: {line.phase}"
        if self.task is None:
            self.progress.start()
            self.task = self.progress.add_task(description, total=1.0 if has_share else None, about=about)
        done = ahead.share if has_share else None
        self.progress.update(self.task, description=description, completed=done, about=about, refresh=True)

    def write(self, line):
        self.progress.console.print(line, markup=False, soft_wrap=True)


def _bar(stream):
    """Return a _Bar, or None without rich: then lines are printed."""
    try:
        import rich.console
        import rich.progress
    except ImportError:
        return None
    return _Bar(rich.progress, rich.console, stream)

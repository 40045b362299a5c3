"""Reading of options and paths that several commands have."""

import math
from pathlib import Path

FIGURES = (".png", ".pdf", ".svg")  # suffixes of figures


def length(option: str, text: str | None) -> float | None:
    """Return the length [m] of an option, given as a number of metres or as a quantity such as "8 mm"; None if absent.

    option: its name, for the message. ValueError unless the length is more than 0.
    """
    from simcore.scene.quantity import parse_quantity

    if text is None:
        return None
    try:
        metres = float(text)
    except ValueError:
        try:
            metres = parse_quantity(text, "m")
        except ValueError as error:
            raise ValueError(f"{option}: {error}") from None
    if not 0.0 < metres < math.inf:
        raise ValueError(f"{option}: {text!r} is not a length above 0; give one such as '8 mm'")
    return metres


def check_writable(output: Path, *inputs, endings=()) -> None:
    """Raise OSError if the output cannot be written, before any work is done.

    inputs: files that the command reads, or None. ValueError if the output is one of them, because it would be lost, or
    if its name ends in none of the `endings`, such as .yaml.
    """
    for read in inputs:
        if read is not None and output.exists() and Path(read).exists() and output.samefile(read):
            raise ValueError(f"{output} is read by this command, and writing to it would destroy it; give another path")
    if endings and output.suffix.lower() not in endings:
        raise ValueError(f"{output} must end in {' or '.join(endings)}; give another name")
    if output.is_dir():
        raise ValueError(f"{output} is a folder; give the name of a file in it")
    probe = output.with_name(output.name + ".part")
    try:
        output.parent.mkdir(parents=True, exist_ok=True)
        probe.touch()
        probe.unlink()
    except OSError as error:
        raise OSError(f"{output} cannot be written ({error.strerror}): {error.filename}; give another path") from None


YAML = (".yaml", ".yml")  # endings of a specification


def check_figure(option: str, figure: Path) -> None:
    """Raise ValueError unless the file of an option has the name of a figure, and OSError if it cannot be written."""
    if figure.suffix.lower() not in FIGURES:
        raise ValueError(f"{option}: {figure} must end in {', '.join(FIGURES[:-1])} or {FIGURES[-1]}")
    check_writable(figure)


def reporter(log: Path | None):
    """Return the function that shows a line, see simcore.packing.terminal.reporter. log: file that gets it as well."""
    from simcore.packing import terminal

    return terminal.reporter(log)

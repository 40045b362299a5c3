"""Reading of options and paths that several commands have."""

import math
import re
import tempfile
from pathlib import Path

FIGURES = (".png", ".pdf", ".svg")  # suffixes of figures
_DECIMAL_COMMA = re.compile(r"^(\s*(?:0|\d+(?!,\d{3}(?!\d)))),(?=\d)")  # not the comma of 1,000


def length(option: str, text: str | None, example: str = "8 mm", metres: bool = True) -> float | None:
    """Return the length [m] of an option, given as a quantity such as "8 mm"; None if absent.

    option: its name, and example: a quantity, for the message. metres: whether a number without a unit is in metres;
    otherwise it is refused. The number may have a decimal comma; 1,000 is refused, because it may mean 1000. ValueError
    unless the length is more than 0.
    """
    return _positive(option, text, "m", f"a length above 0; give one such as '{example}'", metres)


def cut_length(text: str | None) -> float | None:
    """Return the length [m] of the option --cut, as `length`, but it may be 0."""
    return _positive("--cut", text, "m", "a length of at least 0; give one such as '8 mm'", True, least=0.0)


def grain_size(option: str, text: str | None) -> float | None:
    """Return the size [m] of an option for the ends of a sieve curve, as `length`, but only with a unit."""
    return length(option, text, "90 mm", metres=False)


def duration(option: str, text: str | None) -> float | None:
    """Return the time [s] of an option, given as a quantity such as "0.1 s"; None if absent.

    option: its name, for the message. ValueError unless the time is more than 0.
    """
    return _positive(option, text, "s", "a time above 0; give one such as '0.1 s'")


def _positive(option, text, unit, needed, bare=False, least=None):
    """Return the quantity of an option in the SI unit `unit`, or None if it is not given.

    needed: what it is to be, for the message. bare: whether a number without a unit is in this unit. least: smallest
    value; None: it must be more than 0.
    """
    from simcore.scene.quantity import NUMBER, parse_quantity

    if text is None:
        return None
    if not bare and re.fullmatch(NUMBER, text.strip()):
        raise ValueError(f"{option}: '{text}' has no unit; {needed.partition('; ')[2]}")
    plain = _DECIMAL_COMMA.sub(r"\1.", text)
    try:
        value = float(plain) if bare and re.fullmatch(NUMBER, plain) else parse_quantity(plain, unit)
    except ValueError as error:
        raise ValueError(f"{option}: {str(error).replace(plain, text, 1)}") from None
    if not (0.0 < value if least is None else least <= value) or not value < math.inf:
        raise ValueError(f"{option}: '{text}' is not {needed}")
    return value


def check_writable(output: Path, *inputs, endings=(), is_replaced=True) -> None:
    """Raise OSError if the output cannot be written, before any work is done.

    inputs: files that the command reads, or None. ValueError if the output is one of them, because it would be lost, or
    if its name ends in none of the `endings`, such as .yaml. is_replaced: whether the file is written beside the output
    and then replaces it, which would destroy a device or a pipe.
    """
    for read in inputs:
        if read is not None and output.exists() and Path(read).exists() and output.samefile(read):
            raise ValueError(f"{output} is read by this command, and writing to it would destroy it; give another path")
    if endings and output.suffix.lower() not in endings:
        raise ValueError(f"{output} must end in {' or '.join(endings)}; give another name")
    if output.is_dir():
        raise ValueError(f"{output} is a folder; give the name of a file in it")
    if is_replaced and output.exists() and not output.is_file():
        raise ValueError(f"{output} is a device or a pipe, and not a file; give another path")
    try:
        output.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.NamedTemporaryFile(dir=output.parent, prefix=output.name):
            pass
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

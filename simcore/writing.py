"""Writes files whole: a file that cannot be completed does not take the place of the former one."""

import os
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def whole_file(path):
    """Yield the path of a file to write, `path` with .part at its end, which becomes `path` when the block ends.

    If the block fails, the part is removed and `path` is as before. OSError, which names `path`, if it cannot be
    written; a RuntimeError counts as one, because the netCDF library raises it on a full disk. A symbolic link remains.
    """
    file = Path(path).resolve()
    part = file.with_name(file.name + ".part")
    try:
        yield part
        os.replace(part, file)
    except (OSError, RuntimeError) as error:
        if not file.parent.is_dir():
            raise OSError(f"{path} cannot be written: the folder {file.parent} does not exist; make it first") from None
        refused = isinstance(error, FileNotFoundError | PermissionError | IsADirectoryError | NotADirectoryError)
        remedy = "Check the folder and your rights in it." if refused else "Check that there is free space on its disk."
        raise OSError(f"{path} cannot be written ({error}). {remedy}") from error
    finally:
        part.unlink(missing_ok=True)

"""Writes files whole: a file that cannot be completed does not take the place of the former one."""

import os
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def whole_file(path):
    """Yield the path of a file to write, `path` with .part at its end, which becomes `path` when the block ends.

    If the block fails, the part is removed and `path` is as before. OSError, which names `path`, if it cannot be
    written; a RuntimeError counts as one, because the netCDF library raises it on a full disk.
    """
    path = Path(path)
    part = path.with_name(path.name + ".part")
    try:
        yield part
        os.replace(part, path)
    except (OSError, RuntimeError) as error:
        raise OSError(f"{path} cannot be written ({error}). Check that there is free space on its disk.") from error
    finally:
        part.unlink(missing_ok=True)

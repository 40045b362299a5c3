"""What a run must share with a checkpoint to go on from it: the key of its scene and the version of the code."""

import hashlib
import json
from collections.abc import Iterable

import numpy as np

from simcore import __version__
from simcore.compilation import source_digest
from simcore.provenance.digest import digest
from simcore.scene.identity import deciding_bits

DRAWN = 1000  # grains whose draw is part of the key: it depends on files that the specification only names


def packing_key(specification: dict, setup) -> str:
    """Key of a packing's checkpoints; see `scene_key`."""
    scene = setup.scene
    return scene_key(specification, setup.bases, setup.draw(np.arange(min(DRAWN, scene.amount_grains or DRAWN))))


def checkpoint_code() -> str:
    """Version of the code that packs, and of its arithmetic: the same for a checkpoint and who goes on from it.

    Call it before a run starts: it then names the code that runs, even where files are changed meanwhile.
    """
    packing = digest(
        "simcore/scene/setup.py",
        "simcore/packing/process.py",
        "simcore/dem/ranks/many_ranks.py",
        "simcore/grains/sources.py",
        "config/cases.tsv",
    )
    return f"{__version__}+{source_digest()}+{packing}+numpy{np.__version__}"


def scene_key(specification: dict, bases: Iterable, drawn: Iterable = ()) -> str:
    """Digest (16 hex digits) of what decides the bits of a packing, but for the code.

    specification: resolved; of its keys those count that decide the bits, in any order. bases: the base
    shapes (simcore.dem.shapes.hulls.Base), in their order. drawn: arrays that tell what neither shows, such as the Draw
    of the first grains: the forms of ellipsoids come from files of which the specification has the path alone, and the
    sieve curve of a case from a table.
    """
    bases = list(bases)
    told = [deciding_bits(specification), [base.name for base in bases]]
    total = hashlib.sha256(json.dumps(told, sort_keys=True).encode())
    arrays = []
    for base in bases:
        arrays += [np.asarray(part, np.float64) for part in (base.vertices, base.volume, base.second_moments)]
        arrays.append(np.asarray(base.faces, np.int64))
    for array in [*arrays, *map(np.asarray, drawn)]:
        # Type and shape first: they say where the array ends
        total.update(f"\n{array.dtype} {array.shape} ".encode() + array.tobytes())
    return total.hexdigest()[:16]

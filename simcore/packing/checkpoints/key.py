"""What a run and a checkpoint must have in common: the key of the scene and the version of the code."""

import hashlib
import json
from collections.abc import Iterable

import numpy as np

from simcore.compilation import source_digest
from simcore.provenance.digest import digest
from simcore.scene.identity import deciding_bits

# Checkpoints of version 0.1.0 begin with its number. The digests decide, so that later versions keep it.
FIRST_VERSION = "0.1.0"
DRAWN = 1000  # grains whose draw is part of the key, since it depends on files that the specification only names


def packing_key(specification: dict, setup) -> str:
    """Return the key of a packing's checkpoints; see `scene_key`."""
    scene = setup.scene
    return scene_key(specification, setup.bases, setup.draw(np.arange(min(DRAWN, scene.amount_grains or DRAWN))))


def checkpoint_code() -> str:
    """Return the digests of the code and the version of numpy; a run resumes only from checkpoints with the same.

    Call it before a run starts, so that it names the code that runs even if files are changed in the meantime.
    """
    packing = digest(
        "simcore/scene/setup.py",
        "simcore/packing/process.py",
        "simcore/dem/ranks/many_ranks.py",
        "simcore/grains/sources.py",
        "config/cases.tsv",
        "config/curves.tsv",
    )
    return f"{FIRST_VERSION}+{source_digest()}+{packing}+numpy{np.__version__}"


def scene_key(specification: dict, bases: Iterable, drawn: Iterable = ()) -> str:
    """Return a digest (16 hex digits) of everything except the code that determines the bits of a packing.

    specification: resolved; only the keys that affect the bits count, in any order. bases: the base shapes
    (simcore.scene.shapes.Base), in their order. drawn: arrays such as the Draw of the first grains. They cover what
    specification and bases do not contain: the forms of ellipsoids come from files of which the specification has only
    the path, and the sieve curve of a case comes from a table.
    """
    bases = list(bases)
    content = [deciding_bits(specification), [base.name for base in bases]]
    total = hashlib.sha256(json.dumps(content, sort_keys=True).encode())
    arrays = []
    for base in bases:
        arrays += [np.asarray(part, np.float64) for part in (base.vertices, base.volume, base.second_moments)]
        arrays.append(np.asarray(base.faces, np.int64))
    for array in [*arrays, *map(np.asarray, drawn)]:
        # Type and shape come first, so that different arrays cannot give the same bytes.
        total.update(f"\n{array.dtype} {array.shape} ".encode() + array.tobytes())
    return total.hexdigest()[:16]

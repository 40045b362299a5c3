"""The grains behind the group `grains` of a specification: synthetic, from files, or a set prepared before."""

import functools
import hashlib
import json
import re
from pathlib import Path

from simcore.grains.grain_set import read_attribute, read_grains
from simcore.grains.readers import UNITS, grain_files, read_grain_files
from simcore.grains.synthetic import synthetic_grains

# A hull that is this many times larger than its grain is warned of.
CONCAVE = 1.1


def source_files(grains):
    """Paths of the files or folders behind the resolved group `grains`; none if they are synthetic."""
    source = grains["source"]
    if source == "synthetic":
        return []
    return [source] if isinstance(source, str) else list(source)


def source_name(source):
    """Name of the grains of `source`: "synthetic", or the last part of their path, of several the first's."""
    first = source if isinstance(source, str) else source[0]
    return Path(first).name


def set_name(grains):
    """Name of the grain set of the resolved group `grains`, for a folder: its source's, and a digest of its content.

    The digest is of what decides the grains: number and seed of synthetic ones; unit, voxel spacing and the content of
    all files of others (hidden files of a folder do not count). So no two sets share a name, and files that were
    changed make another set.
    """
    return _set_name(json.dumps(grains, sort_keys=True))


@functools.cache
def _set_name(text):
    grains = json.loads(text)
    files = source_files(grains)
    decisive = ("unit", "voxel_spacing", "bodies") if files else ("number", "seed")
    content = json.dumps([grains[key] for key in decisive]) + content_digest(files)
    name = re.sub(r"[^A-Za-z0-9_.+-]", "", source_name(grains["source"])) or "grains"
    return f"{name}_{hashlib.sha256(content.encode()).hexdigest()[:8]}"


def check_source(grains):
    """ValueError if a file of the grains does not exist, or its unit is not stated."""
    for path in source_files(grains):
        if not Path(path).exists():
            raise ValueError(f"grains.source: '{path}' does not exist; give a file or folder, or synthetic")
        if grains["unit"] is None and Path(path).suffix != ".nc":
            raise ValueError("grains.unit is missing; say in which unit the files of grains are, m or mm")


def needs_grains(shapes):
    """Whether the resolved group `shapes` takes its forms from grains: meshes, and ellipsoids of their forms."""
    return shapes["kind"] in ("polyhedron", "mixed") or (
        shapes["kind"] == "ellipsoid" and shapes["choice"] in ("one", "random")
    )


def load_grains(grains):
    """List of Grain of the resolved group `grains` of a specification; ValueError names what is wrong where."""
    check_source(grains)
    files = source_files(grains)
    if not files:
        return synthetic_grains(seed=grains["seed"], n=grains["number"])
    if Path(files[0]).suffix == ".nc":
        if len(files) > 1:
            raise ValueError("grains.source: give one prepared grain set (.nc), not several")
        return read_grains(files[0])
    spacing = grains["voxel_spacing"]
    spacing = None if spacing is None else spacing / UNITS[grains["unit"]]
    return read_grain_files(files, grains["unit"], spacing, grains["bodies"])


def grain_warnings(grains, group=None):
    """What the user of grains should see before they are packed, a list of sentences; empty if there is nothing.

    grains: list of Grain. Concave grains, whose hulls are packed, are listed with their ratios above CONCAVE, then what
    was noted as each was read. group: the resolved group `grains` behind them; if it is given, the files of its folders
    that were left out are listed with their reasons.
    """
    warnings = []
    concave = sorted((grain for grain in grains if grain.hull_ratio > CONCAVE), key=lambda grain: -grain.hull_ratio)
    if concave:
        named = _some([f"{grain.name} {grain.hull_ratio:.2f}" for grain in concave])
        warnings.append(
            f"{len(concave)} of {len(grains)} grains are concave; their convex hulls are packed, which are larger than "
            f"the grains by these factors: {named}."
        )
    noted = {}
    for grain in grains:
        for note in grain.notes:
            noted.setdefault(note, []).append(grain.name)
    warnings += [f"grain{'s' if len(names) > 1 else ''} {_some(names)}: {note}." for note, names in noted.items()]
    left_out = left_out_files(group) if group is not None else []
    if left_out:
        warnings.append(f"{len(left_out)} files were left out: {_some(left_out, '; ')}.")
    return warnings


def size_note(grains, sizes):
    """A sentence on what becomes of the sizes that grains (list of Grain) have themselves; None if there are none.

    sizes: the resolved group `sizes`.
    """
    if not grains:
        return None
    low, high = (f(grain.sieve_size for grain in grains) * 1e3 for f in (min, max))
    of = f"The grains of the set have sieve sizes of {low:.3g} to {high:.3g} mm"
    if sizes["own"]:
        return f"{of}, which they keep."
    return f"{of}; they are scaled to the sizes drawn. `sizes: {{own: true}}` keeps their own."


def left_out_files(group):
    """`name: reason` of each file that was left out of the folders behind the resolved group `grains`."""
    files = source_files(group)
    if not all(Path(path).exists() for path in files) or not files:  # grains of other origin stand for them
        return []
    if Path(files[0]).suffix == ".nc":
        return (read_attribute(files[0], "left_out") or "").splitlines()
    return [f"{path.name}: {reason}" for path, reason in grain_files(files)[1].items()]


def _some(words, mark=", "):
    """The first ten words, and how many more there are."""
    return mark.join(words[:10]) + (f"{mark}and {len(words) - 10} more" if len(words) > 10 else "")


def content_digest(paths):
    """Digest (16 hex digits) of the names and contents of all grain files behind paths, of files and folders.

    It changes if a file is overwritten under the same name, added, renamed or removed; a missing one counts as empty.
    Each file is read once a process.
    """
    total = hashlib.sha256()
    for path in map(Path, paths):
        try:
            files = grain_files(path)[0]
        except ValueError:  # a folder without grains: the rule that reads it says so
            files = []
        for file in files:
            total.update(f"{file.name} {_file_digest(file)}\n".encode())
    return total.hexdigest()[:16]


def _file_digest(path):
    if not path.is_file():
        return ""
    stat = path.stat()
    return _read_digest(path, stat.st_mtime_ns, stat.st_size)


@functools.cache
def _read_digest(path, changed, size):
    """Digest of a file that was changed then and has this size, so that one written anew is read again."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()

"""Loads the grains of the group `grains` of a specification: synthetic, from files, or from a prepared set.

What reads grains is imported where it is used: each start of the workflow names the grains of its packings without
reading any, and would wait half a second for libraries of geometry.
"""

import functools
import hashlib
import json
import re
from pathlib import Path

from simcore.grains.text_lists import join_first

# There is a warning if the volume of a hull is more than this many times that of its grain.
CONCAVE = 1.1
NAMED = 10  # maximum number of grains and files that a warning names


def source_files(grains):
    """Return the paths of the files or folders of the resolved group `grains`; an empty list if they are synthetic."""
    source = grains["source"]
    if source == "synthetic":
        return []
    return [source] if isinstance(source, str) else list(source)


def source_name(source):
    """Return the name of the grains of `source`: "synthetic", or the last part of their (first) path."""
    path = source if isinstance(source, str) else source[0]
    return Path(path).name


def set_name(grains):
    """Return a name for the grain set of the resolved group `grains`, usable for a folder.

    It consists of the source's name and a digest of everything that determines the grains: number and seed of synthetic
    ones; unit, voxel spacing, treatment of several bodies, degree, names and the content of all grain files of others.
    So no two sets share a name, and changed files make another set.
    """
    return _set_name(json.dumps(grains, sort_keys=True))


@functools.cache
def _set_name(text):
    grains = json.loads(text)
    files = source_files(grains)
    decisive = ("unit", "voxel_spacing", "bodies") if files else ("number", "seed")
    # Sets that were named before these keys existed keep their names.
    added = {key: grains[key] for key in ("degree", "names") if files and grains[key] is not None}
    content = json.dumps([grains[key] for key in decisive] + ([added] if added else []))
    content += content_digest(files, grains["names"] if files else None)
    name = re.sub(r"[^A-Za-z0-9_.+-]", "", source_name(grains["source"])) or "grains"
    return f"{name}_{hashlib.sha256(content.encode()).hexdigest()[:8]}"


def check_source(grains):
    """Raise ValueError if a file of the grains does not exist, or its unit is not given."""
    for path in source_files(grains):
        if not Path(path).exists():
            raise ValueError(f"grains.source: '{path}' does not exist; give a file or folder, or synthetic")
        if grains["unit"] is None and Path(path).suffix != ".nc":
            raise ValueError("grains.unit is missing; give the unit of the files of grains, m or mm")


def synthetic_names(n):
    """Return the names of n synthetic grains, list of str."""
    width = max(2, len(str(n)))
    return [f"G{i + 1:0{width}}" for i in range(n)]


def known_names(grains):
    """Return the names of the grains of the resolved group `grains`, or None if only reading them would tell.

    Images, and files whose bodies are split, may have several grains; a prepared set has names of its own.
    """
    return _known_names(json.dumps(grains, sort_keys=True))


@functools.cache
def _known_names(text):
    grains = json.loads(text)
    sources = source_files(grains)
    if not sources:
        return synthetic_names(grains["number"])
    if grains["bodies"] == "split":
        return None
    from simcore.grains.readers import file_name, grain_files, select_files

    files = select_files(grain_files(sources)[0], grains["names"])
    if any(file.suffix.lower() in (".nc", ".npy", ".npz") for file in files):
        return None
    return [file_name(file) for file in files]


def needs_grains(shapes):
    """Return whether the resolved group `shapes` needs grains: polyhedra, and ellipsoids with the forms of grains."""
    return shapes["kind"] in ("polyhedron", "mixed") or (
        shapes["kind"] == "ellipsoid" and shapes["choice"] in ("one", "random")
    )


def load_grains(grains):
    """Return the list of Grain of the resolved group `grains` of a specification; ValueError names file and fault."""
    from simcore.grains.grain_set import read_grains
    from simcore.grains.readers import UNITS, read_grain_files
    from simcore.grains.synthetic import synthetic_grains

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
    return read_grain_files(files, grains["unit"], spacing, grains["bodies"], grains["degree"], grains["names"])


def grain_warnings(grains, group=None, kind="polyhedron"):
    """Return warnings about grains for the user before they are packed, a list of sentences, which may be empty.

    grains: list of Grain. The warnings list the concave grains, with hull ratios above CONCAVE, and the notes of each
    grain. group: the resolved group `grains`; if it is given, the files of its folders that were left out are listed as
    well, with the reasons. kind: of the shapes that are packed.
    """
    warnings = []
    concave = sorted((grain for grain in grains if grain.hull_ratio > CONCAVE), key=lambda grain: -grain.hull_ratio)
    if concave:
        ratios = join_first([f"{grain.name} {grain.hull_ratio:.2f}" for grain in concave], NAMED)
        verb = "is" if len(concave) == 1 else "are"
        what = "ellipsoids of their convex hulls" if kind == "ellipsoid" else "convex hulls"
        warnings.append(
            f"{len(concave)} of {len(grains)} grains {verb} concave; the {what} are packed. The hulls are larger than "
            f"the grains by these factors: {ratios}."
        )
    names_by_note = {}
    for grain in grains:
        for note in grain.notes:
            names_by_note.setdefault(note, []).append(grain.name)
    warnings += [
        f"grain{'s' if len(names) > 1 else ''} {join_first(names, NAMED)}: {note}."
        for note, names in names_by_note.items()
    ]
    left_out = left_out_files(group) if group is not None else []
    if left_out:
        files = "1 file was" if len(left_out) == 1 else f"{len(left_out)} files were"
        warnings.append(f"{files} left out: {join_first(left_out, NAMED, '; ')}.")
    return warnings


def size_note(grains, sizes, may_keep=True):
    """Return a sentence on whether the grains (list of Grain) keep their own sizes; None if there are no grains.

    sizes: the resolved group `sizes`. may_keep: whether shapes of this kind and choice could keep their sizes.
    """
    if not grains:
        return None
    low, high = (f(grain.sieve_size for grain in grains) * 1e3 for f in (min, max))
    several = f"to {high:.3g} " if high > low else ""
    own_sizes = f"The grains of the set have sieve sizes of {low:.3g} {several}mm"
    if sizes["own"]:
        return f"{own_sizes}, which they keep."
    keep = " `sizes: {own: true}` keeps their own sizes." if may_keep else ""
    return f"{own_sizes}; they are scaled to the sizes drawn.{keep}"


def left_out_files(group):
    """Return `name: reason` for each file that was left out of the folders of the resolved group `grains`.

    If the group names its files, the others were left out on purpose, and the list is empty.
    """
    from simcore.grains.grain_set import read_attribute
    from simcore.grains.readers import grain_files

    files = source_files(group)
    if group["names"] is not None:
        return []
    if not all(Path(path).exists() for path in files) or not files:  # the caller has the grains from elsewhere
        return []
    if Path(files[0]).suffix == ".nc":
        return (read_attribute(files[0], "left_out") or "").splitlines()
    return [f"{path.name}: {reason}" for path, reason in grain_files(files)[1].items()]


def content_digest(paths, names=None):
    """Return a digest (16 hex digits) of the names and contents of all grain files at paths of files and folders.

    names: names of the files, without extension, if only some of them are read.
    It changes if a file is overwritten, added, renamed or removed; a missing file counts as empty. Each file is read
    once per process.
    """
    total = hashlib.sha256()
    if not paths:
        return total.hexdigest()[:16]
    from simcore.grains.readers import file_name, grain_files

    for path in map(Path, paths):
        try:
            files = [file for file in grain_files(path)[0] if names is None or file_name(file) in names]
        except ValueError:  # a folder without grains; the rule that reads it raises the error
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
    """Return the digest of a file; time of change and size are arguments so that a rewritten file is read again."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()

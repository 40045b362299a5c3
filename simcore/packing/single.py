"""One packing from its specification to its dataset, on one rank or on many."""

from collections.abc import Callable
from os import PathLike

import numpy as np
import xarray as xr

from simcore.compilation import set_threads
from simcore.dem.from_scene import compose
from simcore.grains.sources import load_grains
from simcore.packing.cost import last_batch_is_whole
from simcore.packing.explanation import draw_batches
from simcore.packing.file import code_version, packing_dataset
from simcore.packing.forecast_text import check_setup, setup_warnings
from simcore.packing.process import pack as run_packing
from simcore.provenance.cpu_time import cpu_time
from simcore.scene.setup import Setup, set_up
from simcore.scene.specification import read_specification, resolve_written


def pack(
    specification: dict | str | PathLike,
    *,
    threads: int = 1,
    force: bool = False,
    report: Callable[[str], None] = lambda line: None,
) -> xr.Dataset:
    """Pack grains in this process and return the packing, the Dataset that `read_packing` returns too.

    specification: a nested dict with the keys of config/packing.schema.yaml, in which a quantity is text with its unit,
    such as "8 mm"; or the path of a YAML file with them. threads: of the process, also afterwards; they change no
    result. force: also pack a bed that is too low for its porosity to be evaluated. report(line): called with each line
    on the progress.

    The Dataset has one row per grain: position (n, 3) [m], orientation (n, 4), L, I, S and D [m], volume [m³]; and one
    row per contact: contact_body (c, 2), contact_point (c, 3) [m], contact_force (c, 3) [N]. `write_packing` writes it
    to a file. ValueError if the specification is wrong; PackingError if the packing fails, such as by gaining energy
    from nowhere.
    """
    if isinstance(specification, dict):
        specification = resolve_written(specification)
    elif isinstance(specification, str | PathLike):
        specification = read_specification(specification)
    else:
        kind = type(specification).__name__
        raise ValueError(f"the specification is of type {kind}; give a nested dict, or the path of a YAML file")
    code_version()  # names the code that runs, even if files are changed in the meantime
    setup, warned = prepare(specification, threads, force)
    for text in warned:
        report(f"{setup.scene.name}: warning: {text}")
    spent = cpu_time()
    packed = run_packing(setup.scene, setup.bases, setup.draw, report)
    return dataset_of(packed, specification, setup, warned, threads=threads, ranks=1, cpu_seconds=cpu_time() - spent)


def prepare(specification: dict, threads: int, force: bool, cut: float | None = None) -> tuple[Setup, list[str]]:
    """Return the Setup of a resolved specification and warnings about it; ValueError if it cannot be packed.

    threads: of this process, set here. force: also accept a bed that is too low for its porosity to be evaluated. cut
    [m]: with which it will be evaluated; None: that of `end_cuts`.
    """
    set_threads(threads)
    setup = set_up(specification, load_grains)
    compose(setup.scene)  # ValueError if its time step is too long for any bed
    sample = draw_batches(setup)[0] if last_batch_is_whole(setup.scene) else None
    if not force:
        check_setup(setup, sample, cut)
    return setup, setup_warnings(setup, sample, not force, cut)


def dataset_of(packed, specification: dict, setup: Setup, warned: list[str], **run) -> xr.Dataset:
    """Return the Dataset of a finished packing. warned: from `prepare`. run: attributes on how it was run."""
    return packing_dataset(
        setup.scene,
        setup.bases,
        packed,
        setup.sample(np.arange(len(packed.bodies.mass))),
        specification,
        setup.curve,
        largest_sieve_size=setup.curve.largest,
        warnings="\n".join([*warned, *packed.warnings]),
        **run,
    )

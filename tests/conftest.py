"""Fixtures that hand out the functions of tests/helpers."""

import os
from types import SimpleNamespace

import pytest

# Before numba is imported: workers with a pool of threads each take turns at the cores while they wait for each other.
os.environ.setdefault("NUMBA_NUM_THREADS", "1")


@pytest.fixture(scope="session")
def packings():
    """Functions that make packings and their parts."""
    from tests.helpers import packings

    return SimpleNamespace(
        make=packings.make_packing,
        orientations=packings.random_orientations,
        lattice=packings.lattice,
        touching=packings.touching_pairs,
        faces=packings.hull_faces,
        cube=packings.CUBE,
    )


@pytest.fixture(scope="session")
def core():
    """Hulls, pairs in a grid, and the signed distance of polyhedra by another way."""
    from tests.helpers.pairs import shared

    return shared()


@pytest.fixture(scope="session")
def stage():
    """A few bodies, stepped by the compiled step itself."""
    from simcore.dem.forces.spring_dashpot import contact_law
    from simcore.dem.shapes.hulls import ELLIPSOID, MIXED, POLYHEDRON, SPHERE
    from tests.helpers.stage import Stage

    return SimpleNamespace(
        Stage=Stage, law=contact_law, SPHERE=SPHERE, ELLIPSOID=ELLIPSOID, POLYHEDRON=POLYHEDRON, MIXED=MIXED
    )


@pytest.fixture(scope="session")
def extreme():
    """A few bodies placed by hand in a Process, watched over as a packing is."""
    from simcore.dem.shapes.hulls import ELLIPSOID, POLYHEDRON, SPHERE
    from tests.helpers import extremes

    return SimpleNamespace(
        scene=extremes.scene,
        place=extremes.place,
        run=extremes.run,
        energy=extremes.energy,
        floor_force=extremes.floor_force,
        overlap=extremes.overlap,
        hull=extremes.hull,
        box=extremes.box,
        specification=extremes.DEFAULT,
        SPHERE=SPHERE,
        ELLIPSOID=ELLIPSOID,
        POLYHEDRON=POLYHEDRON,
        FREE=extremes.FREE,
    )

"""A small version of the benchmark `equality`: all kinds of scenes, on threads and ranks, stopped and resumed."""

import numpy as np
import pytest

from benchmarks.correctness.equality import DISTURBED, RUNS, SCENES, launch, make
from simcore.packing.file import differences, read_packing

# Every scene is packed on two ranks in rows, on three or four ranks, and is stopped and resumed on another number. The
# benchmark packs all scenes in all ways, which takes minutes: more ranks than cores are slow, and so is compiling the
# parallel loops of two threads. Those of mixed grains find contacts of ellipsoids and of polyhedra, and those of a
# deposit contacts of spheres.
FEWER = {
    "ranks_1": ["mixed", "deposit"],
    "ranks_2": ["spheres", "ellipsoids_cylinder", "ellipsoids_potential"],
    "threads_2": ["mixed", "deposit"],
    "ranks_3": ["ellipsoids_cylinder", "ellipsoids_potential", "filled", "deposit"],
    "ranks_4": ["spheres", "polyhedra", "mixed"],
    "stopped_1_then_2": ["ellipsoids_cylinder", "polyhedra", "mixed"],
    "stopped_2_then_1": ["spheres", "ellipsoids_potential", "filled", "deposit"],
    "stopped_3_then_2_rows": ["polyhedra", "filled"],
}
TIMEOUT = 600  # [s], of one run of all scenes; they take seconds once compiled


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("equality")
    launch(RUNS["one"], folder / "one", SCENES, timeout=TIMEOUT)
    return folder


def packings(folder, name, scenes=SCENES):
    return {scene: read_packing(folder / name / f"{scene}.nc") for scene in scenes}


def test_the_scenes_have_all_there_is_to_get_wrong(folder):
    """Each scene has contacts and all three phases, and each periodic one has contacts through images."""
    for scene, packing in packings(folder, "one").items():
        assert len(packing["contact_overlap"]) > 40, scene
        assert set(packing["history_phase"].values) == {0, 1, 2}, scene
        if packing.attrs["domain_shape"] == "periodic":
            assert np.any(packing["contact_image"].values != 0), scene


@pytest.mark.parametrize("name", [name for name in RUNS if name not in ("one", "ranks_4_columns")])
def test_the_same_bits(folder, name):
    scenes = FEWER.get(name, SCENES)
    make(name, folder / name, scenes, timeout=TIMEOUT)
    first, second = packings(folder, "one"), packings(folder, name, scenes)
    assert {scene: differences(first[scene], second[scene]) for scene in scenes} == {scene: [] for scene in scenes}


def test_every_scene_is_packed_as_stated_above():
    of_ranks = {*FEWER["ranks_3"], *FEWER["ranks_4"]}
    stopped = {scene for name, scenes in FEWER.items() if RUNS[name].stop for scene in scenes}
    assert of_ranks == stopped == set(SCENES) and "ranks_2_rows" not in FEWER


def test_a_disturbed_order_is_noticed(folder):
    launch(DISTURBED, folder / "disturbed", ["spheres", "polyhedra"], timeout=TIMEOUT)
    for scene in ("spheres", "polyhedra"):
        disturbed = read_packing(folder / "disturbed" / f"{scene}.nc")
        text = differences(read_packing(folder / "one" / f"{scene}.nc"), disturbed)
        assert any(line.startswith("position: ") for line in text)

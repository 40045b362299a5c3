"""Evaluations that are not of the settings that a campaign has now are found, with the keys that differ."""

import copy
import json

import pytest
import xarray as xr

from simcore.campaign.evaluations import SETTINGS, grain_set_of, how_it_differs, settings_text
from simcore.scene.specification import resolve

PLANNED = resolve(
    {"domain": {"width": "50 mm", "height": "0.2 m"}, "amount": {"grains": 60}, "sizes": {"case": "U1"}, "seed": 2}
)
POROSITY = {"slice_height": None, "cut": 0.008}


def evaluation(specification, **attributes):
    """Return an evaluation, without results, of a packing of this specification."""
    return xr.Dataset(attrs={"scene": json.dumps(specification)} | attributes)


def changed(*path, value):
    """Return PLANNED with another value of a key."""
    specification = group = copy.deepcopy(PLANNED)
    for key in path[:-1]:
        group = group[key]
    group[path[-1]] = value
    return specification


def test_an_evaluation_of_the_planned_settings_does_not_differ():
    of_now = evaluation(PLANNED, **{SETTINGS: settings_text(POROSITY)})
    assert how_it_differs(of_now, PLANNED, POROSITY) == ""
    assert how_it_differs(evaluation(PLANNED), PLANNED, POROSITY) == "", "of an earlier version"
    assert how_it_differs(evaluation(changed("name", value="other")), PLANNED) == ""


@pytest.mark.parametrize(
    "specification, porosity, text",
    [
        (changed("material", "friction", value=0.9), POROSITY, "was packed with another value of material.friction"),
        (
            changed("grains", "source", value="results/a/grains/synthetic_12345678/faces_100.nc"),
            POROSITY,
            "was packed with another value of grains.source",
        ),
        (PLANNED, {**POROSITY, "cut": 0.005}, "was evaluated with another value of porosity.cut"),
    ],
)
def test_what_differs_is_named(specification, porosity, text):
    of_then = evaluation(specification, **{SETTINGS: settings_text(porosity)})
    assert how_it_differs(of_then, PLANNED, POROSITY) == text


def test_names_are_those_of_today_and_a_missing_key_is_null():
    region = changed("numerics", "polyhedron_contact", value="inflated")
    assert how_it_differs(evaluation(region), PLANNED) == "was packed with another value of numerics.polyhedron_contact"
    older = copy.deepcopy(PLANNED)
    assert older["generation"].pop("batch_interval") is None
    assert how_it_differs(evaluation(older), PLANNED) == ""


def test_a_cut_does_not_matter_in_a_cylinder():
    cylinder = changed("domain", "type", value="cylinder")
    of_then = evaluation(cylinder, **{SETTINGS: settings_text({**POROSITY, "cut": 0.005})})
    assert how_it_differs(of_then, cylinder, POROSITY) == ""


def test_other_grains_of_the_same_name_differ():
    first, second = (
        changed("grains", "source", value=f"results/a/grains/gravel_{digest}/faces_100.nc")
        for digest in ("12345678", "87654321")
    )
    moved = changed("grains", "source", value="elsewhere/grains/gravel_12345678/faces_100.nc")
    assert grain_set_of(first) == "gravel_12345678" and grain_set_of(PLANNED) == ""
    assert how_it_differs(evaluation(second), first) == "was packed with other grains"
    assert how_it_differs(evaluation(moved), first) == ""

"""Which packings are shown is decided by what a campaign plans."""

import pytest

from simcore.campaign.showpieces import corner_mixtures, showpieces
from simcore.campaign.studies import expand
from simcore.scene.specification import resolve

BOX = {"domain": {"width": "45 mm", "height": "0.4 m"}, "amount": {"grains": 300}}


@pytest.fixture
def campaign():
    """Return a campaign with cylinders of U1 and U3, boxes of one form and of many, and mixtures."""
    means = [(0.4, 0.6), (0.6, 0.6), (0.8, 0.4), (0.4, 0.8), (0.8, 0.8), (0.4, 0.4)]
    return resolve(
        {
            "packing": BOX,
            "studies": {
                "validation": {
                    "fixes": {"domain": {"type": "cylinder"}, "amount": {"grains": 500}},
                    "varies": {"sizes.case": ["U1", "U3"]},
                },
                "single_form": {"varies": {"sizes.case": ["U1"]}, "forms": {"spread": 2}},
                "application": {"varies": {"sizes.case": ["U1"]}},
                "form_mixtures": {
                    "fixes": {"shapes": {"choice": "form_distribution"}},
                    "varies": {
                        "sizes.case": ["U1"],
                        "means": [{"shapes.flatness.mean": f, "shapes.elongation.mean": e} for f, e in means],
                        "shapes.flatness.std": [0.2, 0.1],
                        "shapes.elongation.std": [0.2, 0.1],
                    },
                },
            },
        },
        "config",
    )


def test_one_packing_of_each_domain_is_shown_with_the_widest_sizes_and_many_forms(campaign):
    shown = showpieces(expand(campaign))
    assert list(shown.study + "/" + shown.packing) == ["validation/U3", "application/U1"]


def test_the_mixtures_shown_are_narrow_and_lie_in_the_corners(campaign):
    corners = corner_mixtures(expand(campaign))
    assert list(corners.label) == [
        "FL 0.4 ± 0.1, EL 0.4 ± 0.1",
        "FL 0.4 ± 0.1, EL 0.8 ± 0.1",
        "FL 0.8 ± 0.1, EL 0.4 ± 0.1",
        "FL 0.8 ± 0.1, EL 0.8 ± 0.1",
    ]
    assert (corners.study == "form_mixtures").all()


def test_fewer_mixtures_than_corners_are_shown_once_each(campaign):
    table = expand(campaign)
    mixtures = table[table.study == "form_mixtures"]
    assert len(corner_mixtures(mixtures[mixtures.packing.str.contains("0.4_0.6")])) == 1
    assert corner_mixtures(table[table.study == "validation"]).empty


def test_sizes_without_a_sieve_curve_can_be_the_widest():
    beta = {"sizes.case": None, "sizes.beta": {"radius": "3 mm", "spread": 0.9}, "shapes.kind": "sphere"}
    one = {"application": {"varies": {"sizes": [{"sizes.case": "U1"}, beta]}}}
    shown = showpieces(expand(resolve({"packing": BOX, "studies": one}, "config")))
    assert [specification["sizes"]["beta"]["spread"] for specification in shown.specification] == [0.9]

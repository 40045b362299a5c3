"""The values of `--config`, and the command that reproduces a campaign."""

import pytest

from simcore.campaign.command_line import MACHINE, campaign_command, typed_values
from simcore.scene.specification import resolve


@pytest.mark.parametrize(
    "given, meant",
    [
        ({"grains": {"seed": "2"}}, {"grains": {"seed": 2}}),
        ({"grains": {"names": "null", "degree": "null", "source": "scans"}},
         {"grains": {"names": None, "degree": None, "source": "scans"}}),
        ({"studies": {"a": {"varies": {"seed": ["1", "2"]}, "in_all": "false"}}},
         {"studies": {"a": {"varies": {"seed": [1, 2]}, "in_all": False}}}),
        ({"packing": {"domain": {"width": "45 mm"}}}, {"packing": {"domain": {"width": "45 mm"}}}),
        ({"grains": {"names": ["G01", "[x", "2026-01-01"]}}, {"grains": {"names": ["G01", "[x", "2026-01-01"]}}),
        ({"threads": 2}, {"threads": 2}),
    ],
)  # fmt: skip
def test_texts_inside_of_braces_get_their_values(given, meant):
    assert typed_values(given) == meant


def test_the_command_of_a_campaign_can_be_run():
    assert campaign_command() == "snakemake"
    assert campaign_command(["a.yaml", "b.yaml"]) == "snakemake --configfile a.yaml b.yaml"
    assert campaign_command(["a.yaml"], {"threads": 2}) == "snakemake --configfile a.yaml"
    options = {"grains": {"source": "my scans", "names": None, "seed": 2}, "reference": "rows"}
    assert campaign_command([], options) == (
        "snakemake --config 'grains={source: my scans, names: null, seed: 2}' reference=rows"
    )


def test_the_keys_of_the_machine_are_those_of_the_configuration():
    assert set(MACHINE) <= set(resolve({"studies": {}}, "config"))

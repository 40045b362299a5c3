"""`sieve`: what it prints and writes, and that the specification which it writes is accepted."""

import json
import re

import numpy as np
import pytest
import yaml

from simcore.__main__ import main
from simcore.grains.measured_forms import Sample
from simcore.grains.sieve import SieveCurve
from simcore.grains.sieve_table import read_curve
from simcore.grains.sources import load_grains
from simcore.packing.forecast_text import check_setup, setup_warnings
from simcore.packing.sieve_specification import MANY, sieve_specification
from simcore.paths import CONFIG
from simcore.scene.setup import set_up
from simcore.scene.specification import read_specification, resolve

CURVE = "opening [mm];mass [g]\n11,2;0\n8;1120\n5,6;760\n4;420\npan;10\n"


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "field.csv").write_text(CURVE)
    return tmp_path


def test_statistics_plot_and_specification(folder, capsys):
    curve, plot, specification = (str(folder / name) for name in ("field.csv", "curve.png", "field.yaml"))
    arguments = ["sieve", curve, "--plot", plot, "--specification", specification, "--finest", "2,8 mm"]
    assert main(arguments) == 0
    text = capsys.readouterr().out
    for part in ("5 sieves from 2.8 to 11.2 mm, 2.31 kg", "D50", "fine gravel, well sorted", "Cu = D60/D10 ="):
        assert part in text
    assert (folder / "curve.png").read_bytes().startswith(b"\x89PNG")
    written = yaml.safe_load((folder / "field.yaml").read_text())
    assert written["sizes"]["bounds"] == ["2.8 mm", "4 mm", "5.6 mm", "8 mm", "11.2 mm"]
    assert written["sizes"]["mass_fractions"] == pytest.approx(
        [10 / 2310, 420 / 2310, 760 / 2310, 1120 / 2310], abs=1e-6
    )
    assert main(["explain", specification]) == 0
    explained = capsys.readouterr().out
    assert explained.startswith("field: ") and "8 to 11.2 mm" in explained
    assert "Warning" not in explained


def test_a_packing_closes_an_end_with_little_mass_as_a_prediction_does(folder, capsys):
    curve = str(folder / "field.csv")  # 0.4 % of the mass are in the pan
    assert main(["sieve", curve, "--specification", str(folder / "field.yaml")]) == 0
    assert "the specification assumes that the 0.4% in the pan are coarser than 2.86 mm" in capsys.readouterr().err
    written = yaml.safe_load((folder / "field.yaml").read_text())
    predicted, _ = read_curve(curve)
    assert written["sizes"]["mass_fractions"] == pytest.approx(list(predicted.mass_fractions), abs=1e-6)
    (folder / "field.csv").write_text(CURVE.replace("pan;10", "pan;100"))
    assert main(["sieve", curve, "--specification", str(folder / "open.yaml")]) == 2
    assert "of the mass pass the finest sieve" in capsys.readouterr().err and not (folder / "open.yaml").exists()


FLAT = Sample("flat", 40, 0.45, 0.14, 0.7, 0.13, 0.32, 0.12)  # thin grains need shorter contacts and more steps


@pytest.mark.parametrize(("classes", "sample"), [(1, None), (3, None), (6, None), (3, FLAT)])
def test_a_packing_of_any_curve_is_high_enough_and_has_no_warning(folder, classes, sample):
    bounds = [4e-3 * 2 ** (i / 2) for i in range(classes + 1)]
    text, notices = sieve_specification(SieveCurve(bounds, [1 / classes] * classes), folder / "my curve.csv", sample)
    (folder / "spec.yaml").write_text(text)
    setup = set_up(read_specification(folder / "spec.yaml"), load_grains)
    check_setup(setup)
    assert setup_warnings(setup) == [] and notices == []
    assert setup.scene.name == "my_curve"


@pytest.mark.parametrize(
    "bounds, shares, sieve, percent",
    [
        ([0.1, 0.5, 2, 4, 8, 16, 32, 64], [0.04, 0.06, 0.1, 0.2, 0.2, 0.2, 0.2], 8, 40),
        ([0.1, 0.2, 64], [0.7, 0.3], 0.2, 70),
    ],
)
def test_a_curve_with_too_many_grains_is_refused(folder, bounds, shares, sieve, percent):
    """The message names the finest sieve above which the bed can be packed, and its number of grains."""
    bounds = 1e-3 * np.array(bounds)
    cure = f"leave out the grains below {sieve} mm, which are {percent}% of the mass; then the packing has (.*) grains"
    with pytest.raises(ValueError, match=f"more than can be packed; {cure}$") as refused:
        sieve_specification(SieveCurve(bounds, shares), folder / "mud.csv")
    first = int(np.flatnonzero(np.isclose(bounds, 1e-3 * sieve))[0])
    (coarse, text), (_, finer) = (described(bounds[k:], shares[k:], folder) for k in (first, first - 1))
    mass = resolve(yaml.safe_load(text))["amount"]["mass"]
    grains = mass / (2650 * np.pi / 6 * coarse.mean(3))
    assert float(re.search(cure, str(refused.value))[1].replace(" ", "")) == pytest.approx(grains, rel=0.05)
    assert grains < MANY and cure.split("which")[0] in finer


def described(bounds, shares, folder):
    """Return the SieveCurve, and the specification of a bed that is packed within days or what is said of another."""
    curve = SieveCurve(bounds, np.array(shares) / sum(shares))
    try:
        text, notices = sieve_specification(curve, folder / "mud.csv", draw=False)
    except ValueError as error:
        return curve, str(error)
    return curve, " ".join(notices) or text


def test_json_has_the_same_numbers(folder, capsys):
    assert main(["sieve", str(folder / "field.csv"), "--json"]) == 0
    printed = capsys.readouterr()
    content = json.loads(printed.out)
    assert content["mass_kg"] == pytest.approx(2.31) and printed.err == ""
    assert content["percentiles_mm"]["D50"] == pytest.approx(5.6 * (8 / 5.6) ** ((1155 - 430) / 760))
    assert content["folk_ward_phi"]["words"][0] == "fine gravel"
    assert "assume that the 0.4% in the pan are coarser than 2.86 mm" in content["notices"][0]


def test_wrong_input_ends_with_one_line_and_leaves_no_file(folder, capsys):
    curve, open_curve, specification = (str(folder / name) for name in ("field.csv", "open.csv", "field.yaml"))
    (folder / "open.csv").write_text(CURVE.replace("pan;10", "pan;100"))
    for arguments, message in (
        ([open_curve, "--specification", specification], "4.2% of the mass pass the finest sieve, 4 mm; give the size"),
        ([curve, "--finest", "1,000 µm"], "--finest: '1,000 µm' is not a number with a unit; a length is needed"),
        ([curve, "--finest", "4 kg"], "--finest: '4 kg' is a mass; a length is needed"),
        ([curve, "--coarsest", "0 mm"], "--coarsest: '0 mm' is not a length above 0"),
        ([curve, "--finest", "4 mm"], "the finest grains, 4 mm, is not below the finest sieve"),
        ([curve, "--plot", str(folder / "a.txt")], "must end in .png, .pdf or .svg"),
        ([str(folder / "none.csv")], "there is no such file"),
    ):
        assert main(["sieve", *arguments]) == 2
        printed = capsys.readouterr()
        assert printed.err.startswith("scree sieve: ") and message in printed.err
        assert printed.err.count("\n") == 1 and printed.out == ""
    assert sorted(path.name for path in folder.iterdir()) == ["field.csv", "open.csv"]


def test_a_packing_is_made_as_the_beds_of_the_model_of_size_and_form(folder):
    text, _ = sieve_specification(SieveCurve([4e-3, 5.6e-3, 8e-3], [0.5, 0.5]), folder / "my curve.csv")
    written, beds = yaml.safe_load(text), yaml.safe_load((CONFIG / "size_and_form.yaml").read_text())
    fixed = beds["studies"]["size_and_form"]["fixes"]
    for key in ("accuracy", "faces", "generation", "shaking"):
        assert written[key] == fixed[key]
    assert written["sizes"]["draw"] == fixed["sizes"]["draw"]
    assert written["domain"]["height"] == fixed["domain"]["height"]

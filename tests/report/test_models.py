"""Models of a campaign: seeds are averaged, and packings with other settings are not mixed."""

import numpy as np
import pandas as pd
import pytest

from simcore.grains.statistics import mixture_features
from simcore.models.tables import over_seeds
from simcore.report.answers import answer
from simcore.report.models import form_mixture_findings, require_one_setting, single_form_findings


def beds(**columns):
    """Return five forms with three seeds each, whose porosity grows with L/S and scatters by 0.002."""
    forms = dict(zip("abcde", ((0.9, 0.8), (0.7, 0.5), (0.5, 0.4), (0.8, 0.3), (0.6, 0.6)), strict=True))
    rng = np.random.default_rng(1)
    rows = [
        {"study": "single_form", "packing": f"{name}{seed}", "case": "U1", **columns, "grain": name}
        | {"kind": "polyhedron", "seed": seed, "L": 1.0, "I": middle, "S": S}
        | {"FL": S / middle, "EL": middle, "EQ": S, "sigma_FL": 0.0, "sigma_EL": 0.0, "sigma_EQ": 0.0}
        | {"n": 0.33 + 0.02 / S + 0.002 * rng.standard_normal(), "n_std_error": 0.003}
        for name, (middle, S) in forms.items()
        for seed in (1, 2, 3)
    ]
    return pd.DataFrame(rows)


def test_figures_have_the_means_over_the_seeds_of_a_form():
    found = single_form_findings([beds()], [], 0, 5)
    (line,) = [text for text in found.figures["features"].axes[0].get_legend_handles_labels()[1] if "forms" in text]
    assert line == "5 forms"
    assert found.figures["zingg"].axes[0].get_title() == "sieve curve U1, 5 forms"
    means = over_seeds(beds(), "grain")
    assert means.n_std_error.to_numpy() == pytest.approx(0.003 / np.sqrt(3))
    assert means.n.to_numpy() == pytest.approx(beds().groupby("grain", sort=False).n.mean().to_numpy())


def test_packings_with_another_setting_are_not_mixed():
    """A study that varies friction, and a second one with other friction, would give a model of their means."""
    both = pd.concat([beds(friction=0.3), beds(friction=0.9)], ignore_index=True)
    with pytest.raises(ValueError, match=r"packings of grain a in U1 differ in .*friction.*not begin with sing"):
        single_form_findings([both], [], 0, 5)
    with pytest.raises(ValueError, match="study single_form and single_form_rough: packings of grain a in U1 differ"):
        single_form_findings([beds(), beds(friction=0.9).assign(study="single_form_rough")], [], 0, 5)
    wide = beds(width_m=0.1).assign(case="U7")
    require_one_setting([beds(width_m=0.06), wide])


def test_mixtures_without_a_usable_model_give_empty_tables_and_a_figure_that_says_so(tmp_path):
    """Eight distributions that vary the flatness only have the same elongation, so that no set of features is left."""
    rng = np.random.default_rng(2)
    middle, spread = rng.uniform(0.5, 0.9, 60), rng.uniform(-0.1, 0.1, 60)
    forms = [
        mixture_features(np.ones(60), middle, middle * (flatness + spread)) for flatness in np.linspace(0.4, 0.7, 8)
    ]
    names = [f"s{k}" for k in range(8)]
    rows = pd.DataFrame(forms).assign(packing=names, case="U1", sample=names, kind="continuous", n=0.35)
    packings = rows[["packing", "case", "n"]].assign(n_std_error=0.003, EQ=0.5, EL=0.5, sigma_EQ=0.1, sigma_EL=0.1)
    found = form_mixture_findings(rows, packings, rows, 0, 5)
    assert found.models == {} and list(found.tables["models"]) == ["model", "case", "term", "coefficient"]
    (text,) = found.figures["prediction"].axes[0].texts
    assert "No model was fitted" in text.get_text()
    found._replace(figures={}).write({name: tmp_path / f"{name}.csv" for name in found.tables})
    assert answer({"form_mixture": tmp_path / "models.csv"}) == []

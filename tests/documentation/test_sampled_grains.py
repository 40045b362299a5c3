"""The error of a prediction that comes from measuring few grains is as large as the how-to pages state."""

import numpy as np
import pandas as pd
import pytest

from simcore.models.fitting import fit_reference_models
from simcore.models.unified import unified_features
from simcore.paths import ROOT

DRAWS = 400


def one_class_scatter(axes, grains):
    """Return the standard deviation of the one-class porosity over draws of so many grains from `axes` (n, 3)."""
    L, I, S = np.sort(axes, axis=1).T[::-1]  # noqa: E741
    chosen = np.random.default_rng(0).integers(0, len(axes), (DRAWS, grains))
    columns = {}
    for name, values in (("EQ", S / L), ("EL", I / L)):
        columns[f"mu_{name}"] = values[chosen].mean(axis=1)
        columns[f"sigma_{name}"] = values[chosen].std(axis=1, ddof=1)
    model = fit_reference_models().models["unified", "U1"]
    return np.std(model.predict(unified_features(pd.DataFrame(columns))))


@pytest.mark.parametrize("grains, stated", [(40, 0.003), (10, 0.006)])
def test_few_grains_leave_the_stated_error(grains, stated):
    axes = pd.read_csv(ROOT / "examples" / "forty_grains.csv").to_numpy(float)
    assert one_class_scatter(axes, grains) == pytest.approx(stated, abs=5e-4)
    text = (ROOT / "docs" / "how_to" / "predict_from_a_sieve_curve.md").read_text(encoding="utf-8")
    assert "change the one-class porosity by 0.003 and ten by 0.006" in " ".join(text.split())

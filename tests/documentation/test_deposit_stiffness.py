"""The page on deposits says by how much the stiffness of its rows differs from that of today's code."""

import numpy as np
import pandas as pd

from simcore.grains.form import sieve_size_of_volume
from simcore.paths import REFERENCE, ROOT


def test_the_modulus_and_the_steps_of_the_rows():
    """Modulus and contact time are in proportion to the radius, which was that of the sieve size."""
    rows = pd.read_csv(REFERENCE / "deposits.csv").query("law == 'hertz'")
    former = 1.0 / sieve_size_of_volume(np.ones(len(rows)), 1.0 / rows["zeta"], 1.0 / rows["eta"])
    words = " ".join((ROOT / "docs" / "reference" / "deposits.md").read_text(encoding="utf-8").split())
    assert f"modulus of the rows is therefore {former.min():.2f} to {former.max():.2f} times" in words
    assert f"they have {40 / former.max():.0f} to {40 / former.min():.0f} steps per contact time" in words

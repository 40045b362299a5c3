"""The fields of a contact that the torque of a patch reads and writes."""

from typing import NamedTuple

import numpy as np


class Patch(NamedTuple):
    """One row of the patch fields of contacts and walls: second moments (1, 6) [m²] and twist (1,)."""

    spread: np.ndarray
    twist: np.ndarray

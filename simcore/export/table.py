"""Numbers of grains and contacts that exported files carry."""

import numpy as np
import pandas as pd

from simcore.dem.state.touching_contacts import CYLINDER_PARTNER, FLOOR_PARTNER
from simcore.evaluation.coordination import coordination_number

WALLS = {FLOOR_PARTNER: "floor", CYLINDER_PARTNER: "cylinder"}


def grain_table(packing) -> pd.DataFrame:
    """Return one row per grain: grain (its number), x, y, z, D, L, I, S [m], volume [m³], FL, EL, coordination.

    FL = S/I and EL = I/L are 1 for a grain that is neither flat nor elongated. coordination: number of contacts with
    other grains.
    """
    columns = {"grain": np.arange(packing.sizes["grain"])}
    columns |= dict(zip("xyz", packing["position"].values.T, strict=True))
    columns |= {name: packing[name].values for name in ("D", "L", "I", "S", "volume")}
    columns["FL"], columns["EL"] = columns["S"] / columns["I"], columns["I"] / columns["L"]
    columns["coordination"] = coordination_number(packing)["contacts"].values if packing.sizes["grain"] else []
    return pd.DataFrame(columns)


def contact_table(packing) -> pd.DataFrame:
    """Return one row per contact with an overlap, as the file of the packing stores it.

    Columns: first, second: numbers of the grains, the second also -1 for the floor and -2 for the cylinder; wall: its
    name or ""; image_x, image_y: periods that are added to the second grain's place; x, y, z [m]: point where the force
    acts; normal_x …: unit normal from the first to the second; overlap [m]; force [N]: magnitude; force_x … [N]: on the
    second body; normal_force [N]: along the normal, positive where the bodies press. Remembered contacts without an
    overlap are left out, as they are from the coordination number.
    """
    touching = packing["contact_overlap"].values > 0.0
    body, image = packing["contact_body"].values[touching], packing["contact_image"].values[touching]
    columns = {"first": body[:, 0], "second": body[:, 1]}
    columns["wall"] = [WALLS.get(int(second), "") for second in body[:, 1]]
    columns |= {"image_x": image[:, 0], "image_y": image[:, 1]}
    columns |= dict(zip("xyz", packing["contact_point"].values[touching].T, strict=True))
    normal, force = packing["contact_normal"].values[touching], packing["contact_force"].values[touching]
    columns |= {f"normal_{axis}": values for axis, values in zip("xyz", normal.T, strict=True)}
    columns["overlap"] = packing["contact_overlap"].values[touching]
    columns["force"] = np.linalg.norm(force, axis=1)
    columns["normal_force"] = np.sum(force * normal, axis=1)
    columns |= {f"force_{axis}": values for axis, values in zip("xyz", force.T, strict=True)}
    return pd.DataFrame(columns)

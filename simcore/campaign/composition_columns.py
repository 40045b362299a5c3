"""Columns of a committed row with the sizes and forms of the grains in the evaluated part of its bed."""

from simcore.reference.share_columns import share_columns

# Columns of the shares of coarse and of fine grains: (variable of simcore.evaluation.composition, dimension, place).
_SHARES = {
    "coarse_lower": ("coarse_share", "half", "lower"),
    "coarse_upper": ("coarse_share", "half", "upper"),
    "coarse_bed": ("coarse_share_of_part", "part", "bed"),
    "coarse_evaluated": ("coarse_share_of_part", "part", "evaluated"),
    "fine_floor": ("fine_share", "zone", "floor"),
    "fine_evaluated": ("fine_share", "zone", "evaluated"),
}


def composition_columns(data) -> dict:
    """Return the columns of one bed, dict; data: Dataset of simcore.evaluation.evaluate.

    share_A-Bmm: share by volume of the sieve class from A to B. mu_FL_evaluated, sigma_FL_evaluated, ...: mean and
    standard deviation by volume of FL, EL and EQ. coarse_*, fine_*: shares of coarse and of fine grains, and with
    _error their standard errors. time_s: simulated time [s], during which the bed was shaken. ValueError if the
    Dataset was made without these variables.
    """
    missing = [name for name in ("sieve_fraction", "coarse_share_of_part") if name not in data]
    if missing:
        raise ValueError(
            f"the evaluation of {data.attrs.get('name', 'a packing')} has no {missing[0]}; delete the file of its "
            "porosity, so that it is evaluated again"
        )
    of_volume = data.sel(part="evaluated", weight="volume")
    columns = share_columns(data["sieve_bounds"].values, of_volume["sieve_fraction"].values)
    for name, variable in (("mu", "form_mean"), ("sigma", "form_std")):
        for ratio in ("FL", "EL", "EQ"):
            columns[f"{name}_{ratio}_evaluated"] = float(of_volume[variable].sel(ratio=ratio))
    for name, (variable, dimension, place) in _SHARES.items():
        columns[name] = float(data[variable].sel({dimension: place}))
        columns[f"{name}_error"] = float(data[f"{variable}_std_error"].sel({dimension: place}))
    return {name: round(float(value), 6) for name, value in columns.items()} | {"time_s": round(data.attrs["time"], 3)}

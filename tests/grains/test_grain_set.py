"""A grain set is the same, bit by bit, after it is written to a file and read."""

import numpy as np
import pytest
import xarray as xr

from simcore.grains.grain_set import read_grains, write_grains
from simcore.grains.mesh import make_grain


def grains():
    rng = np.random.default_rng(5)
    return [make_grain(f"g{n}", rng.normal(size=(n, 3)) * [1e-3, 2e-3, 3e-3]) for n in (6, 40, 15)]


def test_round_trip_is_exact(tmp_path):
    path = tmp_path / "grains.nc"
    written = grains()
    write_grains(path, written, source="test")
    for before, after in zip(written, read_grains(path), strict=True):
        for field in ("name", "volume", "L", "I", "S", "sphericity"):
            assert getattr(before, field) == getattr(after, field)
        for field in ("vertices", "faces", "second_moments"):
            np.testing.assert_array_equal(getattr(before, field), getattr(after, field))
    assert [p.name for p in tmp_path.iterdir()] == ["grains.nc"]
    data = xr.open_dataset(path)
    assert data.attrs["source"] == "test" and data.L.attrs["units"] == "m"


def test_names_must_be_unique():
    with pytest.raises(ValueError, match="unique"):
        write_grains("never.nc", grains()[:1] * 2)


def test_wrong_files_are_refused(tmp_path):
    with pytest.raises(ValueError, match="does not exist"):
        read_grains(tmp_path / "none.nc")
    (tmp_path / "text.nc").write_text("no netCDF")
    with pytest.raises(ValueError, match="cannot be read as a grain set"):
        read_grains(tmp_path / "text.nc")
    xr.Dataset({"a": 1}).to_netcdf(tmp_path / "other.nc")
    with pytest.raises(ValueError, match="cannot be read as a grain set"):
        read_grains(tmp_path / "other.nc")
